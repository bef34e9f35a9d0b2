#include "flow-server/immersed/covered_holes.hpp"

#include <algorithm>
#include <limits>
#include <unordered_map>
#include <vector>

#include "flow-server/immersed/triangle_geometry.hpp"

namespace couplet::flow {

namespace {

/// The work grows with the third power: a rim of a thousand corners takes about a second.
constexpr std::size_t most_corners = 2000;

using Chain = std::vector<int>;  // corners, in the order of the edges

/// Free edges one behind the other. Closed chains begin anywhere; of open ones both ends count.
struct Chains {
  std::vector<Chain> closed, open;
};

Chains chains_of(const std::vector<FreeEdge>& edges) {
  std::unordered_map<int, int> next, before;
  for (const FreeEdge& edge : edges) next[edge.from] = edge.to, before[edge.to] = edge.from;
  Chains chains;
  std::unordered_map<int, bool> is_taken;
  const auto follow = [&](int corner) {
    Chain chain;
    for (; next.count(corner) > 0 && !is_taken[corner]; corner = next[corner]) {
      is_taken[corner] = true;
      chain.push_back(corner);
    }
    if (chain.empty()) return;
    if (corner == chain.front()) {
      chains.closed.push_back(chain);
    } else {
      chain.push_back(corner);
      chains.open.push_back(chain);
    }
  };
  for (const FreeEdge& edge : edges)
    if (before.count(edge.from) == 0) follow(edge.from);
  for (const FreeEdge& edge : edges) follow(edge.from);
  return chains;
}

class Rim {
 public:
  Rim(const BodySurface& surface, const Chain& corners) : surface_(surface), corner_(corners), n_(corners.size()) {}

  /// Triangles that go round the other way than the rim does, so that they face as those beside them do.
  std::vector<std::array<int, 3>> fill() {
    cost_.assign(n_ * n_, 0);
    middle_.assign(n_ * n_, 0);
    for (std::size_t span = 2; span < n_; ++span)
      for (std::size_t i = 0; i + span < n_; ++i) {
        const std::size_t k = i + span;
        double best = std::numeric_limits<double>::infinity();
        for (std::size_t m = i + 1; m < k; ++m) {
          const double cost = cost_[i * n_ + m] + cost_[m * n_ + k] + flatness(i, m, k);
          if (cost < best || m == i + 1) best = cost, middle_[i * n_ + k] = m;
        }
        cost_[i * n_ + k] = best;
      }
    std::vector<std::array<int, 3>> triangles;
    collect(0, n_ - 1, triangles);
    return triangles;
  }

 private:
  const Point& position(std::size_t i) const { return surface_.position[static_cast<std::size_t>(corner_[i])]; }

  /// Longest side squared over area: least where all sides are equal, infinite without area.
  double flatness(std::size_t i, std::size_t j, std::size_t k) const {
    const Point &a = position(i), &b = position(j), &c = position(k);
    const double side = std::max({distance(a, b), distance(b, c), distance(c, a)});
    const double area = length(area_vector(a, b, c));
    return area > 1e-9 * side * side ? side * side / area : std::numeric_limits<double>::infinity();
  }

  void collect(std::size_t i, std::size_t k, std::vector<std::array<int, 3>>& triangles) const {
    if (k < i + 2) return;
    const std::size_t m = middle_[i * n_ + k];
    triangles.push_back({corner_[k], corner_[m], corner_[i]});
    collect(i, m, triangles);
    collect(m, k, triangles);
  }

  const BodySurface& surface_;
  const Chain& corner_;
  std::size_t n_;
  std::vector<double> cost_;         // of the best lid between corners i and k
  std::vector<std::size_t> middle_;  // its triangle on the side i-k
};

}  // namespace

int close_covered_holes(BodySurface& surface, const SurfaceTopology& topology,
                        const std::function<bool(const Point&)>& is_covered) {
  // Of each connected part: open chains of two parts have nothing to do with each other.
  int n_lids = 0;
  for (int part = 0; part < topology.n_parts; ++part) {
    std::vector<FreeEdge> edges;
    for (const FreeEdge& edge : topology.free_edge)
      if (topology.part[static_cast<std::size_t>(edge.triangle)] == part) edges.push_back(edge);
    Chains chains = chains_of(edges);
    // Chains of one edge from border to border, where the surface is a prism between them, belong together.
    if (chains.open.size() == 2) {
      chains.open.front().insert(chains.open.front().end(), chains.open.back().begin(), chains.open.back().end());
      chains.open.pop_back();
    }
    std::vector<Chain> rims = chains.closed;
    if (chains.open.size() == 1) rims.push_back(chains.open.front());
    for (const Chain& rim : rims) {
      if (rim.size() < 3 || rim.size() > most_corners) continue;
      const bool is_covered_all_along = std::all_of(rim.begin(), rim.end(), [&](int corner) {
        return is_covered(surface.position[static_cast<std::size_t>(corner)]);
      });
      if (!is_covered_all_along) continue;
      for (const std::array<int, 3>& triangle : Rim(surface, rim).fill()) surface.triangle.push_back(triangle);
      ++n_lids;
    }
  }
  return n_lids;
}

}  // namespace couplet::flow
