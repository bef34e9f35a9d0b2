#pragma once
// How much of a round opening is left uncovered: the geometric orifice area of a valve.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "solid-server/element/element_packs.hpp"

namespace couplet::solid {

struct OrificeShape {
  std::string name;
  std::vector<std::string> surfaces;                 // that may cover it
  int axis = 0;                                      // along which one looks: 0, 1, 2
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // a point of the axis [m]
  double radius = 0;                                 // of the opening [m]
  int n_cells = 512;                                 // across it
};

/// The opening is a disc of square cells; a cell is covered when its centre lies in the shadow of a face. Curved faces
/// throw the shadow of 4 x 4 flat pieces for each pair of sides. The error is that of counting: about a cell's width
/// times the length of the border of the open area, times 0.1.
class Orifice {
 public:
  /// Throws SceneError for unknown surfaces, naming `where`.
  Orifice(const SolidMesh& mesh, const OrificeShape& shape, const std::string& where);

  const std::string& name() const { return shape_.name; }

  /// Open area at a displacement of all nodes [m^2].
  double area(const NodeVectors& displacement);

 private:
  void cover(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c);

  OrificeShape shape_;
  NodePositions position_;  // of all nodes at rest [m]
  std::vector<FaceNodes> faces_;
  double cell_ = 0;            // width [m]
  std::vector<char> is_open_;  // (n_cells, n_cells)
  std::vector<char> disc_;     // cells whose centre lies in the opening
};

}  // namespace couplet::solid
