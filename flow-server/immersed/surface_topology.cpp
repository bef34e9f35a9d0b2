#include "flow-server/immersed/surface_topology.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "flow-server/immersed/triangle_geometry.hpp"
#include "proto/report/failure.hpp"

namespace couplet::flow {
namespace {

std::string text(const Point& p) {
  return "(" + report::text(p[0]) + ", " + report::text(p[1]) + ", " + report::text(p[2]) + ")";
}

struct HalfEdge {
  int high;  // the higher corner; the lower one is that of its bucket
  int side;  // 3 * triangle + k
};

/// Share of a triangle in the flux of a field of divergence 1 that does not cross the planes: (x - x_0) / n over the n
/// axes without two planes, x_0 on the plane where there is one.
double volume_under(const BodySurface& surface, std::size_t triangle, std::span<const BorderPlane> planes,
                    const Point& origin) {
  std::array<int, 3> n_planes{};
  Point zero = origin;
  for (const BorderPlane& plane : planes) {
    ++n_planes[static_cast<std::size_t>(plane.axis)];
    zero[static_cast<std::size_t>(plane.axis)] = plane.position;
  }
  const auto [a, b, c] = surface.triangle[triangle];
  const Point &p = surface.position[static_cast<std::size_t>(a)], &q = surface.position[static_cast<std::size_t>(b)],
              &r = surface.position[static_cast<std::size_t>(c)];
  const Point area = area_vector(p, q, r);
  double flux = 0;
  int n_axes = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    if (n_planes[d] > 1) continue;
    flux += ((p[d] + q[d] + r[d]) / 3 - zero[d]) * area[d];
    ++n_axes;
  }
  return n_axes > 0 ? flux / n_axes : 0;
}

class SurfaceWalk {
 public:
  SurfaceWalk(BodySurface& surface, std::span<const BorderPlane> planes) : surface_(surface), planes_(planes) {
    for (const Point& p : surface.position) {
      for (std::size_t d = 0; d < 3; ++d) {
        low_[d] = std::min(low_[d], p[d]);
        high_[d] = std::max(high_[d], p[d]);
      }
    }
    for (std::size_t d = 0; d < 3; ++d) size_ = std::max(size_, high_[d] - low_[d]);
  }

  SurfaceTopology run(FluidSide fluid) {
    refuse_flat_triangles();
    join();
    orient_parts();
    sort_free_edges();
    if (surface_.is_closed) close(fluid);
    return std::move(result_);
  }

 private:
  [[noreturn]] void refuse(const std::string& sentence, const std::string& advice) const {
    throw report::SceneError("surface '" + surface_.name + "'", sentence, advice);
  }
  const Point& position(int corner) const { return surface_.position[static_cast<std::size_t>(corner)]; }
  std::array<int, 2> ends(int side) const {
    const auto& corners = surface_.triangle[static_cast<std::size_t>(side / 3)];
    const auto k = static_cast<std::size_t>(side % 3);
    return {corners[k], corners[(k + 1) % 3]};
  }
  std::string named(int side) const {
    const auto [a, b] = ends(side);
    return "the edge from " + text(position(a)) + " to " + text(position(b));
  }

  void refuse_flat_triangles() const {
    for (std::size_t t = 0; t < surface_.triangle.size(); ++t) {
      const auto [a, b, c] = surface_.triangle[t];
      const double area = length(area_vector(position(a), position(b), position(c)));
      const double side = std::max(
          {distance(position(a), position(b)), distance(position(b), position(c)), distance(position(c), position(a))});
      // Thinner than 1e-10 of its length is round-off of a line.
      if (a == b || b == c || c == a || !(area > 0.5e-10 * side * side)) {
        refuse("triangle " + std::to_string(t) + " at " + text(position(a)) + " has no area",
               "remove it, or mend the mesh with the program that made it");
      }
    }
  }

