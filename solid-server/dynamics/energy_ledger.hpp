#pragma once
// What goes into a body and what damping takes from it, over the substeps of the central difference method.

#include "solid-server/dynamics/external_force.hpp"
#include "solid-server/element/lane_transpose.hpp"

namespace couplet::solid {

/// Work in the sense of the method [Belytschko, Liu, Moran 2000, 6.2]: half of a load at the start of a substep and
/// half of that at its end along the way between them, so that
///   kinetic + strain + contact energy - work of loads and supports + energy taken by damping
/// stays at what it was at t = 0 but for terms of second order in the substep, with damping by stiffness of first
/// order.
///   Loads: pressures, tractions, gravity, forces on nodes, the interface load as far as contact leaves it; kicks.
///   Supports that move: m a - F along their way, F all other forces.
///   Damping by mass: (1 - d^2) m v^2/2 at each factor d. Damping by stiffness: beta times the work of the internal
///   force along the velocity's path, sum of beta F_int . (change of v): the strain energy is that at u + beta v. A
///   kick leaves terms of beta^2 behind.
/// Each node has its own sums, to which it adds in order of time, so that their bits do not depend on the team.
class EnergyLedger {
 public:
  EnergyLedger(const ExternalForce& external, const Eigen::VectorXd& mass, const NodeVectors& inverse_mass,
               double stiffness_factor);

  void begin_step() { sums_.setZero(); }

  // Of one node, on the components that no support holds. `parts`: what ExternalForce::write has written.

  /// A force while the node drifts [m] and its velocity changes [m/s].
  [[gnu::always_inline]] inline void act(Index node, const NodeQuad& force, const NodeQuad& drift,
                                         const NodeQuad& velocity_change, const double* parts) {
    const NodeQuad free_mass = mass_of(node), none{};
    sums_(node, work_at) += dot(load_.sum(node, parts), free_mass > 0.0 ? drift : none);
    if (stiffness_factor_ > 0)
      sums_(node, damping_at) +=
          stiffness_factor_ * dot(force - all_.sum(node, parts), free_mass > 0.0 ? velocity_change : none);
  }
  /// A velocity that is about to be multiplied by d.
  [[gnu::always_inline]] inline void damp(Index node, const NodeQuad& velocity, double d) {
    sums_(node, damping_at) += (1 - d * d) / 2 * dot(velocity * velocity, mass_of(node));
  }
  /// A velocity to which another is about to be added.
  [[gnu::always_inline]] inline void kick(Index node, const NodeQuad& velocity, const NodeQuad& added) {
    sums_(node, work_at) += dot(added * (velocity + 0.5 * added), mass_of(node));
  }

  /// The same as act for a component that moves as prescribed; its support does the work m a - F too, but for m a,
  /// which is the change of kinetic energy.
  void act_on_held(Index node, int axis, double force, double drift, double velocity_change, const double* parts);

  double work() const { return sums_.col(work_at).sum(); }             // of the step [J]
  double damping_work() const { return sums_.col(damping_at).sum(); }  // likewise
  std::size_t memory_bytes() const;

 private:
  /// Parts of forces on each node.
  struct NodeParts {
    std::vector<Index> first, start;  // (n_nodes + 1), (n parts)

    NodeParts(Index n_nodes, const std::vector<ForcePart>& parts);
    [[gnu::always_inline]] inline NodeQuad sum(Index node, const double* buffer) const {
      NodeQuad total{};
      const auto n = static_cast<std::size_t>(node);
      for (auto part = static_cast<std::size_t>(first[n]); part < static_cast<std::size_t>(first[n + 1]); ++part)
        total += load_quad(buffer + start[part]);
      return total;
    }
  };

  static constexpr Eigen::Index work_at = 0, damping_at = 1;

  [[gnu::always_inline]] static inline double dot(const NodeQuad& a, const NodeQuad& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }
  [[gnu::always_inline]] inline NodeQuad mass_of(Index node) const { return load_quad(&free_mass_(node, 0)); }

  NodeParts load_, all_;
  NodeVectors free_mass_;  // (n_nodes, 4), 0 where a support holds [kg]
  double stiffness_factor_;
  Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor> sums_;  // work, damping (n_nodes, 2) [J]
};

}  // namespace couplet::solid
