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

CentralDifference::CentralDifference(const SolidMesh& mesh, NodalForce& force, Eigen::VectorXd mass,
                                     const NodeVectors& inverse_mass, HeldMotion held, Damping damping,
                                     std::vector<KickVelocity> kicks, SubstepLimit limit, WorkTeam& team)
    : mesh_(mesh),
      force_(force),
      mass_(std::move(mass)),
      inverse_mass_(inverse_mass),
      held_(std::move(held)),
      damping_(damping),
      kicks_(std::move(kicks)),
      limit_(std::move(limit)),
      team_(team),
      is_strain_damped_(damping.stiffness_factor > 0) {
  if (is_strain_damped_) strained_ = NodeVectors::Zero(inverse_mass_.rows(), 4);
  sort_kicks(kicks_);
  for (KickVelocity& kick : kicks_) kick.velocity.array() *= (inverse_mass_.array() > 0).cast<double>();
}

int CentralDifference::n_substeps(const Motion& from, double duration) const {
  return n_equal_steps(duration, limit_.largest(from.estimate));
}

StepWork CentralDifference::advance(const Motion& from, double duration, const surface::NodeArray& interface_force,
                                    Motion& to) {
  force_.external().set_interface_load(from.has_interface_force ? from.interface_force : interface_force,
                                       interface_force);
  if (!from.has_interface_force) to.force = from.force + force_.external().interface_load_at_start();
  const double* first_force = (from.has_interface_force ? from.force : to.force).data();
  to.estimate = from.estimate;
  to.n_kicks_done = from.n_kicks_done;

  if (ledger_) ledger_->begin_step();

  StepWork work;
  double done = 0;  // [s]
  for (bool is_last = false; !is_last;) {
    const double left = duration - done;
    const int n_left = n_equal_steps(left, limit_.largest(to.estimate));
    const int n_pieces = (n_left + SubstepLimit::n_between_looks - 1) / SubstepLimit::n_between_looks;
    is_last = n_pieces == 1;
    Piece piece{from.time + done, left, done / duration, left / duration, n_left};
    if (!is_last) {
      piece.n_substeps = (n_left + n_pieces - 1) / n_pieces;
      piece.duration = left / n_left * piece.n_substeps;
      piece.fraction = piece.duration / duration;
    }
    advance_piece(work.n_substeps == 0 ? from : to, piece, first_force, to);
    first_force = to.force.data();
    done += piece.duration;
    work.n_substeps += piece.n_substeps;
    to.estimate.n_substeps += piece.n_substeps;
    to.estimate.n_unseen += piece.n_substeps;
    if (!is_last) limit_.look(to.displacement, to.estimate);
  }
  if (ledger_) {
    to.external_work = from.external_work + ledger_->work() + kinetic_energy_of_held(to) - kinetic_energy_of_held(from);
    to.damping_work = from.damping_work + ledger_->damping_work();
  }
  to.time = from.time + duration;
  to.interface_force = interface_force;
  to.has_interface_force = true;
  return work;
}

void CentralDifference::advance_piece(const Motion& from, const Piece& piece, const double* first_force, Motion& to) {
  plan(piece, to);
  force_.forget_findings();
  is_given_up_ = false;
  team_.run([&](int member) {
    if (ledger_) {
      write_external_parts(member, from.displacement.data(), {piece.begin, piece.first_fraction, false});
      team_.barrier();
    }
    if (ledger_ && member == 0) note_held(from.velocity);
    start(from, first_force, share_of(static_cast<int>(inverse_mass_.rows()), member, team_.n_members()), to);
    if (!held_.is_empty()) {
      team_.barrier();
      if (member == 0) hold(0, first_force, to);
    }
    for (int k = 0; k < piece.n_substeps; ++k) {
      if (!substep(member, k, to)) return;  // for all members at once
      if (held_.is_empty()) continue;
      team_.barrier();
      if (member == 0) hold(k + 1, to.force.data(), to);
    }
  });
  refuse_inverted(piece);
  if (is_given_up_) throw report::Interrupted("solid, t = " + report::text(piece.begin) + " s");
}

