#include "coupler/scheme/coupled_run.hpp"

#include <memory>
#include <optional>
#include <utility>

#include "coupler/checkpoint/coupled_checkpoint.hpp"
#include "coupler/probe/history_table.hpp"
#include "coupler/scheme/interface_pair.hpp"
#include "coupler/scheme/make_scheme.hpp"
#include "coupler/scheme/run_log.hpp"
#include "coupler/scheme/run_record.hpp"
#include "coupler/scheme/time_loop.hpp"
#include "proto/report/failure.hpp"
#include "proto/report/progress.hpp"
#include "proto/scene/read_scene.hpp"
#include "proto/store/checkpoint_schedule.hpp"
#include "proto/store/derived_quantity.hpp"
#include "proto/store/run_folder.hpp"

namespace couplet::coupling {

namespace {

using participant::Participant;

/// One run from the opened participants on. Members stand in the order in which they need each other.
class Run {
 public:
  Run(Participant& flow, Participant& solid, const v1::Scene& scene, const CoupledRunOptions& options,
      const store::RunFolder& folder, RunRecord& record, RunLog& log)
      : flow_(flow), solid_(solid), scene_(scene), options_(options), folder_(folder), record_(record), log_(log) {
    open();
    resume();
  }

  bool is_finished() const {
    return loop_->is_at_end() || (options_.steps > 0 && loop_->step() - first_step_ >= options_.steps);
  }
  bool should_stop() const { return options_.should_stop && options_.should_stop(); }

  void advance() {
    const AcceptedStep step = loop_->advance();
    const double residual = largest_residual(convergence_->criteria(), step.changes);
    record_.add(step, residual, pair_->largest_conservation_error());
    history_->append(step, displacement_of(step.state));
    progress_->step(step.step, step.time, step.iterations, residual);
    if (schedule_->is_due(step.step)) write_checkpoint();
  }

  void write_checkpoint() {
    const auto begun = store::CheckpointSchedule::Clock::now();
    SavedState state;
    loop_->save(state);
    record_.save(state);
    write_coupled_checkpoint(folder_.checkpoints(), loop_->step(), flow_, solid_, state);
    schedule_->note_written(loop_->step(), begun);
    record_.note_checkpoints(schedule_->n_written(), schedule_->seconds());
  }

  /// Where a run is cut off by the user, it can be continued if the scene wants checkpoints at all.
  void write_last_checkpoint() {
    if (schedule_->is_missing(loop_->step())) write_checkpoint();
  }

  void finish_progress() { progress_->finish(); }

 private:
  void open() {
    if (!options_.resume_from.empty())
      checkpoint_ =
          store::find_checkpoint(options_.resume_from, [this](const std::string& sentence) { log_.warn(sentence); });
    const participant::Opened solid = solid_.open(open_request("solid", std::nullopt));
    const participant::Opened flow = flow_.open(open_request("flow", solid.surface));
    const v1::Coupling& coupling = scene_.coupling();
    pair_ = std::make_unique<InterfacePair>(flow_, solid_, flow, solid, make_mapping_kind(coupling.mapping()));
    log_.note("mapping: " + name_of(pair_->mapping().kind()) + ", " + std::to_string(flow.surface.n_nodes()) +
              " flow nodes, " + std::to_string(solid.surface.n_nodes()) + " solid nodes");
    convergence_.emplace(make_convergence_history(coupling, pair_->layout()));
    loop_ = std::make_unique<TimeLoop>(flow_, solid_, make_scheme(coupling, *pair_, *convergence_, solid.time),
                                       StepSize(scene_.time().end(), scene_.time().step(), coupling.halvings_max()),
                                       coupling.iterations_max(),
                                       [this](const std::string& sentence) { log_.warn(sentence); });
    history_ = std::make_unique<HistoryTable>(folder_.history(),
                                              change_columns(convergence_->criteria(), convergence_->units()),
                                              store::make_probes(scene_.output(), solid.surface));
  }

  participant::OpenRequest open_request(const std::string& name, std::optional<surface::SurfaceMesh> peer) const {
    return {scene_, options_.scene_folder, std::filesystem::absolute(folder_.path).string(),
            checkpoint_ ? std::filesystem::absolute(checkpoint_->participant_file(name)).string() : "",
            std::move(peer)};
  }

