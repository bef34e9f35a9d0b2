#include "solid-server/solid_model.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "proto/report/failure.hpp"
#include "solid-server/contact/penalty_stiffness.hpp"
#include "solid-server/dynamics/central_difference.hpp"
#include "solid-server/element/mass.hpp"
#include "solid-server/support/rigid_motion.hpp"

namespace couplet::solid {

namespace {

std::vector<KickVelocity> kick_velocities(const SolidMesh& mesh, const std::vector<Kick>& kicks) {
  std::vector<KickVelocity> velocities;
  for (const Kick& kick : kicks) {
    velocities.push_back({kick.time, NodeVectors::Zero(mesh.n_nodes(), 4)});
    for (Index n = 0; n < mesh.n_nodes(); ++n) {
      const Eigen::Vector3d velocity = kick.velocity(mesh.node_position.row(n));
      if (!velocity.allFinite())
        throw report::SceneError("solid.kick[" + std::to_string(velocities.size() - 1) + "].velocity",
                                 "the formulas give (" + report::text(velocity.x()) + ", " +
                                     report::text(velocity.y()) + ", " + report::text(velocity.z()) + ") m/s at " +
                                     place_text(mesh.node_position.row(n)),
                                 "mend them: every node needs a finite velocity");
      velocities.back().velocity.row(n).head<3>() = velocity;
    }
  }
  return velocities;
}

std::vector<double> densities(const std::vector<BlockProperties>& properties) {
  std::vector<double> density;
  for (const BlockProperties& block : properties) density.push_back(block.density);
  return density;
}

PrescribedLoads prescribed_loads(const SolidSetup& setup, const Eigen::VectorXd& lumped) {
  PrescribedLoads loads{setup.pressures, {}};
  for (std::size_t l = 0; l < setup.tractions.size(); ++l)
    loads.dead.push_back(
        make_dead_load(setup.mesh, setup.tractions[l], "solid.traction[" + std::to_string(l) + "].surface"));
  for (std::size_t l = 0; l < setup.node_forces.size(); ++l)
    loads.dead.push_back(
        make_dead_load(setup.mesh, setup.node_forces[l], "solid.node_force[" + std::to_string(l) + "].nodes"));
  if (setup.gravity)
    loads.dead.push_back(make_body_force(setup.method == TimeMethod::central_difference
                                             ? lumped
                                             : row_sums_of_mass(setup.mesh, densities(setup.properties)),
                                         setup.gravity));
  return loads;
}

std::vector<ContactPair> contact_pairs(const SolidSetup& setup) {
  std::vector<ContactPair> pairs;
  for (const ContactPair& pair : setup.contacts)
    pairs.push_back(complete(pair, setup.mesh, setup.properties, static_cast<int>(pairs.size())));
  return pairs;
}

Motion at_rest(Index n_nodes, std::size_t n_wetted) {
  Motion motion;
  motion.displacement = motion.velocity = motion.force = NodeVectors::Zero(n_nodes, 4);
  motion.interface_force = surface::NodeArray::Zero(static_cast<Eigen::Index>(n_wetted), 3);
  return motion;
}

}  // namespace

const char* name_of(TimeMethod method) {
  switch (method) {
    case TimeMethod::central_difference:
      return "CENTRAL_DIFFERENCE";
    case TimeMethod::generalized_alpha:
      return "GENERALIZED_ALPHA";
    case TimeMethod::static_equilibrium:
      return "STATIC";
  }
  return "";
}

struct SolidModel::Parts {
  SolidSetup setup;
  WettedSurface wetted;
  Eigen::VectorXd mass;      // (n_nodes) [kg]
  NodeVectors inverse_mass;  // (n_nodes, 4) [1/kg]
  std::vector<SupportComponents> supports;
  NodalForce force;
  WorkTeam team;
  CentralDifference* central_difference = nullptr;  // the integrator, when it is this one
  BodyEquations* equations = nullptr;               // of any other
  std::unique_ptr<TimeIntegrator> integrator;
  SolidState accepted, trial;
  SolidEnergy energy;
  SoftenedElements softened;
  StepWork work_last, work_total;

