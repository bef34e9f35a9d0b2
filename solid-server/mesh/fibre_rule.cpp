#include "solid-server/mesh/fibre_rule.hpp"

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "proto/report/failure.hpp"

namespace couplet::solid {

namespace {

/// `along` and the part of `across` that is perpendicular to it, both of length 1; nothing where there is none.
std::optional<MaterialAxes> perpendicular_axes(const Eigen::Vector3d& along, const Eigen::Vector3d& across) {
  const Eigen::Vector3d first = along.normalized(), rest = across - first * first.dot(across);
  if (!(along.norm() > 0) || !(rest.norm() > 1e-6 * across.norm())) return {};
  return MaterialAxes{first, rest.normalized()};
}

Eigen::Vector3d middle_of(const SolidMesh& mesh, std::span<const Index> nodes) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Index node : nodes) middle += mesh.node_position.row(node).transpose() / static_cast<double>(nodes.size());
  return middle;
}

class AxesOfElement {
 public:
  AxesOfElement(const SolidMesh& mesh, const ElementBlock& block, const std::string& where)
      : mesh_(mesh), block_(block), where_(where) {}

  MaterialAxes operator()(const ConstantFibres& rule) const {
    const auto axes = perpendicular_axes(rule.along, rule.across);
    if (!axes)
      throw report::SceneError(where_, "the directions along and across the fibres are parallel or have no length",
                               "give two directions across each other");
    return *axes;
  }

  MaterialAxes operator()(const CircumferentialFibres& rule) const {
    const Eigen::Vector3d to_middle = middle_of(mesh_, block_.nodes_of(element)) - rule.point;
    const auto axes = perpendicular_axes(rule.direction.cross(to_middle), rule.direction);
    // A middle on the line leaves rounding of its distance only.
    if (!axes || !(rule.direction.cross(to_middle).norm() > 1e-9 * rule.direction.norm() * to_middle.norm()))
      throw report::SceneError(where_,
                               mesh_.describe_element(block_.first_element + element) +
                                   " stands on the line that fibres run around, or the line has no direction",
                               "choose another line");
    return *axes;
  }

  Index element = 0;  // of the block

 private:
  const SolidMesh& mesh_;
  const ElementBlock& block_;
  const std::string& where_;
};

}  // namespace

std::vector<MaterialAxes> axes_by_rule(const FibreRule& rule, const SolidMesh& mesh, const ElementBlock& block,
                                       const std::string& where) {
  AxesOfElement axes_of(mesh, block, where);
  std::vector<MaterialAxes> axes;
  for (; axes_of.element < block.n_elements(); ++axes_of.element) axes.push_back(std::visit(axes_of, rule));
  return axes;
}

}  // namespace couplet::solid
