#include "deploy/launcher/restarts.hpp"

#include <algorithm>

#include "proto/report/failure.hpp"
#include "proto/store/checkpoint_folder.hpp"

namespace couplet::launcher {
namespace {

constexpr int given_up = 4;  // exit code

std::optional<std::int64_t> step_to_resume(const std::filesystem::path& from) {
  try {
    return store::find_checkpoint(from, [](const std::string&) {}).step;
  } catch (const report::FileError&) {
    return std::nullopt;
  }
}

}  // namespace

Restarts::Restarts(const RunOptions& options, const store::RunFolder& folder)
    : first_(options), folder_(folder), last_step_(options.resume.empty() ? 0 : step_to_resume(options.resume)) {}

std::optional<std::int64_t> Restarts::newest_step() const {
  return step_to_resume(folder_.checkpoints());
}

std::optional<RunOptions> Restarts::after(const Verdict& verdict, bool stop_requested) {
  if (!verdict.is_loss || stop_requested) return std::nullopt;
  const std::int64_t begin = last_step_.value_or(0);
  const std::optional<std::int64_t> newest = newest_step();
  n_in_vain_ = newest && *newest > begin ? 0 : n_in_vain_ + 1;
  if (n_in_vain_ > first_.restarts || first_.restarts == 0) return std::nullopt;
  ++n_restarts_;
  RunOptions next = first_;
  if (newest) {
    next.resume = folder_.path;
    const std::int64_t first_step = first_.resume.empty() ? 0 : step_to_resume(first_.resume).value_or(0);
    if (first_.steps > 0) next.steps = std::max<std::int64_t>(1, first_.steps - (*newest - first_step));
    last_step_ = newest;
  }
  return next;
}

std::string Restarts::from_where() const {
  const auto newest = newest_step();
  return newest ? "from the checkpoint of step " + std::to_string(*newest) : "from its beginning: no checkpoint yet";
}

Verdict Restarts::settle(const Verdict& last) const {
  if (!last.is_loss || n_in_vain_ <= first_.restarts || first_.restarts == 0) return last;
  return {given_up,
          "the run was lost " + std::to_string(n_in_vain_) +
              " times in a row before it came to its next checkpoint, the last time because " + last.sentence +
              "; log.txt says what was before each of them",
          true};
}

}  // namespace couplet::launcher
