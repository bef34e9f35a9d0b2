#pragma once
// Volumes, areas and boundaries of meshes, for tests.

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "solid-server/element/deformation.hpp"

namespace couplet::solid {

/// Throws when the Jacobian is not positive at a point.
inline double volume_of(const SolidMesh& mesh) {
  double volume = 0;
  for (const ElementBlock& block : mesh.block) {
    const auto points = element_quadrature(block.shape, block.shape == ElementShape::tetrahedron10 ? 15 : 27);
    for (Index element = 0; element < block.n_elements(); ++element) {
      const ElementVectors position = at_element(mesh.node_position, block.nodes_of(element));
      for (const auto& point : points) {
        const double part = reference_point(block.shape, position, point).volume;
        if (!(part > 0)) throw std::runtime_error(mesh.describe_element(block.first_element + element) + " is folded");
        volume += part;
      }
    }
  }
  return volume;
}

/// Calls `add` with the normal times the area of each quadrature point of a surface.
template <class Add>
void sweep_surface(const SolidMesh& mesh, const std::string& name, const Add& add) {
  for (const ElementFace& face : mesh.surface.at(name)) {
    const FaceNodes nodes = mesh.nodes_of(face);
    for (const auto& point : face_quadrature(nodes.shape())) {
      const auto gradient = shape_gradient(nodes.shape(), point.xi);
      Eigen::Vector3d along = Eigen::Vector3d::Zero(), across = Eigen::Vector3d::Zero();
      for (std::size_t a = 0; a < nodes.size(); ++a) {
        along += gradient(static_cast<Eigen::Index>(a), 0) * mesh.node_position.row(nodes[a]).transpose();
        across += gradient(static_cast<Eigen::Index>(a), 1) * mesh.node_position.row(nodes[a]).transpose();
      }
      add(Eigen::Vector3d(along.cross(across) * point.weight));
    }
  }
}

inline double area_of(const SolidMesh& mesh, const std::string& name) {
  double area = 0;
  sweep_surface(mesh, name, [&](const Eigen::Vector3d& part) { area += part.norm(); });
  return area;
}

inline Eigen::Vector3d area_vector_of(const SolidMesh& mesh, const std::string& name) {
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  sweep_surface(mesh, name, [&](const Eigen::Vector3d& part) { area += part; });
  return area;
}

/// Faces that belong to one element only.
inline std::size_t n_boundary_faces(const SolidMesh& mesh) {
  std::map<std::vector<Index>, int> count;
  for (Index element = 0; element < mesh.n_elements(); ++element)
    for (int side = 0; side < topology(mesh.block_of(element).shape).n_faces; ++side) {
      const FaceNodes nodes = mesh.nodes_of(ElementFace{element, side});
      std::vector<Index> sorted(nodes.begin(), nodes.end());
      std::sort(sorted.begin(), sorted.end());
      ++count[sorted];
    }
  return static_cast<std::size_t>(
      std::count_if(count.begin(), count.end(), [](const auto& c) { return c.second == 1; }));
}

}  // namespace couplet::solid