  /// Sorts sides into buckets by their lower corner; equal ones then lie side by side.
  void join() {
    const std::size_t n_corners = surface_.position.size();
    const int n_sides = 3 * static_cast<int>(surface_.triangle.size());
    std::vector<int> first(n_corners + 1, 0);
    for (int side = 0; side < n_sides; ++side) ++first[static_cast<std::size_t>(std::ranges::min(ends(side))) + 1];
    for (std::size_t c = 0; c < n_corners; ++c) first[c + 1] += first[c];
    std::vector<HalfEdge> bucket(static_cast<std::size_t>(n_sides));
    std::vector<int> next(first.begin(), first.end() - 1);
    for (int side = 0; side < n_sides; ++side) {
      const auto [low, high] = std::ranges::minmax(ends(side));
      bucket[static_cast<std::size_t>(next[static_cast<std::size_t>(low)]++)] = {high, side};
    }
    result_.neighbour.assign(surface_.triangle.size(), {-1, -1, -1});
    for (std::size_t c = 0; c < n_corners; ++c) {
      const auto begin = bucket.begin() + first[c], end = bucket.begin() + first[c + 1];
      std::sort(begin, end, [](const HalfEdge& a, const HalfEdge& b) {
        return a.high != b.high ? a.high < b.high : a.side < b.side;
      });
      for (auto edge = begin; edge != end;) {
        auto last = edge;
        while (last != end && last->high == edge->high) ++last;
        const auto count = last - edge;
        if (count > 2) {
          refuse(named(edge->side) + " belongs to " + std::to_string(count) + " triangles",
                 "a surface does not branch: give each branch as a body of its own, or remove double triangles");
        }
        if (count == 2) {
          neighbour_of(edge[0].side) = edge[1].side / 3;
          neighbour_of(edge[1].side) = edge[0].side / 3;
        }
        edge = last;
      }
    }
  }
  int& neighbour_of(int side) {
    return result_.neighbour[static_cast<std::size_t>(side / 3)][static_cast<std::size_t>(side % 3)];
  }

  /// Whether the triangle goes along its side k in the same direction as its neighbour does.
  bool disagrees(int triangle, std::size_t k, int neighbour) const {
    const auto [a, b] = ends(3 * triangle + static_cast<int>(k));
    const auto& other = surface_.triangle[static_cast<std::size_t>(neighbour)];
    for (std::size_t i = 0; i < 3; ++i)
      if (other[i] == a && other[(i + 1) % 3] == b) return true;
    return false;
  }

  void turn(int triangle) {
    auto& corners = surface_.triangle[static_cast<std::size_t>(triangle)];
    auto& across = result_.neighbour[static_cast<std::size_t>(triangle)];
    std::swap(corners[1], corners[2]);  // sides 0-1, 1-2, 2-0 become 0-2, 2-1, 1-0
    std::swap(across[0], across[2]);
  }

  void orient_parts() {
    const std::size_t n = surface_.triangle.size();
    result_.part.assign(n, -1);
    std::vector<char> is_turned(n, 0);
    std::vector<int> members;
    int n_turned = 0;
    for (std::size_t seed = 0; seed < n; ++seed) {
      if (result_.part[seed] >= 0) continue;
      members.assign(1, static_cast<int>(seed));
      result_.part[seed] = result_.n_parts;
      std::size_t turned_here = 0;
      for (std::size_t m = 0; m < members.size(); ++m) {
        const int triangle = members[m];
        for (std::size_t k = 0; k < 3; ++k) {
          const int other = result_.neighbour[static_cast<std::size_t>(triangle)][k];
          if (other < 0) continue;
          const auto o = static_cast<std::size_t>(other);
          const bool differs =
              disagrees(triangle, k, other) != (is_turned[static_cast<std::size_t>(triangle)] != is_turned[o]);
          if (result_.part[o] < 0) {
            result_.part[o] = result_.n_parts;
            is_turned[o] = differs;
            turned_here += differs;
            members.push_back(other);
          } else if (differs) {
            refuse(named(3 * triangle + static_cast<int>(k)) +
                       " joins two triangles that cannot face the same way: the surface has one side only",
                   "cut the surface there");
          }
        }
      }
      const bool keeps_seed = 2 * turned_here <= members.size();
      for (const int triangle : members) {
        if (static_cast<bool>(is_turned[static_cast<std::size_t>(triangle)]) == keeps_seed) {
          to_turn_.push_back(triangle);
          ++n_turned;
        }
      }
      ++result_.n_parts;
    }
    for (const int triangle : to_turn_) turn(triangle);
    if (n_turned > 0) {
      result_.notes.push_back("surface '" + surface_.name + "': " + std::to_string(n_turned) + " of " +
                              std::to_string(n) + " triangles faced the other way than those beside them; turned");
    }
  }

  /// The number of the plane that both corners lie on, or -1.
  int border_of(int corner_a, int corner_b) const {
    const double near = 1e-6 * size_;  // files hold seven digits; far less than any triangle
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      const auto d = static_cast<std::size_t>(planes_[i].axis);
      if (std::abs(position(corner_a)[d] - planes_[i].position) <= near &&
          std::abs(position(corner_b)[d] - planes_[i].position) <= near)
        return static_cast<int>(i);
    }
    return -1;
  }

