#include "solid-server/solid_model.hpp"

#include <cmath>

#include "proto/report/failure.hpp"
#include "solid-server/contact/penalty_stiffness.hpp"
#include "solid-server/dynamics/central_difference.hpp"
#include "solid-server/dynamics/stable_step.hpp"
#include "solid-server/element/mass.hpp"

namespace couplet::solid {

namespace {

double smallest_edge(const SolidMesh& mesh) {
  double smallest = std::numeric_limits<double>::max();
  for (const ElementBlock& block : mesh.block)
    for (Index element = 0; element < block.n_elements(); ++element)
      for (const auto& [a, b] : topology(block.shape).edge) {
        if (a < 0) continue;
        const auto corner = [&](int c) {
          return mesh.node_position.row(block.nodes_of(element)[static_cast<std::size_t>(c)]);
        };
        smallest = std::min(smallest, (corner(b) - corner(a)).norm());
      }
  return smallest;
}

std::vector<KickVelocity> kick_velocities(const SolidMesh& mesh, const std::vector<Kick>& kicks) {
  std::vector<KickVelocity> velocities;
  for (const Kick& kick : kicks) {
    velocities.push_back({kick.time, NodeVectors::Zero(mesh.n_nodes(), 4)});
    for (Index n = 0; n < mesh.n_nodes(); ++n)
      velocities.back().velocity.row(n).head<3>() = kick.velocity(mesh.node_position.row(n));
  }
  return velocities;
}

double kinetic_energy(const Eigen::VectorXd& mass, const NodeVectors& velocity) {
  double sum = 0;
  for (Eigen::Index n = 0; n < mass.size(); ++n) sum += mass[n] * velocity.row(n).squaredNorm();
  return sum / 2;
}

std::vector<double> densities(const std::vector<BlockProperties>& properties) {
  std::vector<double> density;
  for (const BlockProperties& block : properties) density.push_back(block.density);
  return density;
}

PrescribedLoads prescribed_loads(const SolidSetup& setup, const Eigen::VectorXd& mass) {
  PrescribedLoads loads{setup.pressures, {}};
  for (std::size_t l = 0; l < setup.tractions.size(); ++l)
    loads.dead.push_back(
        make_dead_load(setup.mesh, setup.tractions[l], "solid.traction[" + std::to_string(l) + "].surface"));
  for (std::size_t l = 0; l < setup.node_forces.size(); ++l)
    loads.dead.push_back(
        make_dead_load(setup.mesh, setup.node_forces[l], "solid.node_force[" + std::to_string(l) + "].nodes"));
  if (setup.gravity) loads.dead.push_back(make_body_force(mass, setup.gravity));
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

struct SolidModel::Parts {
  SolidSetup setup;
  WettedSurface wetted;
  Eigen::VectorXd mass;      // (n_nodes) [kg]
  NodeVectors inverse_mass;  // (n_nodes, 4) [1/kg]
  NodalForce force;
  WorkTeam team;
  CentralDifference integrator;
  double smallest_length;       // [m]
  double contact_rate_squared;  // bound of contact's part of omega_max^2 [1/s^2]
  SolidState accepted, trial;
  SolidEnergy energy;
  int n_substeps_last = 0;
  long n_substeps_total = 0;

  explicit Parts(SolidSetup s)
      : setup(std::move(s)),
        wetted(make_wetted_surface(setup.mesh, setup.wetted)),
        mass(lumped_mass(setup.mesh, densities(setup.properties))),
        inverse_mass(solid::inverse_mass(setup.mesh, mass, setup.supports)),
        force(setup.mesh, setup.properties,
              ExternalForce(setup.mesh, wetted, prescribed_loads(setup, mass), setup.planes, contact_pairs(setup)),
              setup.n_threads),
        team(setup.n_threads),
        integrator(force, inverse_mass, setup.damping, kick_velocities(setup.mesh, setup.kicks), team),
        smallest_length(smallest_edge(setup.mesh)),
        contact_rate_squared(
            force.external().contact_stiffness_bound().cwiseProduct(inverse_mass.rowwise().maxCoeff()).maxCoeff()) {}

  void estimate_stable_step() {
    accepted.stable_step =
        stable_step([&](const NodeVectors& u) { return force.internal_only(u); }, accepted.motion.displacement,
                    inverse_mass, smallest_length, contact_rate_squared, setup.damping.stiffness_factor);
    accepted.n_accepted_since_estimate = 0;
  }

  /// The force at t = 0, before any interface load: pressures and planes may already act.
  void find_first_force() {
    accepted.motion.force = force.all(accepted.motion.displacement, {accepted.motion.time, 0, false});
  }

  [[noreturn]] void refuse_inverted(double start, double end) const {
    const Index element = force.inverted_element();
    throw report::NumericsError("solid, t = " + std::to_string(start) + " to " + std::to_string(end) + " s",
                                setup.mesh.describe_element(element) + " at rest is turned inside out",
                                "check the loads; lower solid.time_integration.safety or time.step; mooney_rivlin "
                                "resists strong compression better "
                                "than saint_venant_kirchhoff");
  }
};

SolidModel::SolidModel(SolidSetup setup) : parts_(std::make_unique<Parts>(std::move(setup))) {
  Parts& p = *parts_;
  p.accepted.motion = at_rest(p.setup.mesh.n_nodes(), p.wetted.solid_node.size());
  p.trial = p.accepted;
  p.find_first_force();
  p.estimate_stable_step();
}

SolidModel::~SolidModel() = default;

const SolidMesh& SolidModel::mesh() const {
  return parts_->setup.mesh;
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
int SolidModel::n_substeps_of_last_step() const {
  return parts_->n_substeps_last;
}
long SolidModel::n_substeps_total() const {
  return parts_->n_substeps_total;
}
double SolidModel::element_seconds() const {
  return parts_->force.element_seconds();
}

int SolidModel::n_substeps(double duration) const {
  const StepControl& control = parts_->setup.step;
  double largest = control.safety * parts_->accepted.stable_step;
  if (control.largest_substep > 0) largest = std::min(largest, control.largest_substep);
  return std::max(1, static_cast<int>(std::ceil(duration / largest * (1 - 1e-12))));
}

void SolidModel::solve_step(double duration, const surface::NodeArray& interface_force) {
  Parts& p = *parts_;
  p.n_substeps_last = n_substeps(duration);
  p.integrator.advance(p.accepted.motion, duration, p.n_substeps_last, interface_force, p.trial.motion);
  p.n_substeps_total += p.n_substeps_last;
  if (p.force.inverted_element() >= 0) p.refuse_inverted(p.accepted.motion.time, p.trial.motion.time);
}

void SolidModel::align_time(double accepted_time) {
  parts_->accepted.motion.time = accepted_time;
}

void SolidModel::accept_step() {
  Parts& p = *parts_;
  std::swap(p.accepted.motion, p.trial.motion);
  const Motion& motion = p.accepted.motion;
  p.energy.kinetic = kinetic_energy(p.mass, motion.velocity);
  p.energy.strain = p.force.strain_energy();
  const auto contact = p.force.external().contact_total(motion.displacement.data());
  p.energy.contact = contact.energy;
  p.energy.contact_force = contact.force;
  if (++p.accepted.n_accepted_since_estimate >= p.setup.step.estimate_every) p.estimate_stable_step();
}

void SolidModel::resume(SolidState state) {
  parts_->accepted = std::move(state);
}

std::size_t SolidModel::memory_bytes() const {
  const auto n_nodes = static_cast<std::size_t>(parts_->inverse_mass.rows());
  return parts_->force.memory_bytes() + n_nodes * sizeof(double) * 4 * (2 * 3 + 1);
}

}  // namespace couplet::solid
