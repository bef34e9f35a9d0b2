#pragma once
// What can hold on the borders of the grid. Periodic directions are a property of the axis, not a condition.

#include <array>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "flow-server/boundary/space_time_value.hpp"

namespace couplet::flow {

/// The fluid has this velocity: a wall (0, or the wall's own), an inlet.
struct PrescribedVelocity {
  VectorValue velocity;  // [m/s]
};

/// The pressure is given and the fluid passes as it likes, in or out. Fluid that comes in from outside comes straight.
struct PressureOpening {
  SpaceTimeValue pressure;  // [Pa]
};

/// What arrives is carried out with the mean speed of outflow; the sum over all outflows balances the inflow.
struct ConvectiveOutflow {};

/// No normal velocity and no shear: a symmetry plane, a frictionless wall.
struct SlipWall {};

using FaceCondition = std::variant<PrescribedVelocity, PressureOpening, ConvectiveOutflow, SlipWall>;

/// The part of a border inside a box, in coordinates; the direction normal to the border does not count.
struct FacePatch {
  std::string name;
  Point from{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
             -std::numeric_limits<double>::infinity()};
  Point to{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
           std::numeric_limits<double>::infinity()};
  FaceCondition condition;
};

/// For each direction and side (0: start, 1: end) the patches; of those that contain the middle of a face the last one
/// counts, where there is none it is a wall at rest.
using BorderConditions = std::array<std::array<std::vector<FacePatch>, 2>, 3>;

}  // namespace couplet::flow