  void sort_free_edges() {
    std::vector<char> ends_on(planes_.size(), 0);
    for (int side = 0; side < 3 * static_cast<int>(surface_.triangle.size()); ++side) {
      if (neighbour_of(side) >= 0) continue;
      const auto [a, b] = ends(side);
      const int border = border_of(a, b);
      if (border >= 0) ends_on[static_cast<std::size_t>(border)] = 1;
      (border >= 0 ? result_.border_edge : result_.free_edge).push_back({a, b, side / 3});
    }
    for (std::size_t i = 0; i < planes_.size(); ++i)
      if (ends_on[i]) result_.border_plane.push_back(planes_[i]);
  }

  void close(FluidSide fluid) {
    if (!result_.free_edge.empty()) {
      const FreeEdge& edge = result_.free_edge.front();
      const std::size_t n = result_.free_edge.size();
      refuse("should be closed but has a hole: the edge from " + text(position(edge.from)) + " to " +
                 text(position(edge.to)) + " belongs to one triangle only" +
                 (n > 1 ? ", like " + std::to_string(n - 1) + " others" : ""),
             "close the hole, join nodes that lie at the same place, or call the surface thin");
    }
    const double sign = fluid == FluidSide::outside ? 1 : -1;
    std::vector<double> volume(static_cast<std::size_t>(result_.n_parts), 0.0);
    std::vector<std::array<Point, 2>> box(volume.size(), {Point{1e300, 1e300, 1e300}, Point{-1e300, -1e300, -1e300}});
    for (std::size_t t = 0; t < surface_.triangle.size(); ++t) {
      const auto part = static_cast<std::size_t>(result_.part[t]);
      const auto [a, b, c] = surface_.triangle[t];
      volume[part] += volume_of(t);
      for (const int corner : {a, b, c}) {
        for (std::size_t d = 0; d < 3; ++d) {
          box[part][0][d] = std::min(box[part][0][d], position(corner)[d]);
          box[part][1][d] = std::max(box[part][1][d], position(corner)[d]);
        }
      }
    }
    std::vector<char> turns(volume.size(), 0);
    for (std::size_t part = 0; part < volume.size(); ++part) {
      if (sign * volume[part] >= 0) continue;
      bool is_cavity = false;
      for (std::size_t other = 0; other < volume.size(); ++other)
        is_cavity = is_cavity || (other != part && lies_inside(box[part], box[other]));
      if (is_cavity) {
        result_.notes.push_back("surface '" + surface_.name + "': the part at " + text(box[part][0]) +
                                " lies inside another and faces inwards: a cavity");
        continue;
      }
      turns[part] = 1;
      volume[part] *= -1;
      result_.notes.push_back("surface '" + surface_.name +
                              "': " + (volume.size() > 1 ? "the part at " + text(box[part][0]) + " was" : "was") +
                              " inside out; turned");
    }
    for (std::size_t t = 0; t < surface_.triangle.size(); ++t)
      if (turns[static_cast<std::size_t>(result_.part[t])]) turn(static_cast<int>(t));
    if (std::any_of(turns.begin(), turns.end(), [](char turned) { return turned != 0; }))
      for (FreeEdge& edge : result_.border_edge)
        if (turns[static_cast<std::size_t>(result_.part[static_cast<std::size_t>(edge.triangle)])])
          std::swap(edge.from, edge.to);
    for (const double part : volume) result_.volume += part;
  }

  /// Strictly: two parts with the same box are beside each other, not inside.
  static bool lies_inside(const std::array<Point, 2>& inner, const std::array<Point, 2>& outer) {
    bool inside = true, differs = false;
    for (std::size_t d = 0; d < 3; ++d) {
      inside = inside && inner[0][d] >= outer[0][d] && inner[1][d] <= outer[1][d];
      differs = differs || inner[0][d] > outer[0][d] || inner[1][d] < outer[1][d];
    }
    return inside && differs;
  }

  double volume_of(std::size_t triangle) const { return volume_under(surface_, triangle, result_.border_plane, low_); }

 private:
  BodySurface& surface_;
  std::span<const BorderPlane> planes_;
  Point low_{1e300, 1e300, 1e300}, high_{-1e300, -1e300, -1e300};
  double size_ = 0;
  SurfaceTopology result_;
  std::vector<int> to_turn_;
};

}  // namespace

SurfaceTopology orient_surface(BodySurface& surface, FluidSide fluid, std::span<const BorderPlane> planes) {
  return SurfaceWalk(surface, planes).run(fluid);
}

double enclosed_volume(const BodySurface& surface, std::span<const BorderPlane> ended_on) {
  double volume = 0;
  for (std::size_t t = 0; t < surface.triangle.size(); ++t)
    volume += volume_under(surface, t, ended_on, surface.position.front());
  return volume;
}

}  // namespace couplet::flow
