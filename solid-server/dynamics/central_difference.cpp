#include "solid-server/dynamics/central_difference.hpp"

#include <cmath>

#include "proto/report/failure.hpp"

namespace couplet::solid {

namespace {

constexpr Eigen::Index width = NodeVectors::ColsAtCompileTime;

[[gnu::always_inline]] inline NodeQuad quad(const double* values, Eigen::Index node) {
  return load_quad(values + width * node);
}

[[gnu::always_inline]] inline void put(const NodeQuad& value, double* values, Eigen::Index node) {
  std::memcpy(values + width * node, &value, sizeof value);
}

}  // namespace

CentralDifference::CentralDifference(NodalForce& force, NodeVectors inverse_mass, Damping damping,
                                     std::vector<KickVelocity> kicks, WorkTeam& team)
    : force_(force),
      inverse_mass_(std::move(inverse_mass)),
      damping_(damping),
      kicks_(std::move(kicks)),
      team_(team),
      is_strain_damped_(damping.stiffness_factor > 0) {
  if (is_strain_damped_) strained_ = NodeVectors::Zero(inverse_mass_.rows(), 4);
  std::stable_sort(kicks_.begin(), kicks_.end(),
                   [](const KickVelocity& a, const KickVelocity& b) { return a.time < b.time; });
  for (KickVelocity& kick : kicks_) kick.velocity.array() *= (inverse_mass_.array() > 0).cast<double>();
}

void CentralDifference::advance(const Motion& from, double duration, int n_substeps,
                                const surface::NodeArray& interface_force, Motion& to) {
  plan(from, duration, n_substeps, to);
  force_.forget_inverted();
  force_.external().set_interface_load(from.has_interface_force ? from.interface_force : interface_force,
                                       interface_force);
  if (!from.has_interface_force) to.force = from.force + force_.external().interface_load_at_start();
  const double* first_force = (from.has_interface_force ? from.force : to.force).data();

  team_.run([&](int member) {
    start(from, first_force, share_of(static_cast<int>(inverse_mass_.rows()), member, team_.n_members()), to);
    for (int k = 0; k < n_substeps; ++k)
      if (!substep(member, k, to)) return;  // for all members at once
  });
  to.time = from.time + duration;
  to.interface_force = interface_force;
  to.has_interface_force = true;
}

/// Damping factors and kicks of the substeps.
void CentralDifference::plan(const Motion& from, double duration, int n_substeps, Motion& to) {
  h_ = duration / n_substeps;
  substeps_.resize(static_cast<std::size_t>(n_substeps));
  to.n_kicks_done = from.n_kicks_done;
  for (int k = 0; k < n_substeps; ++k) {
    Substep& substep = substeps_[static_cast<std::size_t>(k)];
    const double begin = from.time + k * h_;
    substep.end = from.time + (k + 1) * h_;
    substep.damping_factor = std::exp(-damping_.at(begin + h_ / 2) * h_ / 2);
    substep.kick = nullptr;
    const auto next = static_cast<std::size_t>(to.n_kicks_done);
    if (next < kicks_.size() && kicks_[next].time <= begin + h_ / 2) {
      substep.kick = kicks_[next].velocity.data();
      ++to.n_kicks_done;
    }
  }
}

/// The first half kick and drift.
void CentralDifference::start(const Motion& from, const double* force, Share nodes, Motion& to) {
  const Substep& next = substeps_.front();
  const double d = next.damping_factor;
  for (Eigen::Index n = nodes.first; n < nodes.last; ++n) {
    NodeQuad v = quad(from.velocity.data(), n);
    if (next.kick) v += quad(next.kick, n);
    v = d * v + (h_ / 2) * (quad(force, n) * quad(inverse_mass_.data(), n));
    const NodeQuad u = quad(from.displacement.data(), n) + h_ * v;
    put(v, to.velocity.data(), n);
    put(u, to.displacement.data(), n);
    note_strained(n, u, v);
  }
}

/// The force at the end of substep k; the second half kick; if another substep follows, its first half kick and drift.
/// Each node moves on as soon as its force is known. False when an element is turned inside out.
bool CentralDifference::substep(int member, int k, Motion& to) {
  const auto n_substeps = static_cast<int>(substeps_.size());
  const Substep& last = substeps_[static_cast<std::size_t>(k)];
  const double d_last = last.damping_factor, half = h_ / 2;
  const double* const inverse_mass = inverse_mass_.data();
  double* const velocity = to.velocity.data();
  double* const displacement = to.displacement.data();
  const bool is_last = k == n_substeps - 1;
  const Moment moment{last.end, static_cast<double>(k + 1) / n_substeps, is_last};

  if (is_last)
    return visit_all(member, displacement, moment, [&](Index node, const NodeQuad& force) {
      put(d_last * (quad(velocity, node) + half * (force * quad(inverse_mass, node))), velocity, node);
      put(force, to.force.data(), node);
    });

  const Substep& next = substeps_[static_cast<std::size_t>(k) + 1];
  const double d_next = next.damping_factor;
  return visit_all(member, displacement, moment, [&](Index node, const NodeQuad& force) {
    const NodeQuad change = half * (force * quad(inverse_mass, node));
    NodeQuad v = d_last * (quad(velocity, node) + change);
    if (next.kick) v += quad(next.kick, node);
    v = d_next * v + change;
    const NodeQuad u = quad(displacement, node) + h_ * v;
    put(v, velocity, node);
    put(u, displacement, node);
    note_strained(node, u, v);
  });
}

inline void CentralDifference::note_strained(Eigen::Index node, const NodeQuad& displacement,
                                             const NodeQuad& velocity) {
  if (is_strain_damped_) put(displacement + damping_.stiffness_factor * velocity, strained_.data(), node);
}

template <class Visit>
bool CentralDifference::visit_all(int member, const double* displacement, const Moment& moment, const Visit& visit) {
  team_.barrier();
  if (force_.has_surface_contact()) {
    if (member == 0) force_.search_contact(displacement);
    team_.barrier();
    force_.find_gaps(member);
    team_.barrier();
  }
  force_.write_external_parts(member, displacement, moment);
  team_.barrier();
  force_.sweep(member, strained_at(displacement), moment, visit);
  team_.barrier();
  if (force_.inverted_element() >= 0) return false;
  force_.visit_shared(member, visit);
  return true;
}

}  // namespace couplet::solid
