#include "solid-server/dynamics/length_change.hpp"

#include <algorithm>
#include <cmath>

#include "solid-server/dynamics/work_team.hpp"
#include "solid-server/element/lane_transpose.hpp"

namespace couplet::solid {

namespace {

constexpr int max_corners = 8;
constexpr std::array<std::array<int, 2>, 4> hexahedron_diagonal = {{{0, 6}, {1, 7}, {2, 4}, {3, 5}}};

using Corners = Pack[max_corners][3];

[[gnu::always_inline]] inline Pack squared_length(const Corners& at, const std::array<int, 2>& ends) {
  const auto a = static_cast<std::size_t>(ends[0]), b = static_cast<std::size_t>(ends[1]);
  const Pack x = at[b][0] - at[a][0], y = at[b][1] - at[a][1], z = at[b][2] - at[a][2];
  return x * x + y * y + z * z;
}

}  // namespace

LengthChange::LengthChange(const SolidMesh& mesh) {
  position_ = NodeVectors::Zero(mesh.n_nodes(), 4);
  position_.leftCols<3>() = mesh.node_position;
  for (const ElementBlock& of_mesh : mesh.block) {
    Block& block = blocks_.emplace_back();
    const ElementTopology& shape = topology(of_mesh.shape);
    block.n_corners = shape.n_corners;
    for (const auto& edge : shape.edge)
      if (edge[0] >= 0) block.length.push_back(edge);
    if (shape.n_corners == max_corners)
      block.length.insert(block.length.end(), hexahedron_diagonal.begin(), hexahedron_diagonal.end());
    const Index n_elements = of_mesh.n_elements();
    for (Index first = 0; first < n_elements; first += n_lanes)
      for (std::size_t corner = 0; corner < static_cast<std::size_t>(block.n_corners); ++corner)
        for (Index lane = 0; lane < n_lanes; ++lane)  // the last pack is filled up with copies of the last element
          block.node_start.push_back(NodeVectors::ColsAtCompileTime *
                                     of_mesh.nodes_of(std::min(first + lane, n_elements - 1))[corner]);
  }
}

double LengthChange::largest(const NodeVectors& before, const NodeVectors& displacement, int member,
                             int n_members) const {
  Pack most = Pack{} + 1.0, least = Pack{} + 1.0;  // of (l/l0)^2
  for (const Block& block : blocks_) {
    const Index pack_size = block.n_corners * n_lanes;
    const auto [first, last] = share_of(static_cast<Index>(block.node_start.size()) / pack_size, member, n_members);
    for (Index p = first; p < last; ++p) {
      Corners now, then;
      for (int corner = 0; corner < block.n_corners; ++corner) {
        const Index* const start = &block.node_start[static_cast<std::size_t>(p * pack_size + corner * n_lanes)];
        Pack rest[3];
        load_nodes(position_.data(), start, rest[0], rest[1], rest[2]);
        load_nodes(displacement.data(), start, now[corner][0], now[corner][1], now[corner][2]);
        load_nodes(before.data(), start, then[corner][0], then[corner][1], then[corner][2]);
        for (int i = 0; i < 3; ++i) {
          now[corner][i] += rest[i];
          then[corner][i] += rest[i];
        }
      }
      for (const auto& ends : block.length) {
        const Pack ratio = squared_length(now, ends) / squared_length(then, ends);
        most = ratio > most ? ratio : most;
        least = ratio < least ? ratio : least;
      }
    }
  }
  double change = 0;
  for (int lane = 0; lane < n_lanes; ++lane)
    change = std::max({change, std::sqrt(most[lane]) - 1, 1 / std::sqrt(least[lane]) - 1});
  return change;
}

std::size_t LengthChange::memory_bytes() const {
  std::size_t n_indices = 0;
  for (const Block& block : blocks_) n_indices += block.node_start.size();
  return static_cast<std::size_t>(position_.size()) * sizeof(double) + n_indices * sizeof(Index);
}

}  // namespace couplet::solid
