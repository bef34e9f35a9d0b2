#pragma once
// One deformable body that moves under loads: the door through which the service and the tests see the solid.

#include <memory>
#include <optional>

#include "solid-server/assembly/block_properties.hpp"
#include "solid-server/contact/rigid_plane.hpp"
#include "solid-server/contact/surface_contact.hpp"
#include "solid-server/dynamics/generalized_alpha.hpp"
#include "solid-server/dynamics/static_solution.hpp"
#include "solid-server/dynamics/substep_limit.hpp"
#include "solid-server/load/dead_load.hpp"
#include "solid-server/load/surface_pressure.hpp"
#include "solid-server/mesh/wetted_surface.hpp"
#include "solid-server/support/supports.hpp"

namespace couplet::solid {

/// A velocity field that is added once, at a given time.
struct Kick {
  double time = 0;                                                  // [s]
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> velocity;  // of the position at rest [m/s]
};

enum class TimeMethod { central_difference, generalized_alpha, static_equilibrium };

const char* name_of(TimeMethod method);  // as scenes write it

/// Bodies and everything that acts on them. SI units.
struct SolidSetup {
  SolidMesh mesh;                           // of all bodies
  std::vector<BlockProperties> properties;  // of each block of the mesh
  Supports supports;
  std::vector<std::string> wetted;  // surfaces that touch the flow
  Damping damping;
  std::vector<Kick> kicks;
  std::vector<PressureLoad> pressures;
  std::vector<Traction> tractions;
  std::vector<NodeForce> node_forces;
  VectorOverTime gravity;  // acceleration [m/s^2]; empty: none
  std::vector<RigidPlane> planes;
  std::vector<ContactPair> contacts;  // stiffness or largest_depth 0: as contact/penalty_stiffness has it
  TimeMethod method = TimeMethod::central_difference;
  StepControl step;          // of the central difference method
  ImplicitControl implicit;  // of the generalized-alpha method
  StaticControl statics;
  bool keeps_energy_balance = false;  // the central difference method finds work and damping
  int n_threads = 1;
};

/// What is kept from one accepted step to the next, and in a checkpoint.
struct SolidState {
  Motion motion;
  TimeMethod method = TimeMethod::central_difference;
  std::string why_method;  // one sentence when it was chosen by its cost; else empty
};

/// What a named support exerts on the body.
struct Reaction {
  std::string support;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // [N]
};

/// What went into a body since t = 0 and what damping took, see EnergyLedger.
struct EnergyFlow {
  double external_work = 0, damping_work = 0;  // [J]
};

struct SolidEnergy {
  double kinetic = 0, strain = 0, contact = 0;  // [J]
  double contact_force = 0;                     // of rigid planes on bodies and of bodies on each other [N]
  std::optional<double> contact_distance;  // smallest one of surfaces that touch, their d0 when none does; negative
                                           // behind a surface; absent without contact of surfaces [m]
  std::optional<EnergyFlow> flow;          // absent unless the setup asks for it, and with implicit methods
};

/// Two states: accepted and trial. solve_step always starts from the accepted one.
class SolidModel {
 public:
  /// At rest at t = 0. Throws SceneError for surfaces that do not exist, folded elements, planes that nothing
  /// can touch.
  explicit SolidModel(SolidSetup setup);
  ~SolidModel();
  SolidModel(SolidModel&&) noexcept;
  SolidModel& operator=(SolidModel&&) noexcept;

  const SolidMesh& mesh() const;
  const std::vector<BlockProperties>& properties() const;  // of each block of the mesh
  const WettedSurface& wetted() const;

  /// From the accepted state over `duration` [s] with the force on the wetted nodes at its end, (n wetted nodes, 3)
  /// [N]. Throws NumericsError when an element is turned inside out or an implicit step has no solution, Interrupted
  /// when the watch gives the step up.
  void solve_step(double duration, const surface::NodeArray& interface_force);

  /// From now on every step tells the watch how far it is.
  void set_watch(StepWatch watch);

  /// The time of the accepted state as the coupler has it, which adds up steps with another round-off.
  void align_time(double accepted_time);
  const SolidState& trial() const;

  /// Makes the trial state the accepted one; estimates the stable step again when it is due.
  void accept_step();
  const SolidState& accepted() const;
  void note_why_method(std::string reason);  // a sentence that checkpoints keep
  /// Sizes must be those of accepted(); the method becomes that of the state. The stable step is estimated there where
  /// the state has no estimate.
  void resume(SolidState state);

  int n_substeps(double duration) const;     // that a step of this duration [s] takes now, when nothing goes wrong
  SolidEnergy energy() const;                // of the last accepted step
  double contact_force_at_rest() const;      // before any motion [N]
  bool may_lose_stiffness() const;           // whether a law does in compression
  SoftenedElements softened() const;         // elements where it has, at the end of the last accepted step
  Eigen::Vector3d angular_momentum() const;  // of the accepted state about the origin [kg m^2/s]
  std::vector<Reaction> reactions() const;   // in the accepted state, of each support
  const StepWork& work_of_last_step() const;
  /// What implicit steps of this duration [s] cost, statically without inertia. Not with the central difference method.
  ImplicitCost implicit_cost(double duration);
  double least_factorisation_seconds() const;  // without doing one [s]; likewise
  int n_free_components() const;               // of all displacements
  StepWork total_work() const;                 // repeated steps included; the worst residual
  double element_seconds() const;              // spent in the element kernel
  std::size_t memory_bytes() const;            // of the arrays of the time loop

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace couplet::solid