  explicit Parts(SolidSetup s)
      : setup(std::move(s)),
        wetted(make_wetted_surface(setup.mesh, setup.wetted)),
        mass(lumped_mass(setup.mesh, densities(setup.properties))),
        inverse_mass(solid::inverse_mass(setup.mesh, mass, setup.supports)),
        supports(support_components(setup.mesh, setup.supports)),
        force(setup.mesh, setup.properties,
              ExternalForce(setup.mesh, wetted, prescribed_loads(setup, mass), setup.planes, contact_pairs(setup)),
              setup.n_threads),
        team(setup.n_threads),
        integrator(make_integrator()) {}

  std::unique_ptr<TimeIntegrator> make_integrator() {
    HeldMotion held(setup.mesh, setup.supports.prescribed);
    const auto& nodes = setup.mesh.node_position;
    const double extent = (nodes.colwise().maxCoeff() - nodes.colwise().minCoeff()).maxCoeff();
    if (setup.method != TimeMethod::static_equilibrium) held.refuse_jump_at_start(1e-12 * extent);  // round-off
    std::vector<KickVelocity> kicks = kick_velocities(setup.mesh, setup.kicks);
    if (setup.method == TimeMethod::central_difference) {
      auto made = std::make_unique<CentralDifference>(setup.mesh, force, mass, inverse_mass, std::move(held),
                                                      setup.damping, std::move(kicks),
                                                      SubstepLimit(setup.mesh, setup.properties, force, inverse_mass,
                                                                   setup.damping.stiffness_factor, setup.step, team),
                                                      team);
      central_difference = made.get();
      if (setup.keeps_energy_balance) made->keep_ledger();
      return made;
    }
    if (setup.method == TimeMethod::static_equilibrium && setup.planes.empty() && setup.contacts.empty())
      check_rigid_motion(setup.mesh, free_components(inverse_mass), "solid.body");
    auto body = std::make_unique<BodyEquations>(setup.mesh, setup.properties, free_components(inverse_mass),
                                                std::move(held), force, team);
    equations = body.get();
    if (setup.method == TimeMethod::static_equilibrium)
      return std::make_unique<StaticSolution>(std::move(body), setup.statics);
    return std::make_unique<GeneralizedAlpha>(std::move(body), setup.damping, std::move(kicks), setup.implicit);
  }

  /// The force at t = 0, before any interface load: pressures and planes may already act.
  void find_first_force() {
    accepted.motion.force = force.all(accepted.motion.displacement, {accepted.motion.time, 0, false});
  }
};

SolidModel::SolidModel(SolidSetup setup) : parts_(std::make_unique<Parts>(std::move(setup))) {
  Parts& p = *parts_;
  p.accepted.motion = at_rest(p.setup.mesh.n_nodes(), p.wetted.solid_node.size());
  p.accepted.method = p.setup.method;
  p.trial = p.accepted;
  p.find_first_force();
  if (p.central_difference)
    p.accepted.motion.estimate = p.central_difference->limit().estimate_at(p.accepted.motion.displacement);
}

SolidModel::~SolidModel() = default;
SolidModel::SolidModel(SolidModel&&) noexcept = default;
SolidModel& SolidModel::operator=(SolidModel&&) noexcept = default;

const SolidMesh& SolidModel::mesh() const {
  return parts_->setup.mesh;
}
const std::vector<BlockProperties>& SolidModel::properties() const {
  return parts_->setup.properties;
}
const WettedSurface& SolidModel::wetted() const {
  return parts_->wetted;
}
const SolidState& SolidModel::trial() const {
  return parts_->trial;
}
const SolidState& SolidModel::accepted() const {
  return parts_->accepted;
}
SolidEnergy SolidModel::energy() const {
  return parts_->energy;
}
double SolidModel::contact_force_at_rest() const {
  const NodeVectors at_rest = NodeVectors::Zero(parts_->setup.mesh.n_nodes(), 4);
  return parts_->force.external().contact_total(at_rest.data()).force;
}
bool SolidModel::may_lose_stiffness() const {
  const auto may = [](const BlockProperties& block) {
    return std::visit([](const auto& law) { return law.may_lose_stiffness; }, block.material);
  };
  return std::any_of(parts_->setup.properties.begin(), parts_->setup.properties.end(), may);
}
SoftenedElements SolidModel::softened() const {
  return parts_->softened;
}
Eigen::Vector3d SolidModel::angular_momentum() const {
  const Motion& motion = parts_->accepted.motion;
  const NodeVectors momentum = parts_->integrator->mass_times(motion.velocity);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Index n = 0; n < momentum.rows(); ++n) {
    const Eigen::Vector3d x = parts_->setup.mesh.node_position.row(n) + motion.displacement.row(n).head<3>();
    sum += x.cross(Eigen::Vector3d(momentum.row(n).head<3>()));
  }
  return sum;
}
std::vector<Reaction> SolidModel::reactions() const {
  std::vector<Reaction> reactions;
  for (const SupportComponents& support : parts_->supports) {
    reactions.push_back({support.name});
    const auto force = parts_->integrator->support_force(parts_->accepted.motion, support.components);
    for (std::size_t n = 0; n < force.size(); ++n) reactions.back().force[support.components[n].axis] += force[n];
  }
  return reactions;
}
const StepWork& SolidModel::work_of_last_step() const {
  return parts_->work_last;
}
ImplicitCost SolidModel::implicit_cost(double duration) {
  return parts_->equations->measure(parts_->accepted.motion, duration);
}
double SolidModel::least_factorisation_seconds() const {
  return parts_->equations->least_factorisation_seconds();
}
int SolidModel::n_free_components() const {
  return static_cast<int>((parts_->inverse_mass.array() > 0).count());
}
StepWork SolidModel::total_work() const {
  return parts_->work_total;
}
double SolidModel::element_seconds() const {
  return parts_->force.element_seconds();
}

