#pragma once
// How fast bodies move that a scene moves.

#include <optional>
#include <string>
#include <vector>

#include "flow-server/grid/stretched_grid.hpp"
#include "flow-server/immersed/body_setup.hpp"

namespace couplet::flow {

struct BodySpeed {
  std::string name;
  double speed = 0;  // largest of a point of the body [m/s]
  double cells = 0;  // that it passes in a second, of those where it is then: largest sum of |u| / dx [1/s]
};

/// Of the fastest body with a prescribed motion between t = 0 and the end of the run [s], from some hundred times and
/// some thousand of its nodes; none where all are fixed or moved from outside.
std::optional<BodySpeed> fastest_body(const std::vector<BodySetup>& bodies, const StretchedGrid& grid, double end_time);

/// For the log: where a body passes more than a cell in `step` [s], that the flow will take shorter ones.
std::optional<std::string> note_on_speed(const std::vector<BodySetup>& bodies, const StretchedGrid& grid, double step,
                                         double end_time);

}  // namespace couplet::flow
