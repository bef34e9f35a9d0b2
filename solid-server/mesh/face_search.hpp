#pragma once
// Which elements have a face between given nodes.

#include <array>
#include <cstddef>
#include <span>
#include <unordered_map>

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// Name the faces that are wanted, sweep through the mesh once, then ask. Only wanted faces take memory.
class FaceSearch {
 public:
  using Key = std::array<Index, 4>;  // corners, rising; the last is -1 for triangles

  struct Found {
    int n_elements = 0;  // that have this face
    ElementFace first;   // of them
  };

  static Key key_of(std::span<const Index> corners);
  static Key key_of(const SolidMesh& mesh, const ElementFace& face);

  void want(const Key& key) { found_.try_emplace(key); }
  void sweep(const SolidMesh& mesh);
  /// Of a wanted face.
  const Found& find(const Key& key) const { return found_.at(key); }

 private:
  struct Hash {
    std::size_t operator()(const Key& key) const;
  };
  std::unordered_map<Key, Found, Hash> found_;
};

}  // namespace couplet::solid
