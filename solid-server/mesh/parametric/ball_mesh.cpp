#include "solid-server/mesh/parametric/ball_mesh.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "proto/report/failure.hpp"
#include "solid-server/mesh/parametric/merge_patches.hpp"
#include "solid-server/mesh/parametric/structured_block.hpp"

namespace couplet::solid {

namespace {

/// The rounded cube's faces stand at this share of the radius.
constexpr double cube_share = 0.5;

/// What is kept of the cube [-1, 1]^3 along an axis.
struct Range {
  int from = -1, to = 1;
  int length() const { return to - from; }
};

/// A point of the cube [-1, 1]^3 in the rounded cube of a unit ball: half way between a cube and the ball that
/// x sqrt(1 - y^2/2 - z^2/2 + y^2 z^2/3), cyclic, makes of it [Nowell 2005].
Eigen::Vector3d in_rounded_cube(const Eigen::Vector3d& xi) {
  const Eigen::Vector3d q = xi.cwiseAbs2();
  const auto stretch = [](double a, double b) { return std::sqrt(1 - a / 2 - b / 2 + a * b / 3); };
  const Eigen::Vector3d ball =
      xi.cwiseProduct(Eigen::Vector3d(stretch(q[1], q[2]), stretch(q[2], q[0]), stretch(q[0], q[1])));
  return cube_share * (xi + ball) / 2;
}

/// A point of the cube's surface on the unit sphere, even by angle.
Eigen::Vector3d on_sphere(const Eigen::Vector3d& xi) {
  return (xi * (std::numbers::pi / 4)).array().tan().matrix().normalized();
}

class BallPatches {
 public:
  explicit BallPatches(const BallShape& shape) : shape_(shape) {
    if (shape.part == BallPart::lower_half) range_[1] = {-1, 0};
    if (shape.part == BallPart::upper_half) range_[1] = {0, 1};
    if (shape.is_quarter) range_[0] = range_[2] = {0, 1};
  }

  SolidMesh mesh() {
    add_cube();
    for (const std::size_t axis : {0u, 1u, 2u}) {
      if (range_[axis].from == -1) add_shell(axis, -1);
      if (range_[axis].to == 1) add_shell(axis, 1);
    }
    return merge_patches(patches_);
  }

 private:
  int n_along(std::size_t axis) const { return shape_.n_elements * range_[axis].length(); }
  /// Of a lattice of half elements along an axis.
  double coordinate(std::size_t axis, int place) const { return range_[axis].from + place / (2.0 * shape_.n_elements); }

  /// Names the sides of a patch that lie in planes through the centre; `first` and `second` are the axes of xi and eta.
  void name_cuts(SolidMesh& patch, const StructuredBlock& block, std::size_t axis, hex20::Side low) const {
    const Range& range = range_[axis];
    if (range.length() == 2) return;
    const char* const name = axis == 0 ? "x_min" : axis == 1 ? "cut" : "z_min";
    patch.surface[name] = block.side(range.from == 0 ? low : static_cast<hex20::Side>(low + 1));
  }

  void add_cube() {
    const StructuredBlock block(n_along(0), n_along(1), n_along(2));
    SolidMesh patch = block.mesh([&](const HalfIndex& place) -> Eigen::Vector3d {
      const Eigen::Vector3d xi(coordinate(0, place.i), coordinate(1, place.j), coordinate(2, place.k));
      return shape_.centre + shape_.radius * in_rounded_cube(xi);
    });
    name_cuts(patch, block, 0, hex20::xi_min);
    name_cuts(patch, block, 1, hex20::eta_min);
    name_cuts(patch, block, 2, hex20::zeta_min);
    patches_.push_back(std::move(patch));
  }

  /// On the cube's face at xi_axis = sign: zeta goes outwards, so xi and eta follow in the right-hand order.
  void add_shell(std::size_t axis, int sign) {
    std::size_t first = (axis + 1) % 3, second = (axis + 2) % 3;
    if (sign < 0) std::swap(first, second);
    const int n_shell = shape_.n_elements;
    const StructuredBlock block(n_along(first), n_along(second), n_shell);
    SolidMesh patch = block.mesh([&](const HalfIndex& place) -> Eigen::Vector3d {
      Eigen::Vector3d xi;
      xi[static_cast<Eigen::Index>(axis)] = sign;
      xi[static_cast<Eigen::Index>(first)] = coordinate(first, place.i);
      xi[static_cast<Eigen::Index>(second)] = coordinate(second, place.j);
      const double share = place.k / (2.0 * n_shell);
      return shape_.centre + shape_.radius * ((1 - share) * in_rounded_cube(xi) + share * on_sphere(xi));
    });
    name_cuts(patch, block, first, hex20::xi_min);
    name_cuts(patch, block, second, hex20::eta_min);
    patch.surface["surface"] = block.side(hex20::zeta_max);
    patches_.push_back(std::move(patch));
  }

  BallShape shape_;
  std::array<Range, 3> range_;
  std::vector<SolidMesh> patches_;
};

}  // namespace

SolidMesh make_ball_mesh(const BallShape& shape) {
  if (!(shape.radius > 0))
    throw report::SceneError("ball", "radius of " + report::text(shape.radius) + " m is not above 0");
  if (shape.n_elements < 1)
    throw report::SceneError("ball", "a number of elements of " + std::to_string(shape.n_elements) + " is not above 0");
  return BallPatches(shape).mesh();
}

}  // namespace couplet::solid
