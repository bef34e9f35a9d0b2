#include "proto/participant/run_alone.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>

#include "proto/participant/stop_signal.hpp"
#include "proto/report/failure.hpp"
#include "proto/report/progress.hpp"
#include "proto/scene/read_scene.hpp"
#include "proto/store/checkpoint_folder.hpp"
#include "proto/store/checkpoint_schedule.hpp"
#include "proto/store/derived_quantity.hpp"
#include "proto/store/hdf5_file.hpp"
#include "proto/store/interface_probe.hpp"
#include "proto/store/run_folder.hpp"
#include "proto/store/summary.hpp"
#include "proto/store/table_file.hpp"

namespace couplet::participant {

namespace {

// A remainder of the span below this share of a step comes from an end or a step that was rounded and is no step of its
// own.
constexpr double sliver = 1e-3;
const std::string participant_file = "alone";
const std::string record_file = "clock";

double core_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Fields of zeros for what the participant wants to be given.
surface::FieldSet no_load(const Opened& opened) {
  const auto unit = [](const std::string& name) {
    return name == "force" ? "N" : name == "displacement" ? "m" : name == "velocity" ? "m/s" : "";
  };
  surface::FieldSet fields;
  for (const std::string& name : opened.needs)
    fields.push_back({name, unit(name), surface::NodeArray::Zero(opened.surface.n_nodes(), 3)});
  return fields;
}

/// history.csv: time, step, effort, probes and the participant's own numbers.
class History {
 public:
  History(std::filesystem::path path, std::vector<store::InterfaceProbe> probes)
      : path_(std::move(path)), probes_(std::move(probes)) {}

  /// Rows of an earlier run up to a time stand first.
  void keep(const std::filesystem::path& earlier, double time) {
    if (std::filesystem::exists(earlier)) kept_ = store::rows_up_to(store::read_table(earlier), "time", time);
  }

  void append(double time, double duration, const StepSolved& solved, const std::vector<NamedNumber>& numbers) {
    std::vector<double> row{time, duration, static_cast<double>(solved.inner_iterations)};
    if (!probes_.empty()) store::append_probe_values(probes_, find_field(solved.fields, "displacement").values, row);
    for (const NamedNumber& number : numbers) row.push_back(number.value);
    if (!table_) open(numbers);
    table_->append(row);
  }

 private:
  void open(const std::vector<NamedNumber>& numbers) {
    std::vector<store::Column> columns{{"time", "s"}, {"dt", "s"}, {"inner_iterations", "1"}};
    for (const auto& column : store::probe_columns(probes_)) columns.push_back(column);
    for (const NamedNumber& number : numbers) columns.push_back({number.name, number.unit});
    const auto is_same = [](const store::Column& a, const store::Column& b) { return a.name == b.name; };
    if (!kept_.columns.empty() &&
        !std::equal(columns.begin(), columns.end(), kept_.columns.begin(), kept_.columns.end(), is_same))
      throw report::FileError(path_.string(), "the run that is resumed wrote other columns",
                              "resume with the probes of that run, or start a new one");
    table_ = std::make_unique<store::TableWriter>(path_, columns, kept_);
  }

  std::filesystem::path path_;
  std::vector<store::InterfaceProbe> probes_;
  store::Table kept_;
  std::unique_ptr<store::TableWriter> table_;  // made with the first row: the columns are known then
};

/// Where a run stands in time.
struct Clock {
  std::int64_t step = 0;
  double time = 0;  // [s]
};

class AloneRun {
 public:
  AloneRun(Participant& participant, const v1::Scene& scene, const AloneOptions& options)
      : participant_(participant),
        scene_(scene),
        options_(options),
        folder_(store::make_run_folder(options.run_folder)) {}

  void run();

 private:
  void open();
  void solve_all();
  bool is_at_end() const { return clock_.time >= scene_.time().end(); }
  double next_duration() const;
  void take_step(double duration);
  void write_checkpoint();
  void close(const std::string& reason);
  void end_after(const std::string& failure);
  void write_summary(const std::string& status, const std::string& failure);
  std::vector<store::SummaryQuantity> derived_quantities() const;

