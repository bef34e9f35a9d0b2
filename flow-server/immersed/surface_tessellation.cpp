#include "flow-server/immersed/surface_tessellation.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <unordered_map>

#include "proto/report/failure.hpp"

namespace couplet::flow {
namespace {

struct ShapeValues {
  int n = 0;
  std::array<double, 8> value{};
};

/// Shape functions of a face with n nodes. Triangles: x, y >= 0, x + y <= 1; quadrilaterals: -1 <= x, y <= 1.
/// Midside nodes follow the corners in the order of the sides.
ShapeValues shape_at(int n, double x, double y) {
  const double l = 1 - x - y;
  switch (n) {
    case 3:
      return {n, {l, x, y}};
    case 6:
      return {n, {l * (2 * l - 1), x * (2 * x - 1), y * (2 * y - 1), 4 * l * x, 4 * x * y, 4 * y * l}};
    case 4:
      return {n, {(1 - x) * (1 - y) / 4, (1 + x) * (1 - y) / 4, (1 + x) * (1 + y) / 4, (1 - x) * (1 + y) / 4}};
    default:  // 8 nodes, serendipity
      return {8,
              {(1 - x) * (1 - y) * (-x - y - 1) / 4, (1 + x) * (1 - y) * (x - y - 1) / 4,
               (1 + x) * (1 + y) * (x + y - 1) / 4, (1 - x) * (1 + y) * (-x + y - 1) / 4, (1 - x * x) * (1 - y) / 2,
               (1 + x) * (1 - y * y) / 2, (1 - x * x) * (1 + y) / 2, (1 - x) * (1 - y * y) / 2}};
  }
}

/// Where the nodes of a face with n nodes lie in its parameters; the ninth is the middle.
std::array<double, 2> node_parameters(int n, int node) {
  static constexpr std::array<std::array<double, 2>, 6> triangle = {
      {{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}}};
  static constexpr std::array<std::array<double, 2>, 9> quadrilateral = {
      {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {0, -1}, {1, 0}, {0, 1}, {-1, 0}, {0, 0}}};
  const auto at = static_cast<std::size_t>(node);
  return n == 3 || n == 6 ? triangle[at] : quadrilateral[at];
}

std::uint64_t side_key(int a, int b) {
  const auto [low, high] = std::minmax(a, b);
  return (static_cast<std::uint64_t>(low) << 32) | static_cast<std::uint32_t>(high);
}

}  // namespace

SurfaceTessellation::SurfaceTessellation(const surface::SurfaceMesh& mesh, const std::string& whose,
                                         const TessellationSize& size)
    : n_nodes_(mesh.n_nodes()) {
  assert(size.largest_side >= 0);
  surface::check_surface(mesh, whose);
  if (mesh.n_faces() == 0)
    throw report::PeerError(whose, "the surface has no faces", "give triangles or quadrilaterals, not nodes alone");
  cut_into_pieces(mesh, size);
  if (size.largest_side > 0) halve_long_sides(mesh, whose, size);
  for (const Piece& piece : piece_) {
    triangle_.push_back(piece.corner);
    face_.push_back(piece.face);
  }
  piece_ = {};
  position_ = {};
}

int SurfaceTessellation::add_corner(const surface::SurfaceMesh& mesh, int face, const FacePoint& at) {
  const auto first = mesh.face_offset(face);
  const ShapeValues shape = shape_at(static_cast<int>(mesh.face_offset(face + 1) - first), at[0], at[1]);
  Point position{};
  for (int i = 0; i < shape.n; ++i) {
    const double weight = shape.value[static_cast<std::size_t>(i)];
    if (weight == 0) continue;  // exactly so for nodes off the side that a corner lies on: the parameters are dyadic
    const auto node = mesh.face_node(first + i);
    node_.push_back(static_cast<int>(node));
    weight_.push_back(weight);
    for (std::size_t d = 0; d < 3; ++d) position[d] += weight * mesh.node_position(node, static_cast<Eigen::Index>(d));
  }
  offset_.push_back(static_cast<int>(node_.size()));
  position_.push_back(position);
  return n_corners() - 1;
}

/// A quadrilateral with two sides along z becomes a row of pieces from side to side. Its neighbours share those sides
/// alone.
void SurfaceTessellation::cut_prism_face(const surface::SurfaceMesh& mesh, int face, const TessellationSize& size,
                                         std::vector<int>& corner_of_node) {
  const auto first = mesh.face_offset(face);
  const bool is_quadratic = mesh.face_offset(face + 1) - first == 8;
  const auto flat_length = [&](int i, int j) {
    const auto a = mesh.face_node(first + i), b = mesh.face_node(first + j);
    return std::hypot(mesh.node_position(b, 0) - mesh.node_position(a, 0),
                      mesh.node_position(b, 1) - mesh.node_position(a, 1));
  };
  // The parameter that runs along the outline; sides 0-1 and 2-3 run along parameter 0, the others along 1.
  const std::size_t along = flat_length(0, 1) + flat_length(2, 3) >= flat_length(1, 2) + flat_length(3, 0) ? 0 : 1;
  const double length =
      along == 0 ? std::max(flat_length(0, 1), flat_length(2, 3)) : std::max(flat_length(1, 2), flat_length(3, 0));
  // A quadratic side is longer than its chord: two halves at least, each through the midside node.
  const double half =
      is_quadratic
          ? (along == 0 ? std::max(flat_length(0, 4) + flat_length(4, 1), flat_length(2, 6) + flat_length(6, 3))
                        : std::max(flat_length(1, 5) + flat_length(5, 2), flat_length(3, 7) + flat_length(7, 0))) /
                2
          : 0;
  const auto parts = [&](double side) {
    return size.largest_side > 0 ? std::max(1, static_cast<int>(std::ceil(side / size.largest_side - 1e-9))) : 1;
  };
  const int n = is_quadratic ? 2 * parts(half) : parts(length);
  const auto corner_at = [&](int step, int side) {
    FacePoint at{};
    at[along] = -1 + 2.0 * step / n;
    at[1 - along] = side;
    for (int node = 0; node < 4; ++node) {
      if (node_parameters(4, node) != at) continue;
      int& known = corner_of_node[static_cast<std::size_t>(mesh.face_node(first + node))];
      if (known < 0) known = add_corner(mesh, face, at);
      return std::pair{known, at};
    }
    return std::pair{add_corner(mesh, face, at), at};
  };
  auto low = corner_at(0, -1), high = corner_at(0, 1);
  for (int step = 1; step <= n; ++step) {
    const auto next_low = corner_at(step, -1), next_high = corner_at(step, 1);
    // Round as the face goes round: along parameter 0 first, then 1.
    const auto keep = [&](const auto& a, const auto& b, const auto& c) {
      if (along == 0) {
        piece_.push_back({{a.first, b.first, c.first}, {a.second, b.second, c.second}, face});
      } else {
        piece_.push_back({{a.first, c.first, b.first}, {a.second, c.second, b.second}, face});
      }
    };
    keep(low, next_low, next_high);
    keep(low, next_high, high);
    low = next_low, high = next_high;
  }
}

void SurfaceTessellation::cut_into_pieces(const surface::SurfaceMesh& mesh, const TessellationSize& size) {
  // Corner 0, 1, 2 of the pieces of a face, by its nodes; node 8 of a quadrilateral is its middle.
  static const std::vector<std::array<int, 3>> of_3 = {{0, 1, 2}}, of_6 = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}},
                                               of_4_along_02 = {{0, 1, 2}, {0, 2, 3}},
                                               of_4_along_13 = {{0, 1, 3}, {1, 2, 3}},
                                               of_8 = {{0, 4, 8}, {4, 1, 8}, {1, 5, 8}, {5, 2, 8},
                                                       {2, 6, 8}, {6, 3, 8}, {3, 7, 8}, {7, 0, 8}};
  std::vector<int> corner_of_node(static_cast<std::size_t>(mesh.n_nodes()), -1);
  for (int face = 0; face < mesh.n_faces(); ++face) {
    const auto first = mesh.face_offset(face);
    const int n = static_cast<int>(mesh.face_offset(face + 1) - first);
    if (size.is_two_dimensional && (n == 4 || n == 8)) {
      cut_prism_face(mesh, face, size, corner_of_node);
      continue;
    }
    const auto squared_diagonal = [&](int i, int j) {
      return (mesh.node_position.row(mesh.face_node(first + i)) - mesh.node_position.row(mesh.face_node(first + j)))
          .squaredNorm();
    };
    const auto& cut = n == 3                                             ? of_3
                      : n == 6                                           ? of_6
                      : n == 8                                           ? of_8
                      : squared_diagonal(0, 2) <= squared_diagonal(1, 3) ? of_4_along_02
                                                                         : of_4_along_13;
    std::array<int, 9> corner;
    corner.fill(-1);
    for (const auto& nodes : cut) {
      Piece piece{{}, {}, face};
      for (std::size_t k = 0; k < 3; ++k) {
        const int node = nodes[k];
        int& known = node == 8 ? corner[8] : corner_of_node[static_cast<std::size_t>(mesh.face_node(first + node))];
        piece.at[k] = node_parameters(n, node);
        if (known < 0) known = add_corner(mesh, face, piece.at[k]);
        piece.corner[k] = known;
      }
      piece_.push_back(piece);
    }
  }
}

