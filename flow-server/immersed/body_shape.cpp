#include "flow-server/immersed/body_shape.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "flow-server/immersed/triangle_geometry.hpp"

namespace couplet::flow {
namespace {

class MeshBuilder {
 public:
  std::vector<Point>& nodes() { return node_; }
  /// Of a closed surface.
  double volume() const {
    double sum = 0;
    for (const auto& [a, b, c] : triangle_)
      sum += dot(node_[static_cast<std::size_t>(a)],
                 cross(node_[static_cast<std::size_t>(b)], node_[static_cast<std::size_t>(c)])) /
             6;
    return sum;
  }

  int add_node(const Point& position) {
    node_.push_back(position);
    return static_cast<int>(node_.size()) - 1;
  }
  void add_triangle(int a, int b, int c) { triangle_.push_back({a, b, c}); }

  surface::SurfaceMesh take() const {
    surface::SurfaceMesh mesh;
    mesh.node_position.resize(static_cast<Eigen::Index>(node_.size()), 3);
    for (std::size_t i = 0; i < node_.size(); ++i)
      for (std::size_t d = 0; d < 3; ++d)
        mesh.node_position(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(d)) = node_[i][d];
    const auto n = static_cast<Eigen::Index>(triangle_.size());
    mesh.face_offset.resize(n + 1);
    mesh.face_node.resize(3 * n);
    mesh.face_region.setZero(n);
    mesh.region = {"surface"};
    mesh.face_offset(0) = 0;
    for (Eigen::Index t = 0; t < n; ++t) {
      mesh.face_offset(t + 1) = 3 * (t + 1);
      for (int k = 0; k < 3; ++k)
        mesh.face_node(3 * t + k) = triangle_[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)];
    }
    return mesh;
  }

 private:
  std::vector<Point> node_;
  std::vector<std::array<int, 3>> triangle_;
};

int parts_of(double length, double largest_side) {
  assert(largest_side > 0);
  return std::max(1, static_cast<int>(std::ceil(length / largest_side * (1 - 1e-9))));
}

/// Two triangles that fill a, b, c, d; diagonals alternate like a chess board, so that no direction is preferred.
void add_quadrilateral(MeshBuilder& mesh, int a, int b, int c, int d, bool is_even) {
  if (is_even) {
    mesh.add_triangle(a, b, c), mesh.add_triangle(a, c, d);
  } else {
    mesh.add_triangle(a, b, d), mesh.add_triangle(b, c, d);
  }
}

/// Rows of nodes, row after row, joined by quadrilaterals. node(i, j): i along a row.
template <class NodeAt>
void add_rows(MeshBuilder& mesh, int n_along, int n_rows, const NodeAt& node) {
  for (int j = 0; j < n_rows; ++j)
    for (int i = 0; i < n_along; ++i)
      add_quadrilateral(mesh, node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1), (i + j) % 2 == 0);
}

/// A chain of points drawn along z.
surface::SurfaceMesh extrude(const std::vector<PlanePoint>& chain, bool is_closed, const DepthSpan& depth,
                             double largest_side) {
  const int n_layers = depth.is_one_cell ? 1 : parts_of(std::numbers::sqrt2 * (depth.to - depth.from), largest_side);
  const int n_points = static_cast<int>(chain.size());
  MeshBuilder mesh;
  for (int layer = 0; layer <= n_layers; ++layer) {
    // The ends exactly: a surface that ends on a border is told by its position.
    const double z = layer == n_layers ? depth.to : depth.from + layer * (depth.to - depth.from) / n_layers;
    for (const PlanePoint& point : chain) mesh.add_node({point[0], point[1], z});
  }
  add_rows(mesh, is_closed ? n_points : n_points - 1, n_layers,
           [&](int i, int layer) { return layer * n_points + i % n_points; });
  return mesh.take();
}

/// The chain with points between, so that no side is longer than the largest one.
std::vector<PlanePoint> divide(const std::vector<PlanePoint>& chain, bool is_closed, double largest_side) {
  std::vector<PlanePoint> divided;
  const std::size_t n_sides = is_closed ? chain.size() : chain.size() - 1;
  for (std::size_t i = 0; i < n_sides; ++i) {
    const PlanePoint &a = chain[i], &b = chain[(i + 1) % chain.size()];
    const int n = parts_of(std::hypot(b[0] - a[0], b[1] - a[1]), largest_side);
    for (int k = 0; k < n; ++k) {
      const double s = static_cast<double>(k) / n;
      divided.push_back({a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])});
    }
  }
  if (!is_closed) divided.push_back(chain.back());
  return divided;
}