void CentralDifference::refuse_inverted(const Piece& piece) const {
  const Index element = force_.inverted_element();
  if (element < 0) return;
  for (const Substep& substep : substeps_) held_.check_finite(substep.end);
  throw report::NumericsError(
      "solid, t = " + report::text(piece.begin) + " to " + report::text(piece.begin + piece.duration) + " s",
      mesh_.describe_element(element) + " at rest is turned inside out",
      "check the loads; lower solid.time_integration.safety or time.step; refine the mesh there");
}

/// Prescribed nodes after k substeps: the place at the end of the next one, with the velocity that leads there; after
/// the last substep the velocity at its end. `force`: on all nodes after k substeps, for the ledger.
void CentralDifference::hold(int k, const double* force, Motion& to) {
  const bool is_end = k == static_cast<int>(substeps_.size());
  const double next = start_time_ + (is_end ? k : k + 1) * h_;
  held_.hold(next, to.displacement);
  held_.hold_velocity(is_end ? next : next - h_ / 2, h_, to.velocity);
  if (ledger_) {
    for (std::size_t n = 0; n < held_.components().size(); ++n) {
      const auto& [node, axis] = held_.components()[n];
      const double before = held_velocity_[n], after = to.velocity(node, axis);
      const double drift = h_ / 2 * ((k > 0 ? before : 0) + (is_end ? 0 : after));
      ledger_->act_on_held(node, axis, force[width * node + axis], drift, after - before, force_.external_parts());
    }
    note_held(to.velocity);
  }
  if (is_end) return;
  for (const auto& [node, axis] : held_.components())
    note_strained(node, quad(to.displacement.data(), node), quad(to.velocity.data(), node));
}

std::vector<double> CentralDifference::support_force(const Motion& motion,
                                                     const std::vector<HeldMotion::Component>& held) const {
  const double h = limit_.largest(motion.estimate);
  std::vector<double> force;
  for (const auto& [node, axis] : held) {
    force.push_back(-motion.force(node, axis));
    if (const auto n = held_.number_of({node, axis}))
      force.back() += mass_[node] * (held_.acceleration(*n, motion.time, h) +
                                     damping_.at(motion.time) * held_.velocity(*n, motion.time, h));
  }
  return force;
}

void CentralDifference::note_held(const NodeVectors& velocity) {
  held_velocity_.clear();
  for (const auto& [node, axis] : held_.components()) held_velocity_.push_back(velocity(node, axis));
}

/// Of the components that move as prescribed [J].
double CentralDifference::kinetic_energy_of_held(const Motion& motion) const {
  double energy = 0;
  for (const auto& [node, axis] : held_.components())
    energy += mass_[node] * motion.velocity(node, axis) * motion.velocity(node, axis) / 2;
  return energy;
}

std::size_t CentralDifference::memory_bytes() const {
  return (ledger_ ? ledger_->memory_bytes() : 0) + static_cast<std::size_t>(strained_.size()) * sizeof(double) +
         limit_.memory_bytes();
}

/// Times, damping factors and kicks of the substeps.
void CentralDifference::plan(const Piece& piece, Motion& to) {
  start_time_ = piece.begin;
  h_ = piece.duration / piece.n_substeps;
  substeps_.resize(static_cast<std::size_t>(piece.n_substeps));
  for (int k = 0; k < piece.n_substeps; ++k) {
    Substep& substep = substeps_[static_cast<std::size_t>(k)];
    const double begin = piece.begin + k * h_;
    substep.end = piece.begin + (k + 1) * h_;
    substep.fraction = piece.first_fraction + static_cast<double>(k + 1) / piece.n_substeps * piece.fraction;
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
    const auto node = static_cast<Index>(n);
    const NodeQuad before = quad(from.velocity.data(), n);
    NodeQuad v = before;
    if (ledger_ && next.kick) ledger_->kick(node, v, quad(next.kick, n));
    if (next.kick) v += quad(next.kick, n);
    if (ledger_) ledger_->damp(node, v, d);
    v = d * v + (h_ / 2) * (quad(force, n) * quad(inverse_mass_.data(), n));
    if (ledger_) ledger_->act(node, quad(force, n), (h_ / 2) * v, v - before, force_.external_parts());
    const NodeQuad u = quad(from.displacement.data(), n) + h_ * v;
    put(v, to.velocity.data(), n);
    put(u, to.displacement.data(), n);
    note_strained(n, u, v);
  }
}