double SurfaceTessellation::squared_length(int a, int b, bool is_two_dimensional) const {
  const Point &p = position_[static_cast<std::size_t>(a)], &q = position_[static_cast<std::size_t>(b)];
  double sum = 0;
  for (std::size_t d = 0; d < (is_two_dimensional ? 2u : 3u); ++d) sum += (p[d] - q[d]) * (p[d] - q[d]);
  return sum;
}

void SurfaceTessellation::halve_long_sides(const surface::SurfaceMesh& mesh, const std::string& whose,
                                           const TessellationSize& size) {
  const bool flat = size.is_two_dimensional;
  // Round-off must not decide whether a side of just the largest length is cut.
  const double limit = size.largest_side * size.largest_side * (1 + 1e-9);
  for (;;) {
    // Whether a side is cut depends on its two corners alone: both triangles beside it, of one face or two, agree.
    std::unordered_map<std::uint64_t, int> middle;
    for (const Piece& piece : piece_) {
      for (std::size_t k = 0; k < 3; ++k) {
        const int a = piece.corner[k], b = piece.corner[(k + 1) % 3];
        if (squared_length(a, b, flat) > limit) middle.emplace(side_key(a, b), -1);
      }
    }
    if (middle.empty()) return;
    if (piece_.size() + middle.size() > static_cast<std::size_t>(size.largest_n_triangles)) {
      throw report::SceneError(whose,
                               "following this surface with triangles of " + report::text(size.largest_side) +
                                   " m takes more than " + std::to_string(size.largest_n_triangles),
                               "give a larger largest_side, or coarser cells near the surface");
    }
    std::vector<Piece> halved;
    halved.reserve(piece_.size() + 2 * middle.size());
    for (const Piece& piece : piece_) {
      // Corners 0 to 2, then the middles of the sides 0-1, 1-2, 2-0.
      std::array<int, 6> corner{piece.corner[0], piece.corner[1], piece.corner[2], -1, -1, -1};
      std::array<FacePoint, 6> at{piece.at[0], piece.at[1], piece.at[2]};
      std::array<bool, 3> is_cut{};
      int n_cut = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3;
        const auto found = middle.find(side_key(corner[k], corner[next]));
        if (found == middle.end()) continue;
        for (std::size_t d = 0; d < 2; ++d) at[3 + k][d] = (at[k][d] + at[next][d]) / 2;
        if (found->second < 0) found->second = add_corner(mesh, piece.face, at[3 + k]);
        corner[3 + k] = found->second;
        is_cut[k] = true;
        ++n_cut;
      }
      const auto keep = [&](std::size_t a, std::size_t b, std::size_t c) {
        halved.push_back({{corner[a], corner[b], corner[c]}, {at[a], at[b], at[c]}, piece.face});
      };
      if (n_cut == 0) {
        keep(0, 1, 2);
      } else if (n_cut == 3) {
        keep(0, 3, 5), keep(3, 1, 4), keep(5, 4, 2), keep(3, 4, 5);
      } else if (n_cut == 1) {
        const std::size_t k = is_cut[0] ? 0 : is_cut[1] ? 1 : 2;
        keep(k, 3 + k, (k + 2) % 3), keep(3 + k, (k + 1) % 3, (k + 2) % 3);
      } else {  // side a-b is whole; the quadrilateral beside it is cut along its shorter diagonal
        const std::size_t a = !is_cut[0] ? 0 : !is_cut[1] ? 1 : 2, b = (a + 1) % 3, c = (a + 2) % 3;
        keep(3 + b, c, 3 + c);
        if (squared_length(corner[a], corner[3 + b], flat) <= squared_length(corner[b], corner[3 + c], flat)) {
          keep(a, b, 3 + b), keep(a, 3 + b, 3 + c);
        } else {
          keep(a, b, 3 + c), keep(b, 3 + b, 3 + c);
        }
      }
    }
    piece_ = std::move(halved);
  }
}