/// The side of triangles in three dimensions that leaves their diagonals no longer than the largest side.
double side_under_diagonal(const DepthSpan& depth, double largest_side) {
  return depth.is_one_cell ? largest_side : largest_side / std::numbers::sqrt2;
}

}  // namespace

surface::SurfaceMesh make_elliptic_cylinder(const PlanePoint& centre, const PlanePoint& half_axes,
                                            const DepthSpan& depth, double largest_side) {
  // Equal steps of the angle: no side is longer than that of the circle around. A multiple of four keeps the symmetry.
  const double radius = std::max(half_axes[0], half_axes[1]);
  const double side = side_under_diagonal(depth, largest_side);
  int n = 4 * parts_of(std::numbers::pi / 2 * radius, side);
  // The area of the ellipse where n / 2 s^2 sin(2 pi / n) = pi: the corners stand s times as far from the centre as the
  // ellipse.
  const auto swelling = [](int corners) {
    const double step = 2 * std::numbers::pi / corners;
    return std::sqrt(step / std::sin(step));
  };
  while (2 * swelling(n) * std::sin(std::numbers::pi / n) * radius > side) n += 4;
  std::vector<PlanePoint> outline;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n, s = swelling(n);
    outline.push_back({centre[0] + s * half_axes[0] * std::cos(angle), centre[1] + s * half_axes[1] * std::sin(angle)});
  }
  return extrude(outline, true, depth, largest_side);
}

surface::SurfaceMesh make_polygon_prism(const std::vector<PlanePoint>& outline, const DepthSpan& depth,
                                        double largest_side) {
  assert(outline.size() >= 3);
  double twice_area = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const PlanePoint &a = outline[i], &b = outline[(i + 1) % outline.size()];
    twice_area += a[0] * b[1] - a[1] * b[0];
  }
  std::vector<PlanePoint> counter_clockwise = outline;
  if (twice_area < 0) std::reverse(counter_clockwise.begin(), counter_clockwise.end());
  return extrude(divide(counter_clockwise, true, side_under_diagonal(depth, largest_side)), true, depth, largest_side);
}

surface::SurfaceMesh make_sheet_prism(const std::vector<PlanePoint>& chain, const DepthSpan& depth,
                                      double largest_side) {
  assert(chain.size() >= 2);
  return extrude(divide(chain, false, side_under_diagonal(depth, largest_side)), false, depth, largest_side);
}

