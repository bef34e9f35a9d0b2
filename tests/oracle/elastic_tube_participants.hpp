#pragma once
// The elastic tube's flow and wall as two participants that exchange area and pressure.

#include "tests/oracle/elastic_tube.hpp"
#include "tests/oracle/oracle_participant.hpp"

namespace couplet::oracle {

/// The flow as a participant: takes `area`, gives `pressure`, both (n_nodes, 1).
class ElasticTubeFlow : public OracleParticipant<TubeFlowState> {
 public:
  explicit ElasticTubeFlow(ElasticTube tube) : OracleParticipant(rest_state(tube)), tube_(tube) {}

 private:
  surface::SurfaceMesh nodes() const override { return row_of_nodes(tube_.n_cells + 1, tube_.length); }
  std::vector<std::string> needs() const override { return {"area"}; }
  surface::FieldSet offered(const TubeFlowState& state) const override;
  TubeFlowState solve(const TubeFlowState& accepted, const participant::StepInterval& interval,
                      const surface::FieldSet& fields) const override;
  participant::NamedNumber quantity(const TubeFlowState& accepted) const override;

  ElasticTube tube_;
};

/// The wall has no inertia and no memory: its area is its state.
struct TubeWallState {
  Eigen::VectorXd area;  // (n_cells + 1) [m^2]

  surface::NodeArray columns() const { return area; }
  static TubeWallState from_columns(const surface::NodeArray& columns) { return {columns.col(0)}; }
};

/// The wall as a participant: takes `pressure`, gives `area`.
class ElasticTubeWall : public OracleParticipant<TubeWallState> {
 public:
  explicit ElasticTubeWall(ElasticTube tube) : OracleParticipant({rest_state(tube).area}), tube_(tube) {}

 private:
  surface::SurfaceMesh nodes() const override { return row_of_nodes(tube_.n_cells + 1, tube_.length); }
  std::vector<std::string> needs() const override { return {"pressure"}; }
  surface::FieldSet offered(const TubeWallState& state) const override;
  TubeWallState solve(const TubeWallState& accepted, const participant::StepInterval& interval,
                      const surface::FieldSet& fields) const override;
  participant::NamedNumber quantity(const TubeWallState& accepted) const override;

  ElasticTube tube_;
};

}  // namespace couplet::oracle