void SurfaceTessellation::interpolate(const surface::NodeArray& nodal, std::vector<Point>& corner) const {
  assert(nodal.rows() == n_nodes_ && nodal.cols() == 3);
  corner.resize(static_cast<std::size_t>(n_corners()));
  for (std::size_t c = 0; c < corner.size(); ++c) {
    Point sum{};
    for (auto i = static_cast<std::size_t>(offset_[c]); i < static_cast<std::size_t>(offset_[c + 1]); ++i) {
      for (int d = 0; d < 3; ++d) sum[static_cast<std::size_t>(d)] += weight_[i] * nodal(node_[i], d);
    }
    corner[c] = sum;
  }
}

void SurfaceTessellation::gather(std::span<const Point> corner_force, surface::NodeArray& nodal_force) const {
  assert(corner_force.size() == static_cast<std::size_t>(n_corners()));
  nodal_force.setZero(n_nodes_, 3);
  for (std::size_t c = 0; c < corner_force.size(); ++c) {
    for (auto i = static_cast<std::size_t>(offset_[c]); i < static_cast<std::size_t>(offset_[c + 1]); ++i) {
      for (int d = 0; d < 3; ++d) nodal_force(node_[i], d) += weight_[i] * corner_force[c][static_cast<std::size_t>(d)];
    }
  }
}

}  // namespace couplet::flow
