#pragma once
// summary.json: what a run was and what came out.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace couplet::store {

struct SummaryQuantity {
  std::string name;
  double value = 0;
  std::string unit = {};
  double spread = -1;     // standard deviation over the cycles; negative: none
  double n_cycles = -1;   // cycles used; negative: none
  std::string text = {};  // of a program, in place of the number; empty: none
};

struct ProgramCost {
  std::string program;
  double seconds = 0;
  double peak_memory_bytes = 0;
  std::vector<SummaryQuantity> more;  // for example substeps, cells
};

struct Summary {
  std::string status;   // finished, stopped, failed
  std::string failure;  // one line, empty unless failed
  std::string scene;
  std::int64_t steps = 0;
  double end_time = 0;
  double wall_seconds = 0;
  double core_seconds = 0;
  double iterations_mean = 0;
  int iterations_max = 0;
  double residual_at_acceptance_max = 0;
  double force_error_max = 0;  // relative
  double moment_error_max = 0;
  double work_error_max = 0;
  bool coupled = false;
  int n_checkpoints = 0;  // written by this part of the run
  double checkpoint_seconds = 0;
  std::vector<ProgramCost> programs;
  std::vector<SummaryQuantity> quantities;
};

/// Writes it complete or not at all; version and commit are added here.
void write_summary(const std::filesystem::path& path, const Summary& summary);

}  // namespace couplet::store