  Participant& participant_;
  const v1::Scene& scene_;
  const AloneOptions& options_;
  store::RunFolder folder_;
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
  Clock clock_;
  std::int64_t first_step_ = 0;
  std::optional<store::CheckpointSchedule> schedule_;  // from open() on
  surface::FieldSet load_;
  std::unique_ptr<History> history_;
  std::vector<NamedNumber> costs_;
};

void AloneRun::run() {
  catch_stop_signals();
  store::write_file(folder_.resolved_scene(), scene::resolved_scene_text(scene_));
  try {
    open();
    solve_all();
    if (!is_at_end() && schedule_->is_missing(clock_.step)) write_checkpoint();
    close(is_at_end() ? "finished" : "stopped");
  } catch (const std::exception& failure) {
    end_after(failure.what());
    throw;
  }
  write_summary(is_at_end() ? "finished" : "stopped", "");
}

/// The failure that ended the run is the one to tell, whatever goes wrong now.
void AloneRun::end_after(const std::string& failure) {
  try {
    close("failed");
  } catch (const std::exception&) {
    // The summary says what there is to say.
  }
  try {
    write_summary("failed", failure);
  } catch (const std::exception&) {
    // The folder cannot be written to any more.
  }
}

void AloneRun::open() {
  OpenRequest request;
  request.scene = scene_;
  request.scene_folder = std::filesystem::absolute(options_.scene_path).parent_path().string();
  request.run_folder = std::filesystem::absolute(folder_.path).string();
  std::filesystem::path earlier_history;
  if (!options_.resume_from.empty()) {
    const auto checkpoint = store::find_checkpoint(
        options_.resume_from, [](const std::string& sentence) { std::fprintf(stderr, "%s\n", sentence.c_str()); });
    const auto record = store::Hdf5File::open_for_reading(checkpoint.participant_file(record_file));
    clock_ = {record.read_integer("step"), record.read_number("time")};
    store::refuse_end_before_checkpoint(checkpoint, clock_.time, scene_.time().end());
    request.resume_from = std::filesystem::absolute(checkpoint.participant_file(participant_file)).string();
    earlier_history = store::RunFolder{checkpoint.path.parent_path().parent_path()}.history();
  }
  const Opened opened = participant_.open(request);
  first_step_ = clock_.step;
  schedule_.emplace(scene_.output(), first_step_);
  load_ = no_load(opened);
  const bool shows_motion = std::count(opened.offers.begin(), opened.offers.end(), "displacement") > 0;
  history_ =
      std::make_unique<History>(folder_.history(), shows_motion ? store::make_probes(scene_.output(), opened.surface)
                                                                : std::vector<store::InterfaceProbe>{});
  if (!earlier_history.empty()) history_->keep(earlier_history, clock_.time);
}

/// The scene's step; the last one ends exactly at the end.
double AloneRun::next_duration() const {
  const double left = scene_.time().end() - clock_.time, step = scene_.time().step();
  return left < step * (1 + sliver) ? left : step;
}

void AloneRun::solve_all() {
  report::Progress progress(clock_.time, scene_.time().end(), options_.quiet);
  participant_.watch_steps([&](double time) {
    progress.reach(time);
    return !stop_was_asked();
  });
  while (!is_at_end() && !stop_was_asked()) {
    if (options_.steps > 0 && clock_.step - first_step_ >= options_.steps) break;
    try {
      take_step(next_duration());
    } catch (const report::Interrupted&) {
      break;  // the accepted state is that of the step before
    }
    progress.step(clock_.step, clock_.time, 0, 0);
    if (schedule_->is_due(clock_.step)) write_checkpoint();
  }
  participant_.watch_steps({});
  progress.finish();
}

void AloneRun::take_step(double duration) {
  const StepSolved solved = participant_.solve_step({clock_.step + 1, 1, clock_.time, duration}, load_);
  const auto numbers = participant_.accept_step(clock_.step + 1);
  const bool is_last = duration == scene_.time().end() - clock_.time;
  clock_ = {clock_.step + 1, is_last ? scene_.time().end() : clock_.time + duration};
  history_->append(clock_.time, duration, solved, numbers);
}

void AloneRun::write_checkpoint() {
  const auto begun = store::CheckpointSchedule::Clock::now();
  const auto checkpoint = store::make_checkpoint_folder(folder_.checkpoints(), clock_.step);
  participant_.write_checkpoint(std::filesystem::absolute(checkpoint.participant_file(participant_file)).string());
  auto record = store::Hdf5File::create(checkpoint.participant_file(record_file));
  record.write_integer("step", clock_.step);
  record.write_number("time", clock_.time);
  record.close();
  store::complete_checkpoint(checkpoint);
  schedule_->note_written(clock_.step, begun);
}

void AloneRun::close(const std::string& reason) {
  history_.reset();
  costs_ = participant_.close(reason);
}

/// A quantity that the history does not hold (too few cycles, say) is left out: the run itself went well.
std::vector<store::SummaryQuantity> AloneRun::derived_quantities() const {
  std::vector<store::SummaryQuantity> quantities;
  if (scene_.output().quantity().empty() || !std::filesystem::exists(folder_.history())) return quantities;
  const store::Table history = store::read_table(folder_.history());
  for (const v1::Quantity& quantity : scene_.output().quantity()) {
    try {
      quantities.push_back(store::derive_quantity(quantity, history));
    } catch (const report::Failure& reason) {
      if (!options_.quiet)
        std::fprintf(stderr, "quantity %s is left out: %s\n", quantity.name().c_str(), reason.what());
    }
  }
  return quantities;
}

void AloneRun::write_summary(const std::string& status, const std::string& failure) {
  store::Summary summary;
  summary.core_seconds = core_seconds();
  store::ProgramCost cost;
  cost.program = options_.program;
  for (const NamedNumber& number : costs_) {
    if (number.name == "seconds")
      cost.seconds = number.value;
    else if (number.name == "peak_memory_bytes")
      cost.peak_memory_bytes = number.value;
    else
      cost.more.push_back({.name = number.name, .value = number.value, .unit = number.unit, .text = number.text});
  }
  for (const NamedNumber& number : costs_)
    if (number.name == "core_seconds") summary.core_seconds = number.value;  // of all its processes, this one too
  summary.status = status;
  summary.failure = failure;
  summary.scene = options_.scene_path;
  summary.steps = clock_.step;
  summary.end_time = clock_.time;
  summary.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
  summary.programs = {cost};
  if (schedule_) {
    summary.n_checkpoints = schedule_->n_written();
    summary.checkpoint_seconds = schedule_->seconds();
  }
  summary.quantities = derived_quantities();
  store::write_summary(folder_.summary(), summary);
}

}  // namespace

void run_alone(Participant& participant, const v1::Scene& scene, const AloneOptions& options) {
  AloneRun(participant, scene, options).run();
}

}  // namespace couplet::participant
