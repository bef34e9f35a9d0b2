#pragma once
// Material axes of elements by a rule.

#include <variant>
#include <vector>

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// The same axes everywhere. `across` need not be perpendicular to `along`: its part along it is left out.
struct ConstantFibres {
  Eigen::Vector3d along = Eigen::Vector3d::UnitX();
  Eigen::Vector3d across = Eigen::Vector3d::UnitY();
};

/// Around a line: the first axis is the line's direction times the radial direction at the element's middle, the second
/// the line's direction.
struct CircumferentialFibres {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();       // of the line [m]
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // of the line
};

using FibreRule = std::variant<ConstantFibres, CircumferentialFibres>;

/// Axes of every element of a block, (n_elements). Throws SceneError naming `where` for directions without a length or
/// parallel ones, and for an element on the line.
std::vector<MaterialAxes> axes_by_rule(const FibreRule& rule, const SolidMesh& mesh, const ElementBlock& block,
                                       const std::string& where);

}  // namespace couplet::solid