namespace {

/// In the unit sphere: an icosahedron with n^2 triangles a face, drawn onto the sphere.
MeshBuilder make_polyhedron(int n) {
  const double g = std::numbers::phi;
  const std::array<Point, 12> vertex = {{{-1, g, 0},
                                         {1, g, 0},
                                         {-1, -g, 0},
                                         {1, -g, 0},
                                         {0, -1, g},
                                         {0, 1, g},
                                         {0, -1, -g},
                                         {0, 1, -g},
                                         {g, 0, -1},
                                         {g, 0, 1},
                                         {-g, 0, -1},
                                         {-g, 0, 1}}};
  static constexpr std::array<std::array<int, 3>, 20> face = {
      {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
       {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
       {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
  MeshBuilder mesh;
  std::map<std::vector<std::pair<int, int>>, int> known;  // by vertices and weights, so that faces share their nodes
  const auto node = [&](const std::array<int, 3>& corners, int i, int j) {
    std::vector<std::pair<int, int>> key;
    for (const auto& [corner, weight] : {std::pair{corners[0], n - i - j}, {corners[1], i}, {corners[2], j}})
      if (weight > 0) key.emplace_back(corner, weight);
    std::sort(key.begin(), key.end());
    const auto [found, is_new] = known.try_emplace(key, -1);
    if (is_new) {
      Point p{};
      for (const auto& [corner, weight] : key)
        p = p + static_cast<double>(weight) * vertex[static_cast<std::size_t>(corner)];
      found->second = mesh.add_node((1 / length(p)) * p);
    }
    return found->second;
  };
  for (const auto& corners : face) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i + j < n; ++i) {
        mesh.add_triangle(node(corners, i, j), node(corners, i + 1, j), node(corners, i, j + 1));
        if (i + j + 1 < n)
          mesh.add_triangle(node(corners, i + 1, j), node(corners, i + 1, j + 1), node(corners, i, j + 1));
      }
    }
  }
  return mesh;
}

}  // namespace

surface::SurfaceMesh make_ellipsoid(const Point& centre, const Point& half_axes, double largest_side) {
  // Sides are at most 1 / 0.7947 longer on the sphere than on the icosahedron: the distance of its faces from the
  // centre.
  const double side_of_icosahedron = 2 / std::hypot(1, std::numbers::phi);  // in the unit sphere
  const double longest = side_of_icosahedron / 0.7946 * std::max({half_axes[0], half_axes[1], half_axes[2]});
  for (int n = parts_of(longest, largest_side);; ++n) {
    MeshBuilder mesh = make_polyhedron(n);
    const double swelling = std::cbrt(4 * std::numbers::pi / 3 / mesh.volume());
    if (swelling * longest / n > largest_side * (1 + 1e-9)) continue;
    for (Point& p : mesh.nodes())
      for (std::size_t d = 0; d < 3; ++d) p[d] = centre[d] + swelling * half_axes[d] * p[d];
    return mesh.take();
  }
}

surface::SurfaceMesh make_box(const Point& low, const Point& high, double largest_side) {
  std::array<int, 3> n{};
  for (std::size_t d = 0; d < 3; ++d) n[d] = parts_of(std::numbers::sqrt2 * (high[d] - low[d]), largest_side);
  MeshBuilder mesh;
  std::map<std::array<int, 3>, int> known;
  const auto node = [&](const std::array<int, 3>& step) {
    const auto [found, is_new] = known.try_emplace(step, -1);
    if (is_new) {
      Point p{};
      for (std::size_t d = 0; d < 3; ++d)
        p[d] = step[d] == n[d] ? high[d] : low[d] + step[d] * (high[d] - low[d]) / n[d];
      found->second = mesh.add_node(p);
    }
    return found->second;
  };
  for (std::size_t d = 0; d < 3; ++d) {
    const std::size_t u = (d + 1) % 3, v = (d + 2) % 3;  // u x v points along +d
    for (const bool is_high : {false, true}) {
      const std::size_t along = is_high ? u : v, across = is_high ? v : u;
      add_rows(mesh, n[along], n[across], [&](int i, int j) {
        std::array<int, 3> step{};
        step[d] = is_high ? n[d] : 0;
        step[along] = i;
        step[across] = j;
        return node(step);
      });
    }
  }
  return mesh.take();
}

surface::SurfaceMesh make_rectangle(const Point& corner, const Point& first_side, const Point& second_side,
                                    double largest_side) {
  const int n = parts_of(std::numbers::sqrt2 * length(first_side), largest_side);
  const int m = parts_of(std::numbers::sqrt2 * length(second_side), largest_side);
  MeshBuilder mesh;
  for (int j = 0; j <= m; ++j) {
    for (int i = 0; i <= n; ++i)
      mesh.add_node(corner + (static_cast<double>(i) / n) * first_side + (static_cast<double>(j) / m) * second_side);
  }
  add_rows(mesh, n, m, [n](int i, int j) { return j * (n + 1) + i; });
  return mesh.take();
}

surface::SurfaceMesh make_tube(const Point& from, const Point& to, double radius, double largest_side) {
  const Point along = to - from;
  const double side = largest_side / std::numbers::sqrt2;
  const int n_layers = parts_of(length(along), side);
  const int n = 4 * parts_of(std::numbers::pi / 2 * radius, side);
  const Point axis = (1 / length(along)) * along;
  // Two directions across the axis; the coordinate axis that is least along it gives the first.
  std::size_t least = 0;
  for (std::size_t d = 1; d < 3; ++d)
    if (std::abs(axis[d]) < std::abs(axis[least])) least = d;
  Point helper{};
  helper[least] = 1;
  Point first = cross(axis, helper);
  first = (1 / length(first)) * first;
  const Point second = cross(axis, first);
  MeshBuilder mesh;
  for (int layer = 0; layer <= n_layers; ++layer) {
    const Point centre = layer == n_layers ? to : from + (static_cast<double>(layer) / n_layers) * along;
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n;
      mesh.add_node(centre + (radius * std::cos(angle)) * first + (radius * std::sin(angle)) * second);
    }
  }
  add_rows(mesh, n_layers, n, [n](int layer, int i) { return layer * n + i % n; });
  const int first_middle = mesh.add_node(from), last_middle = mesh.add_node(to), last = n_layers * n;
  for (int i = 0; i < n; ++i) {
    mesh.add_triangle(first_middle, i, (i + 1) % n);
    mesh.add_triangle(last_middle, last + (i + 1) % n, last + i);
  }
  return mesh.take();
}

