#include "coupler/scheme/run_record.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <utility>

namespace couplet::coupling {

namespace {

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

store::ProgramCost cost_of_this_process() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  constexpr double bytes_per_unit = 1024;  // Linux counts in kilobytes
  return {"coupler",
          seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime),
          static_cast<double>(usage.ru_maxrss) * bytes_per_unit,
          {}};
}

}  // namespace

double largest_residual(const std::vector<Criterion>& criteria, const std::vector<FieldChange>& changes) {
  double largest = 0;
  for (std::size_t k = 0; k < changes.size(); ++k) {
    const bool is_absolute = criteria[k].absolute && !criteria[k].relative;
    largest = std::max(largest, is_absolute ? changes[k].absolute : changes[k].relative);
  }
  return largest;
}

RunRecord::RunRecord(std::string scene_path) : started_(std::chrono::steady_clock::now()) {
  summary_.scene = std::move(scene_path);
  summary_.coupled = true;
}

void RunRecord::add(const AcceptedStep& step, double residual, const ConservationError& error) {
  summary_.steps = step.step;
  summary_.end_time = step.time;
  n_iterations_ += step.iterations;
  summary_.iterations_mean = n_iterations_ / static_cast<double>(step.step);
  summary_.iterations_max = std::max(summary_.iterations_max, step.iterations);
  summary_.residual_at_acceptance_max = std::max(summary_.residual_at_acceptance_max, residual);
  summary_.force_error_max = std::max(summary_.force_error_max, error.force);
  summary_.moment_error_max = std::max(summary_.moment_error_max, error.moment);
  summary_.work_error_max = std::max(summary_.work_error_max, error.work);
}

void RunRecord::note_checkpoints(int n_written, double seconds) {
  summary_.n_checkpoints = n_written;
  summary_.checkpoint_seconds = seconds;
}

void RunRecord::add_program(const std::string& name, const std::vector<participant::NamedNumber>& quantities) {
  store::ProgramCost cost{name, 0, 0, {}};
  for (const participant::NamedNumber& quantity : quantities) {
    if (quantity.name == "seconds") {
      cost.seconds = quantity.value;
    } else if (quantity.name == "peak_memory_bytes") {
      cost.peak_memory_bytes = quantity.value;
    } else {
      cost.more.push_back({quantity.name, quantity.value, quantity.unit, -1, -1, quantity.text});
    }
  }
  summary_.programs.push_back(std::move(cost));
}

store::Summary RunRecord::summary(const std::string& status, const std::string& failure) const {
  store::Summary summary = summary_;
  summary.status = status;
  summary.failure = failure;
  summary.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
  summary.programs.push_back(cost_of_this_process());
  for (const store::ProgramCost& cost : summary.programs) {
    const auto core_seconds = std::find_if(cost.more.begin(), cost.more.end(),
                                           [](const auto& quantity) { return quantity.name == "core_seconds"; });
    summary.core_seconds += core_seconds != cost.more.end() ? core_seconds->value : cost.seconds;
  }
  return summary;
}

void RunRecord::save(SavedState& state) const {
  state["record"] = to_array({static_cast<double>(summary_.steps), summary_.end_time, n_iterations_,
                              static_cast<double>(summary_.iterations_max), summary_.residual_at_acceptance_max,
                              summary_.force_error_max, summary_.moment_error_max, summary_.work_error_max});
}

void RunRecord::restore(const SavedState& state) {
  const std::vector<double> saved = to_numbers(state.at("record"));
  summary_.steps = static_cast<std::int64_t>(saved.at(0));
  summary_.end_time = saved.at(1);
  n_iterations_ = saved.at(2);
  summary_.iterations_mean = n_iterations_ / std::max(saved.at(0), 1.0);
  summary_.iterations_max = static_cast<int>(saved.at(3));
  summary_.residual_at_acceptance_max = saved.at(4);
  summary_.force_error_max = saved.at(5);
  summary_.moment_error_max = saved.at(6);
  summary_.work_error_max = saved.at(7);
}

}  // namespace couplet::coupling
