#pragma once
// The fields of a body over time, for ParaView.

#include <optional>

#include "couplet/v1/output.pb.h"
#include "proto/store/result_file.hpp"
#include "solid-server/solid_model.hpp"

namespace couplet::solid {

store::ResultMesh result_mesh(const SolidMesh& mesh);

/// Stores displacement and velocity at the first accepted state at or after each multiple of results_interval from
/// results_start on. Does nothing when the scene names no interval or there is no run folder.
class ResultOutput {
 public:
  /// Writes results/`name`.h5 and .xmf in the run folder; after a resume (time > 0) continues what is there.
  ResultOutput(const v1::Output& output, const std::string& run_folder, const std::string& name, const SolidMesh& mesh,
               double time);

  /// Stores an accepted state when it is due.
  void accept(const Motion& motion);

 private:
  std::optional<store::ResultWriter> writer_;
  double start_ = 0, interval_ = 0;  // [s]
  std::int64_t next_ = 0;            // due at start + next * interval
};

}  // namespace couplet::solid
