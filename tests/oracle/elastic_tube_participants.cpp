#include "tests/oracle/elastic_tube_participants.hpp"

namespace couplet::oracle {

using participant::NamedNumber;
using participant::StepInterval;
using surface::FieldSet;

FieldSet ElasticTubeFlow::offered(const TubeFlowState& state) const {
  return {{"pressure", "Pa", state.pressure}};
}

TubeFlowState ElasticTubeFlow::solve(const TubeFlowState& accepted, const StepInterval& interval,
                                     const FieldSet& fields) const {
  const Eigen::VectorXd area = surface::find_field(fields, "area").values;
  return solve_tube_flow(tube_, accepted, area, interval.start + interval.duration, interval.duration);
}

NamedNumber ElasticTubeFlow::quantity(const TubeFlowState& accepted) const {
  return {"inlet_pressure", accepted.pressure(0), "Pa"};
}

FieldSet ElasticTubeWall::offered(const TubeWallState& state) const {
  return {{"area", "m^2", state.area}};
}

TubeWallState ElasticTubeWall::solve(const TubeWallState&, const StepInterval&, const FieldSet& fields) const {
  return {tube_.wall_area(surface::find_field(fields, "pressure").values)};
}

NamedNumber ElasticTubeWall::quantity(const TubeWallState& accepted) const {
  return {"largest_area", accepted.area.maxCoeff(), "m^2"};
}

}  // namespace couplet::oracle
