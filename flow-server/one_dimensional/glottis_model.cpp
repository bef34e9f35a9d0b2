#include "flow-server/one_dimensional/glottis_model.hpp"

#include <cmath>
#include <sstream>
#include <utility>

#include "flow-server/one_dimensional/glottis_checkpoint.hpp"
#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {
// Suction in a throat grows with the square of exit over throat area; in vibrations that keep going it stays below
// twice the driving pressure.
constexpr double largest_believed_pressure_ratio = 20;
// The fold cannot stretch or open like this without being destroyed.
constexpr double largest_believed_length_ratio = 3;
constexpr double largest_believed_area_ratio = 3;
}  // namespace

GlottisModel::GlottisModel(const GlottisOptions& options, FoldOptions fold)
    : options_(options), axis_(options.n_stations), flow_(axis_, options.law), interface_(std::move(fold.surface)) {
  channel_.emplace<FoldChannel>(interface_, axis_, fold.gap, fold.lines);
  start();
}

GlottisModel::GlottisModel(const GlottisOptions& options, PrescribedChannel::Shape channel)
    : options_(options), axis_(options.n_stations), flow_(axis_, options.law) {
  interface_.node_position.resize(0, 3);
  interface_.face_offset.setZero(1);
  channel_.emplace<PrescribedChannel>(std::move(channel), axis_);
  start();
}

std::vector<std::string> GlottisModel::needs() const {
  if (interface_.n_nodes() == 0) return {};
  return {"displacement"};
}

void GlottisModel::start() {
  force_.setZero(interface_.n_nodes(), 3);
  const EndPressures pressures = pressures_at(0);
  trial_profile_ = channel_at(0, surface::NodeArray::Zero(interface_.n_nodes(), 3));
  first_length_ = trial_profile_.exit - trial_profile_.inlet;
  first_largest_area_ = trial_profile_.area.maxCoeff();
  flow_.start(trial_profile_, pressures);
  first_position_ = flow().position;
  accepted_profile_ = trial_profile_;
  find_force(flow(), pressures);
  accepted_force_ = force_;
}

void GlottisModel::solve_step(double duration, const surface::FieldSet& motion) {
  static const surface::NodeArray nothing = surface::NodeArray::Zero(0, 3);
  const bool has_fold = interface_.n_nodes() > 0;
  const surface::NodeArray& displacement = has_fold ? surface::find_field(motion, "displacement").values : nothing;
  trial_time_ = time_ + duration;
  if (!displacement.allFinite()) {
    report_divergence("the displacement of the fold is not a number");
  }
  const EndPressures pressures = pressures_at(trial_time_);
  trial_profile_ = channel_at(trial_time_, displacement);
  find_force(flow_.solve(trial_profile_, pressures, duration), pressures);
}

std::vector<FlowQuantity> GlottisModel::accept_step() {
  flow_.accept();
  time_ = trial_time_;
  accepted_force_ = force_;
  accepted_profile_ = trial_profile_;
  if (interface_.n_nodes() > 0) refuse_unbelievable();
  const GlottalSolution& now = flow();
  n_clipped_ += now.clipped ? 1 : 0;
  return {{"flow.rate", now.exit_rate, "m^3/s"},
          {"flow.inlet_rate", now.inlet_rate, "m^3/s"},
          {"flow.smallest_area", accepted_profile_.area.minCoeff(), "m^2"},
          {"flow.exit_area", accepted_profile_.area[axis_.n_stations() - 1], "m^2"},
          {"flow.throat_x", now.position[now.throat], "m"},
          {"flow.smallest_pressure", now.pressure.minCoeff(), "Pa"},
          {"flow.subglottal_pressure", now.pressure[0], "Pa"},
          {"flow.clipped_steps", n_clipped_, "1"}};
}

EndPressures GlottisModel::pressures_at(double t) const {
  return {options_.subglottal_pressure(t), options_.exit_pressure};
}

const SectionProfile& GlottisModel::channel_at(double t, const surface::NodeArray& displacement) {
  if (auto* fold = std::get_if<FoldChannel>(&channel_)) return fold->at(displacement);
  return std::get<PrescribedChannel>(channel_).at(t);
}

void GlottisModel::find_force(const GlottalSolution& solution, const EndPressures& pressures) {
  if (auto* fold = std::get_if<FoldChannel>(&channel_)) fold->find_force(solution, pressures, force_);
}

void GlottisModel::refuse_unbelievable() const {
  const GlottalSolution& now = flow();
  const double limit = largest_believed_pressure_ratio * options_.largest_driving_pressure;
  Eigen::Index k = 0;
  std::ostringstream found;
  if (!now.pressure.allFinite() || !std::isfinite(now.inlet_rate)) {
    report_divergence("pressure or flow rate are not a number");
  }
  const double length = now.exit - accepted_profile_.inlet;
  if (length > largest_believed_length_ratio * first_length_ ||
      length < first_length_ / largest_believed_length_ratio) {
    found << "the exit line is " << length << " m from the inlet, at rest it was " << first_length_ << " m";
    report_divergence(found.str());
  }
  if (const double area = accepted_profile_.area.maxCoeff(&k);
      area > largest_believed_area_ratio * first_largest_area_) {
    found << "the area reaches " << area << " m^2 at x = " << now.position[k] << " m, the largest at rest was "
          << first_largest_area_ << " m^2";
    report_divergence(found.str());
  }
  if (const double p = now.pressure.abs().maxCoeff(&k); limit > 0 && p > limit) {
    found << "the pressure reaches " << now.pressure[k] << " Pa at x = " << now.position[k] << " m, more than "
          << largest_believed_pressure_ratio << " times the driving pressure";
    report_divergence(found.str());
  }
}

void GlottisModel::report_divergence(const std::string& what) const {
  std::ostringstream found;
  found << "at t = " << trial_time_ << " s " << what << ": the coupled motion has diverged";
  if (options_.law.model == GlottalModel::b2) {
    throw report::NumericsError("glottal flow",
                                found.str() + "; model B2 has no equilibrium once the exit is wider than the throat",
                                "use M2, which limits the pressure recovery, or B1, which separates at the throat");
  }
  throw report::NumericsError("glottal flow", found.str(),
                              "take a smaller time step or implicit coupling, or look at the supports of the solid");
}

void GlottisModel::write_checkpoint(const std::filesystem::path& path) const {
  write_glottis_checkpoint(path, {time_, flow_.history(), accepted_force_, n_clipped_});
}

void GlottisModel::resume(const std::filesystem::path& path) {
  GlottisCheckpoint state = read_glottis_checkpoint(path, axis_.n_stations(), interface_.n_nodes());
  time_ = trial_time_ = state.time;
  force_ = accepted_force_ = std::move(state.force);
  n_clipped_ = state.n_clipped;
  flow_.restore(std::move(state.history));
}

void GlottisModel::start_results(const std::filesystem::path& results_folder) {
  results_.emplace(results_folder, first_position_, time_);
}

void GlottisModel::append_results() {
  const GlottalSolution& now = flow();
  results_->append(time_, now.position,
                   {{"pressure", "Pa", now.pressure},
                    {"velocity", "m/s", now.velocity},
                    {"area", "m^2", accepted_profile_.area},
                    {"effective_area", "m^2", now.effective_area}});
}

}  // namespace couplet::flow
