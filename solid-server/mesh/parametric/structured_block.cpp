#include "solid-server/mesh/parametric/structured_block.hpp"

#include <cassert>

namespace couplet::solid {

StructuredBlock::StructuredBlock(int n_x, int n_y, int n_z) : n_{n_x, n_y, n_z} {
  assert(n_x > 0 && n_y > 0 && n_z > 0);
  const auto places = [](int n) { return static_cast<std::size_t>(2 * n + 1); };
  node_.assign(places(n_x) * places(n_y) * places(n_z), -1);
  for (int k = 0; k <= 2 * n_z; ++k)
    for (int j = 0; j <= 2 * n_y; ++j)
      for (int i = 0; i <= 2 * n_x; ++i)
        if (i % 2 + j % 2 + k % 2 <= 1) node_[place_number({i, j, k})] = n_nodes_++;
}

std::size_t StructuredBlock::place_number(const HalfIndex& place) const {
  const auto width = static_cast<std::size_t>(2 * n_[0] + 1), height = static_cast<std::size_t>(2 * n_[1] + 1);
  return (static_cast<std::size_t>(place.k) * height + static_cast<std::size_t>(place.j)) * width +
         static_cast<std::size_t>(place.i);
}

Index StructuredBlock::node_at(const HalfIndex& place) const {
  return node_[place_number(place)];
}

Index StructuredBlock::element_at(int i, int j, int k) const {
  return (k * n_[1] + j) * n_[0] + i;
}

SolidMesh StructuredBlock::mesh(const std::function<Eigen::Vector3d(const HalfIndex&)>& position) const {
  SolidMesh mesh;
  mesh.node_position.resize(n_nodes_, 3);
  for (int k = 0; k <= 2 * n_[2]; ++k)
    for (int j = 0; j <= 2 * n_[1]; ++j)
      for (int i = 0; i <= 2 * n_[0]; ++i)
        if (const Index node = node_at({i, j, k}); node >= 0) mesh.node_position.row(node) = position({i, j, k});

  ElementBlock& block = mesh.block.emplace_back();
  for (int k = 0; k < n_[2]; ++k)
    for (int j = 0; j < n_[1]; ++j)
      for (int i = 0; i < n_[0]; ++i)
        for (const auto& c : hex20::node_coordinate)
          block.node.push_back(node_at({2 * i + 1 + c[0], 2 * j + 1 + c[1], 2 * k + 1 + c[2]}));
  block.n_elements_per_layer = n_[0] * n_[1];
  return mesh;
}

std::vector<ElementFace> StructuredBlock::side(hex20::Side side) const {
  const int axis = side / 2;
  const int fixed = side % 2 == 0 ? 0 : n_[static_cast<std::size_t>(axis)] - 1;
  std::vector<ElementFace> faces;
  for (int k = 0; k < n_[2]; ++k)
    for (int j = 0; j < n_[1]; ++j)
      for (int i = 0; i < n_[0]; ++i)
        if (std::array{i, j, k}[static_cast<std::size_t>(axis)] == fixed) faces.push_back({element_at(i, j, k), side});
  return faces;
}

}  // namespace couplet::solid