  void resume() {
    const bool is_iterated = scene_.coupling().scheme() != v1::Coupling::EXPLICIT;
    if (checkpoint_) {
      const SavedState state = read_coupler_state(*checkpoint_);
      loop_->restore(state);
      store::refuse_end_before_checkpoint(*checkpoint_, loop_->time(), scene_.time().end());
      record_.restore(state);
      const store::RunFolder earlier{checkpoint_->path.parent_path().parent_path()};
      history_->continue_from(earlier.history(), loop_->time());
      if (is_iterated) convergence_->continue_from(earlier.iterations(), loop_->step(), folder_.iterations());
      log_.note("resumed from " + checkpoint_->path.string() + " at step " + std::to_string(loop_->step()));
    } else if (is_iterated) {
      convergence_->write_to(folder_.iterations());
    }
    first_step_ = loop_->step();
    schedule_.emplace(scene_.output(), first_step_);
    progress_ = std::make_unique<report::Progress>(loop_->time(), scene_.time().end(), options_.quiet);
  }

  surface::NodeArray displacement_of(const InterfaceState& state) const {
    for (const Segment& segment : pair_->layout().motion) {
      if (segment.name != "displacement") continue;
      return Eigen::Map<const surface::NodeArray>(state.motion.data() + segment.offset,
                                                  segment.size / segment.n_components, segment.n_components);
    }
    return {};
  }

  Participant& flow_;
  Participant& solid_;
  const v1::Scene& scene_;
  const CoupledRunOptions& options_;
  const store::RunFolder& folder_;
  RunRecord& record_;
  RunLog& log_;
  std::optional<store::CheckpointFolder> checkpoint_;  // to resume from
  std::unique_ptr<InterfacePair> pair_;
  std::optional<ConvergenceHistory> convergence_;
  std::unique_ptr<TimeLoop> loop_;
  std::unique_ptr<HistoryTable> history_;
  std::unique_ptr<report::Progress> progress_;
  std::optional<store::CheckpointSchedule> schedule_;
  std::int64_t first_step_ = 0;
};

void close(Participant& participant, const std::string& name, const std::string& reason, RunRecord& record) {
  record.add_program(name, participant.close(reason));
}

// After a failure the other participant must still hear of it; one that is lost cannot.
void close_after_failure(Participant& participant, const std::string& name, const std::string& reason,
                         RunRecord& record) {
  try {
    close(participant, name, reason, record);
  } catch (const std::exception&) {
    record.add_program(name, {});
  }
}

void derive_quantities(const v1::Scene& scene, const store::RunFolder& folder, RunLog& log, store::Summary& summary) {
  if (scene.output().quantity().empty() || !std::filesystem::exists(folder.history())) return;
  const store::Table history = store::read_table(folder.history());
  for (const v1::Quantity& quantity : scene.output().quantity()) {
    try {
      summary.quantities.push_back(store::derive_quantity(quantity, history));
    } catch (const report::Failure& failure) {
      log.warn("no quantity '" + quantity.name() + "': " + failure.what());
    }
  }
}

}  // namespace

store::Summary run_coupled(Participant& flow, Participant& solid, const v1::Scene& scene,
                           const CoupledRunOptions& options) {
  const store::RunFolder folder = store::make_run_folder(options.run_folder);
  store::write_file(folder.resolved_scene(), scene::resolved_scene_text(scene));
  RunLog log(folder.log());
  RunRecord record(options.scene_path);
  try {
    Run run(flow, solid, scene, options, folder, record, log);
    while (!run.is_finished() && !run.should_stop()) run.advance();
    const std::string status = run.is_finished() ? "finished" : "stopped";
    if (status == "stopped") run.write_last_checkpoint();
    run.finish_progress();
    close(flow, "flow", status, record);
    close(solid, "solid", status, record);
    store::Summary summary = record.summary(status, "");
    derive_quantities(scene, folder, log, summary);
    store::write_summary(folder.summary(), summary);
    return summary;
  } catch (const std::exception& failure) {
    log.error(failure.what());
    close_after_failure(flow, "flow", failure.what(), record);
    close_after_failure(solid, "solid", failure.what(), record);
    store::write_summary(folder.summary(), record.summary("failed", failure.what()));
    throw;
  }
}

}  // namespace couplet::coupling
