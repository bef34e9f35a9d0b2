#pragma once
// The fields of a body over time, for ParaView.

#include <optional>

#include "couplet/v1/scene.pb.h"
#include "proto/store/result_file.hpp"
#include "solid-server/output/tissue_fields.hpp"
#include "solid-server/solid_model.hpp"

namespace couplet::solid {

/// With the nodes as they are, or one for each region.
store::ResultMesh result_mesh(const SolidMesh& mesh);
store::ResultMesh result_mesh(const SolidMesh& mesh, const RegionNodes& nodes);

/// Stores displacement, velocity and the fields that the scene names at the first accepted state at or after each
/// multiple of results_interval from results_start on. Does nothing when the scene names no interval or there is no run
/// folder.
class ResultOutput {
 public:
  /// Writes results/NAME.h5 and .xmf in the run folder, NAME of the first body; after a resume (time > 0) continues
  /// what is there. `model` must outlive this. Throws SceneError for fields that its bodies cannot have.
  ResultOutput(const v1::Scene& scene, const std::string& run_folder, const SolidModel& model);

  /// Stores an accepted state when it is due.
  void accept(const Motion& motion);

 private:
  surface::NodeArray at_result_nodes(const NodeVectors& values) const;

  std::optional<TissueFields> tissue_;  // without it nothing is stored
  std::optional<store::ResultWriter> writer_;
  double start_ = 0, interval_ = 0;  // [s]
  std::int64_t next_ = 0;            // due at start + next * interval
};

}  // namespace couplet::solid
