#pragma once
// Whether a run that lost a program goes on by itself, and from where.

#include <cstdint>
#include <optional>

#include "deploy/launcher/run_ending.hpp"
#include "deploy/launcher/run_options.hpp"
#include "proto/store/run_folder.hpp"

namespace couplet::launcher {

/// All programs of a run that lost one are started again from its newest checkpoint, or from its beginning when there
/// is none yet; the numbers are those of a run that lost nothing. What is lost each time before the next checkpoint is
/// given up: the fault is then most likely in the run itself.
class Restarts {
 public:
  /// `options.restarts` times in a row without a further checkpoint.
  Restarts(const RunOptions& options, const store::RunFolder& folder);

  /// What the next attempt is to be; nothing when the run is over.
  std::optional<RunOptions> after(const Verdict& verdict, bool stop_requested);
  /// That of the whole run, once there is no further attempt.
  Verdict settle(const Verdict& last) const;

  int n_restarts() const { return n_restarts_; }
  /// Where the attempt starts that after() has returned, in words.
  std::string from_where() const;

 private:
  std::optional<std::int64_t> newest_step() const;

  RunOptions first_;
  store::RunFolder folder_;
  std::optional<std::int64_t> last_step_;  // from which the attempt before was started
  int n_restarts_ = 0, n_in_vain_ = 0;
};

}  // namespace couplet::launcher