surface::SurfaceMesh make_revolved_body(const std::vector<PlanePoint>& outline, double largest_side) {
  assert(outline.size() >= 3);
  const double side = largest_side / std::numbers::sqrt2;
  const std::vector<PlanePoint> profile = divide(outline, false, side);
  double radius = 0;
  for (const PlanePoint& point : profile) radius = std::max(radius, point[1]);
  const int n = 4 * parts_of(std::numbers::pi / 2 * radius, side);
  const int n_rings = static_cast<int>(profile.size()) - 2;
  MeshBuilder mesh;
  for (int ring = 1; ring <= n_rings; ++ring) {
    const PlanePoint& at = profile[static_cast<std::size_t>(ring)];
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n;
      mesh.add_node({at[0], at[1] * std::cos(angle), at[1] * std::sin(angle)});
    }
  }
  const int first = mesh.add_node({profile.front()[0], 0, 0}), last = mesh.add_node({profile.back()[0], 0, 0});
  const auto node = [n](int i, int ring) { return ring * n + i % n; };
  // The angle turns from y to z: the way round x the way along x points out.
  const bool is_forward = outline.back()[0] > outline.front()[0];
  const auto around = [&](int i) { return is_forward ? i : n - i; };
  add_rows(mesh, n, n_rings - 1, [&](int i, int ring) { return node(around(i), ring); });
  for (int i = 0; i < n; ++i) {
    mesh.add_triangle(first, node(around(i + 1), 0), node(around(i), 0));
    mesh.add_triangle(last, node(around(i), n_rings - 1), node(around(i + 1), n_rings - 1));
  }
  return mesh.take();
}

surface::SurfaceMesh make_ruled_sheet(const std::vector<Point>& first_edge, const std::vector<Point>& second_edge,
                                      double largest_side) {
  assert(first_edge.size() == second_edge.size() && first_edge.size() >= 2);
  const double side = 0.5 * largest_side;  // no diagonal is longer than two sides, however sheared they are
  double width = 0;
  for (std::size_t i = 0; i < first_edge.size(); ++i) width = std::max(width, length(second_edge[i] - first_edge[i]));
  const int n_across = parts_of(width, side);
  MeshBuilder mesh;
  std::vector<std::vector<int>> line;  // nodes from the first edge to the second
  const auto add_line = [&](const Point& from, const Point& to) {
    std::vector<int>& nodes = line.emplace_back();
    for (int j = 0; j <= n_across; ++j) {
      const bool is_point = j > 0 && from == to;
      nodes.push_back(is_point ? nodes.front()
                               : mesh.add_node(from + (static_cast<double>(j) / n_across) * (to - from)));
    }
  };
  add_line(first_edge[0], second_edge[0]);
  for (std::size_t i = 0; i + 1 < first_edge.size(); ++i) {
    const Point along_first = first_edge[i + 1] - first_edge[i], along_second = second_edge[i + 1] - second_edge[i];
    const int n = parts_of(std::max(length(along_first), length(along_second)), side);
    for (int k = 1; k < n; ++k) {
      const double share = static_cast<double>(k) / n;
      add_line(first_edge[i] + share * along_first, second_edge[i] + share * along_second);
    }
    add_line(first_edge[i + 1], second_edge[i + 1]);
  }
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    for (std::size_t j = 0; j < static_cast<std::size_t>(n_across); ++j) {
      const int a = line[i][j], b = line[i + 1][j], c = line[i + 1][j + 1], d = line[i][j + 1];
      // Half of a quadrilateral is left where a line is a point.
      if (a == d) {
        mesh.add_triangle(a, b, c);
      } else if (b == c) {
        mesh.add_triangle(a, b, d);
      } else {
        add_quadrilateral(mesh, a, b, c, d, (i + j) % 2 == 0);
      }
    }
  }
  return mesh.take();
}

}  // namespace couplet::flow
