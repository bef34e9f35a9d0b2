#include "solid-server/contact/penalty_stiffness.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "solid-server/element/deformation.hpp"

namespace couplet::solid {

namespace {

double volume(const SolidMesh& mesh, Index element) {
  const ElementShape shape = mesh.block_of(element).shape;
  double sum = 0;
  for (const QuadraturePoint& point : element_quadrature(shape, n_mass_points(shape)))
    sum += reference_point(shape, at_element(mesh.node_position, mesh.nodes_of(element)), point).volume;
  return sum;
}

double area(const SolidMesh& mesh, const FaceNodes& nodes) {
  double sum = 0;
  for (const FaceQuadraturePoint& point : face_quadrature(nodes.shape())) {
    const auto gradient = shape_gradient(nodes.shape(), point.xi);
    Eigen::Vector3d t[2] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    for (std::size_t a = 0; a < nodes.size(); ++a)
      for (int k = 0; k < 2; ++k)
        t[k] += mesh.node_position.row(nodes[a]).transpose() * gradient(static_cast<Eigen::Index>(a), k);
    sum += point.weight * t[0].cross(t[1]).norm();
  }
  return sum;
}

}  // namespace

Backing backing_of(const SolidMesh& mesh, const std::vector<BlockProperties>& properties,
                   const std::vector<ElementFace>& faces) {
  Backing backing{std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
  for (const ElementFace& face : faces) {
    const ElementBlock& block = mesh.block_of(face.element);
    const double shape_factor = block.shape == ElementShape::tetrahedron10 ? 3 : 1;
    const double thickness = shape_factor * volume(mesh, face.element) / area(mesh, mesh.nodes_of(face));
    const double modulus =
        std::visit([](const auto& law) { return law.bulk_modulus_at_rest() + 4.0 / 3 * law.shear_modulus(); },
                   properties[static_cast<std::size_t>(&block - mesh.block.data())].material);
    backing.thickness = std::min(backing.thickness, thickness);
    backing.stiffness = std::min(backing.stiffness, modulus / thickness);
  }
  return backing;
}

ContactPair complete(ContactPair pair, const SolidMesh& mesh, const std::vector<BlockProperties>& properties, int n) {
  if (pair.stiffness != 0 && pair.largest_depth != 0) return pair;
  const std::string where = "solid.contact[" + std::to_string(n) + "].";
  const Backing first = backing_of(mesh, properties, mesh.find_surface(pair.first, where + "first"));
  const Backing second = backing_of(mesh, properties, mesh.find_surface(pair.other(), where + "second"));
  if (pair.stiffness == 0) pair.stiffness = std::min(first.stiffness, second.stiffness);
  if (pair.largest_depth == 0) pair.largest_depth = std::min(first.thickness, second.thickness) / 2;
  return pair;
}

}  // namespace couplet::solid
