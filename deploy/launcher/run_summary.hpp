#pragma once
// summary.json as the launcher sees it: the word on how the run ended, and the results to print.

#include <map>
#include <string>

#include "deploy/launcher/run_ending.hpp"
#include "proto/store/run_folder.hpp"

namespace couplet::launcher {

/// The program that owned time writes the summary. Where it could not, or does not know how the run really ended, the
/// launcher says so: status failed (with the sentence) or stopped. How often the run was started again is added, and
/// commands of the user's own programs, by what they replaced.
void settle_summary(const store::RunFolder& folder, const std::string& scene, const Verdict& verdict,
                    bool stop_requested, int n_restarts, const std::map<std::string, std::string>& own_programs);

/// Status, steps and quantities, a line each.
std::string summary_table(const store::RunFolder& folder);

}  // namespace couplet::launcher
