#include "solid-server/service/solid_participant.hpp"

#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <iostream>

#include "proto/report/failure.hpp"
#include "solid-server/choose_time_method.hpp"
#include "solid-server/service/make_setup.hpp"
#include "solid-server/service/time_integration_warning.hpp"

namespace couplet::solid {

namespace {

/// Adds the time of its life to a sum.
class Stopwatch {
 public:
  explicit Stopwatch(double& sum) : sum_(sum) {}
  ~Stopwatch() { sum_ += seconds(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  double seconds() const { return std::chrono::duration<double>(Clock::now() - started_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  double& sum_;
  Clock::time_point started_ = Clock::now();
};

double peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

/// More than the round-off of one step apart means that one of the two programs lost a step.
void check_start(const participant::StepInterval& interval, double accepted_time) {
  if (std::abs(interval.start - accepted_time) <= 1e-6 * interval.duration + 1e-15 * std::abs(interval.start)) return;
  throw report::PeerError("solid-server",
                          "asked for a step from t = " + std::to_string(interval.start) +
                              " s, but the accepted state is at t = " + std::to_string(accepted_time) + " s",
                          "start the run again from its last checkpoint");
}

/// AUTO goes on with what it has chosen; any other method must be the one of the checkpoint.
void refuse_another_method(TimeMethod stored, v1::TimeIntegration::Method wanted, TimeMethod made) {
  if (wanted == v1::TimeIntegration::AUTO || stored == made) return;
  throw report::SceneError("solid.time_integration.method",
                           "the scene asks for " + v1::TimeIntegration::Method_Name(wanted) +
                               ", but the checkpoint was written by " + name_of(stored),
                           "go on with that method, or start a new run");
}

}  // namespace

participant::Opened SolidParticipant::open(const participant::OpenRequest& request) {
  const Stopwatch watch(seconds_);
  SolidSetup setup = make_setup(request.scene.solid(), request.scene_folder);
  setup.n_threads = worthwhile_threads(options_.threads, setup);
  const bool is_new = request.resume_from.empty();
  TimeMethodChoice choice;
  if (is_new && request.scene.solid().time_integration().method() == v1::TimeIntegration::AUTO) {
    choice = choose_time_method(setup, request.scene.time().step());
    setup.method = choice.method;
  }
  model_ = std::make_unique<SolidModel>(std::move(setup));
  identity_ = identity_of(model_->mesh(), request.scene.solid());
  model_->note_why_method(choice.reason);
  if (!is_new) {
    StoredState stored = read_checkpoint(request.resume_from, model_->accepted(), identity_);
    refuse_another_method(stored.state.method, request.scene.solid().time_integration().method(),
                          model_->accepted().method);
    if (!stored.is_of_this_scene)
      std::cerr << "solid-server: warning: the solid of the scene is not the one that the checkpoint was written with; "
                   "the run goes on from its motion, with the materials, supports and loads of the scene\n";
    model_->resume(std::move(stored.state));
  }
  if (!model_->accepted().why_method.empty())
    std::cerr << "solid-server: time integration: " << model_->accepted().why_method << '\n';

  model_->set_watch(goes_on_);
  model_->n_substeps(request.scene.time().step());  // refuses a step without end before anything is written
  if (const auto warning = time_integration_warning(request.scene, model_->accepted().method); !warning.empty())
    std::cerr << "solid-server: warning: " << warning << '\n';
  if (is_new) warn_of_contact_at_rest();

  const Motion& motion = model_->accepted().motion;
  results_ = std::make_unique<ResultOutput>(request.scene, request.run_folder, *model_);
  results_->accept(motion);

  needs_force_ = request.scene.has_flow();
  offered_ = needs_force_ ? offer_wetted(model_->wetted()) : offer_probed(model_->mesh(), request.scene.output());
  orifices_.clear();
  for (const v1::Orifice& orifice : request.scene.solid().orifice())
    orifices_.emplace_back(model_->mesh(), make_orifice_shape(orifice),
                           "solid.orifice[" + std::to_string(orifices_.size()) + "]");
  participant::Opened opened;
  opened.surface = offered_.surface;
  opened.time = motion.time;
  if (needs_force_) opened.needs = {"force"};
  opened.offers = {"displacement", "velocity"};
  opened.fields = fields_at_surface(motion);
  return opened;
}

void SolidParticipant::watch_steps(std::function<bool(double time)> goes_on) {
  goes_on_ = std::move(goes_on);
  if (model_) model_->set_watch(goes_on_);
}

participant::StepSolved SolidParticipant::solve_step(const participant::StepInterval& interval,
                                                     const surface::FieldSet& fields) {
  const Stopwatch watch(seconds_);
  check_start(interval, model_->accepted().motion.time);
  model_->align_time(interval.start);
  model_->solve_step(interval.duration, received_force(fields));
  participant::StepSolved solved;
  solved.fields = fields_at_surface(model_->trial().motion);
  const StepWork& work = model_->work_of_last_step();
  solved.inner_iterations = static_cast<int>(is_explicit() ? work.n_substeps : work.n_iterations);
  solved.residual = work.residual;
  if (work.is_cut_for_contact) warn_of_cut(interval.duration);
  solved.seconds = watch.seconds();
  return solved;
}

std::vector<participant::NamedNumber> SolidParticipant::accept_step(std::int64_t) {
  const Stopwatch watch(seconds_);
  model_->accept_step();
  results_->accept(model_->accepted().motion);
  const SolidEnergy energy = model_->energy();
  std::vector<participant::NamedNumber> numbers = {
      {"solid.kinetic_energy", energy.kinetic, "J"},
      {"solid.strain_energy", energy.strain, "J"},
      {"solid.contact_energy", energy.contact, "J"},
      {"solid.contact_force", energy.contact_force, "N"},
      {"solid.substeps", static_cast<double>(model_->work_of_last_step().n_substeps), "1"}};
  if (model_->may_lose_stiffness()) numbers.push_back(softened_elements());
  if (energy.flow) {
    const auto& [work, damping] = *energy.flow;
    numbers.push_back({"solid.external_work", work, "J"});
    numbers.push_back({"solid.damping_work", damping, "J"});
    numbers.push_back(
        {"solid.energy_imbalance", energy.kinetic + energy.strain + energy.contact - work + damping, "J"});
  }
  if (energy.contact_distance) numbers.push_back({"solid.contact_distance", *energy.contact_distance, "m"});
  if (!is_explicit()) add_implicit_numbers(numbers);
  for (const Reaction& reaction : model_->reactions())
    for (int axis = 0; axis < 3; ++axis)
      numbers.push_back(
          {"solid.reaction." + reaction.support + "." + std::string(1, "xyz"[axis]), reaction.force[axis], "N"});
  for (Orifice& orifice : orifices_)
    numbers.push_back({orifice.name(), orifice.area(model_->accepted().motion.displacement), "m^2"});
  return numbers;
}

void SolidParticipant::warn_of_contact_at_rest() const {
  const double force = model_->contact_force_at_rest();
  if (force > 0)
    std::cerr << "solid-server: warning: t = 0 s: a body stands beyond a rigid plane at rest and is pushed back with "
              << report::text(force) << " N; move the plane, or the body\n";
}

void SolidParticipant::warn_of_cut(double duration) {
  if (has_warned_of_cut_) return;
  has_warned_of_cut_ = true;
  std::cerr << "solid-server: t = " << report::text(model_->accepted().motion.time)
            << " s: surfaces meet too fast for implicit steps of " << report::text(duration)
            << " s; such steps are cut, so that surfaces do not pass each other: solid.substeps in history.csv tells "
               "into how many. CENTRAL_DIFFERENCE may cost less\n";
}

/// How many elements have lost stiffness; the first time that one has, it is named.
participant::NamedNumber SolidParticipant::softened_elements() {
  const SoftenedElements softened = model_->softened();
  if (softened.n > 0 && !has_warned_of_softening_) {
    has_warned_of_softening_ = true;
    std::cerr << "solid-server: warning: t = " << report::text(model_->accepted().motion.time)
              << " s: " << model_->mesh().describe_element(softened.first)
              << " is compressed so much that saint_venant_kirchhoff answers more compression with less stress; what "
                 "follows means little, use neo_hookean or mooney_rivlin\n";
  }
  return {"solid.softened_elements", static_cast<double>(softened.n), "1"};
}

bool SolidParticipant::is_explicit() const {
  return model_->accepted().method == TimeMethod::central_difference;
}

void SolidParticipant::add_implicit_numbers(std::vector<participant::NamedNumber>& numbers) const {
  const StepWork& work = model_->work_of_last_step();
  numbers.push_back({"solid.newton_iterations", static_cast<double>(work.n_iterations), "1"});
  numbers.push_back({"solid.residual", work.residual, "1"});
  if (model_->accepted().method == TimeMethod::static_equilibrium)
    numbers.push_back({"solid.negative_pivots", static_cast<double>(work.n_negative_pivots), "1"});
}

std::uint64_t SolidParticipant::write_checkpoint(const std::string& path) {
  const Stopwatch watch(seconds_);
  solid::write_checkpoint(path, model_->accepted(), identity_);
  return static_cast<std::uint64_t>(std::filesystem::file_size(path));
}

std::vector<participant::NamedNumber> SolidParticipant::close(const std::string&) {
  results_.reset();
  std::vector<participant::NamedNumber> numbers = {{"seconds", seconds_, "s"},
                                                   {"peak_memory_bytes", peak_memory_bytes(), "1"}};
  if (model_) {
    const StepWork work = model_->total_work();
    numbers.push_back({"substeps", static_cast<double>(work.n_substeps), "1"});
    if (!is_explicit()) {
      numbers.push_back({"newton_iterations", static_cast<double>(work.n_iterations), "1"});
      numbers.push_back({"factorisations", static_cast<double>(work.n_factorisations), "1"});
      numbers.push_back({"worst_residual", work.residual, "1"});
    }
    if (!model_->accepted().why_method.empty())
      numbers.push_back({"time_integration", 0, "", model_->accepted().why_method});
    numbers.push_back({"element_seconds", model_->element_seconds(), "s"});
    numbers.push_back({"elements", static_cast<double>(model_->mesh().n_elements()), "1"});
    numbers.push_back({"nodes", static_cast<double>(model_->mesh().n_nodes()), "1"});
  }
  model_.reset();
  return numbers;
}

surface::FieldSet SolidParticipant::fields_at_surface(const Motion& motion) const {
  const auto& nodes = offered_.solid_node;
  const auto at_surface = [&](const NodeVectors& values) {
    surface::NodeArray out(static_cast<Eigen::Index>(nodes.size()), 3);
    for (std::size_t n = 0; n < nodes.size(); ++n)
      out.row(static_cast<Eigen::Index>(n)) = values.row(nodes[n]).head<3>();
    return out;
  };
  return {{"displacement", "m", at_surface(motion.displacement)}, {"velocity", "m/s", at_surface(motion.velocity)}};
}

surface::NodeArray SolidParticipant::received_force(const surface::FieldSet& fields) const {
  const auto n_nodes = static_cast<Eigen::Index>(model_->wetted().solid_node.size());
  if (!needs_force_) return surface::NodeArray::Zero(n_nodes, 3);
  const surface::NodeArray& force = surface::find_field(fields, "force").values;
  if (force.rows() != n_nodes || force.cols() != 3)
    throw report::PeerError("solid-server",
                            "the field 'force' is " + std::to_string(force.rows()) + " x " +
                                std::to_string(force.cols()) + ", not " + std::to_string(n_nodes) + " x 3",
                            "check the mapping between the two surfaces");
  return force;
}

}  // namespace couplet::solid