/// The force at the end of substep k; the second half kick; if another substep follows, its first half kick and drift.
/// Each node moves on as soon as its force is known. False when an element is turned inside out or the watch
/// gives the step up.
bool CentralDifference::substep(int member, int k, Motion& to) {
  return ledger_ ? substep_with<true>(member, k, to) : substep_with<false>(member, k, to);
}

template <bool with_ledger>
bool CentralDifference::substep_with(int member, int k, Motion& to) {
  const auto n_substeps = static_cast<int>(substeps_.size());
  const Substep& last = substeps_[static_cast<std::size_t>(k)];
  const double d_last = last.damping_factor, half = h_ / 2;
  const double* const inverse_mass = inverse_mass_.data();
  double* const velocity = to.velocity.data();
  double* const displacement = to.displacement.data();
  const bool is_last = k == n_substeps - 1;
  const Moment moment{last.end, last.fraction, is_last};

  if (is_last)
    return visit_all(member, displacement, moment, [&](Index node, const NodeQuad& force) {
      const NodeQuad before = quad(velocity, node), v = before + half * (force * quad(inverse_mass, node));
      put(d_last * v, velocity, node);
      put(force, to.force.data(), node);
      if constexpr (with_ledger) {
        ledger_->damp(node, v, d_last);
        ledger_->act(node, force, half * before, d_last * v - before, force_.external_parts());
      }
    });

  const Substep& next = substeps_[static_cast<std::size_t>(k) + 1];
  const double d_next = next.damping_factor;
  return visit_all(member, displacement, moment, [&](Index node, const NodeQuad& force) {
    const NodeQuad change = half * (force * quad(inverse_mass, node));
    const NodeQuad before = quad(velocity, node);
    NodeQuad v = before + change;
    if constexpr (with_ledger) ledger_->damp(node, v, d_last);
    v = d_last * v;
    if constexpr (with_ledger)
      if (next.kick) ledger_->kick(node, v, quad(next.kick, node));
    if (next.kick) v += quad(next.kick, node);
    if constexpr (with_ledger) ledger_->damp(node, v, d_next);
    v = d_next * v + change;
    if constexpr (with_ledger) {
      ledger_->act(node, force, half * (before + v), v - before, force_.external_parts());
      put(force, to.force.data(), node);
    }
    const NodeQuad u = quad(displacement, node) + h_ * v;
    put(v, velocity, node);
    put(u, displacement, node);
    note_strained(node, u, v);
  });
}

void CentralDifference::write_external_parts(int member, const double* displacement, const Moment& moment) {
  if (force_.has_surface_contact()) {
    if (member == 0) force_.search_contact(displacement);
    team_.barrier();
    force_.find_gaps(member);
    team_.barrier();
  }
  force_.write_external_parts(member, displacement, moment);
}

inline void CentralDifference::note_strained(Eigen::Index node, const NodeQuad& displacement,
                                             const NodeQuad& velocity) {
  if (is_strain_damped_) put(displacement + damping_.stiffness_factor * velocity, strained_.data(), node);
}

template <class Visit>
bool CentralDifference::visit_all(int member, const double* displacement, const Moment& moment, const Visit& visit) {
  team_.barrier();
  if (member == 0) is_given_up_ = !goes_on(moment.time);  // all have read it in the substep before
  write_external_parts(member, displacement, moment);
  team_.barrier();
  force_.sweep(member, strained_at(displacement), moment, visit);
  team_.barrier();
  if (force_.inverted_element() >= 0 || is_given_up_) return false;
  force_.visit_shared(member, visit);
  return true;
}

}  // namespace couplet::solid