int SolidModel::n_substeps(double duration) const {
  if (parts_->central_difference) return parts_->central_difference->n_substeps(parts_->accepted.motion, duration);
  const double largest = parts_->setup.implicit.largest_substep;
  return largest > 0 ? n_equal_steps(duration, largest) : 1;
}

void SolidModel::solve_step(double duration, const surface::NodeArray& interface_force) {
  Parts& p = *parts_;
  p.work_last = p.integrator->advance(p.accepted.motion, duration, interface_force, p.trial.motion);
  p.work_total.add(p.work_last);
}

void SolidModel::set_watch(StepWatch watch) {
  parts_->integrator->set_watch(std::move(watch));
}

void SolidModel::align_time(double accepted_time) {
  parts_->accepted.motion.time = accepted_time;
}

void SolidModel::accept_step() {
  Parts& p = *parts_;
  std::swap(p.accepted.motion, p.trial.motion);
  const Motion& motion = p.accepted.motion;
  p.energy.kinetic = p.integrator->mass_times(motion.velocity).cwiseProduct(motion.velocity).sum() / 2;
  p.energy.strain = p.force.strain_energy();
  p.softened = p.force.softened();
  const auto contact = p.force.external().contact_total(motion.displacement.data());
  p.energy.contact = contact.energy;
  p.energy.contact_force = contact.force;
  p.energy.contact_distance = contact.smallest_distance;
  if (p.central_difference && p.setup.keeps_energy_balance)
    p.energy.flow = EnergyFlow{motion.external_work, motion.damping_work};
  if (p.central_difference) p.central_difference->limit().accept(motion.displacement, p.accepted.motion.estimate);
}

void SolidModel::note_why_method(std::string reason) {
  parts_->accepted.why_method = std::move(reason);
}

void SolidModel::resume(SolidState state) {
  if (state.method != parts_->setup.method) {
    SolidSetup setup = std::move(parts_->setup);
    setup.method = state.method;
    *this = SolidModel(std::move(setup));
  }
  Parts& p = *parts_;
  p.accepted = std::move(state);
  Motion& motion = p.accepted.motion;
  if (p.central_difference && !motion.estimate.displacement)
    motion.estimate = p.central_difference->limit().estimate_at(motion.displacement);
}

std::size_t SolidModel::memory_bytes() const {
  const auto n_nodes = static_cast<std::size_t>(parts_->inverse_mass.rows());
  return parts_->force.memory_bytes() + parts_->integrator->memory_bytes() + n_nodes * sizeof(double) * 4 * (2 * 3 + 1);
}

}  // namespace couplet::solid
