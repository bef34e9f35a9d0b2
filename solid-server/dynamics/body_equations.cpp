#include "solid-server/dynamics/body_equations.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

#include "proto/report/failure.hpp"
#include "solid-server/assembly/minimal_residual.hpp"

namespace couplet::solid {

BodyEquations::BodyEquations(const SolidMesh& mesh, const std::vector<BlockProperties>& properties,
                             const FreeComponents& free, HeldMotion held, NodalForce& force, WorkTeam& team)
    : mesh_(mesh),
      force_(force),
      team_(team),
      held_(std::move(held)),
      is_free_(NodeVectors::Zero(mesh.n_nodes(), 4)),
      length_((mesh.node_position.colwise().maxCoeff() - mesh.node_position.colwise().minCoeff()).maxCoeff()),
      tangent_(std::make_unique<TangentSolver>(mesh, properties, free, team)) {
  is_free_.leftCols<3>() = free.cast<double>().matrix();
}

Index BodyEquations::forces(const NodeVectors& strained, const NodeVectors& displacement, const Moment& moment,
                            NodeVectors& out) {
  out.resize(displacement.rows(), 4);
  force_.forget_findings();
  double* const force = out.data();
  const auto keep = [force](Index node, const NodeQuad& sum) { std::memcpy(force + 4 * node, &sum, sizeof sum); };
  team_.run([&](int member) {
    if (force_.has_surface_contact()) {
      if (member == 0) force_.search_contact(displacement.data());
      team_.barrier();
      force_.find_gaps(member);
      team_.barrier();
    }
    force_.write_external_parts(member, displacement.data(), moment);
    team_.barrier();
    force_.sweep(member, strained.data(), moment, keep);
    team_.barrier();
    force_.visit_shared(member, keep);
  });
  return force_.inverted_element();
}

double BodyEquations::external_size(const NodeVectors& displacement, const Moment& moment) {
  return free_part(force_.all(displacement, moment) - force_.internal_only(displacement)).norm();
}

Index BodyEquations::factorise(std::shared_ptr<const FactorOrigin> origin) {
  if (origin == origin_) return -1;
  origin_.reset();
  const NodeVectors* const increment = origin->increment.rows() > 0 ? &origin->increment : nullptr;
  if (const Index inverted = tangent_->assemble(origin->strained, origin->weights, increment); inverted >= 0)
    return inverted;
  skew_.clear();
  if (const double weight = origin->external_stiffness; weight != 0)
    force_.external().add_stiffness(
        origin->displacement, origin->time,
        [&](Index a, Index b, const Eigen::Matrix3d& block) { tangent_->add(a, b, weight * block); },
        [&](Index a, Index b, const Eigen::Matrix3d& block) { skew_.add(a, b, weight * block); });
  skew_.complete(tangent_->free());
  tangent_->factorise();
  origin_ = std::move(origin);
  return -1;
}

NodeVectors BodyEquations::solve_unsymmetric(const NodeVectors& rhs) const {
  if (skew_.is_zero()) return solve(rhs);
  constexpr double tolerance = 1e-6;  // far below what an iteration of Newton's method gains
  constexpr int n_products_most = 40;
  const auto multiply = [this](const NodeVectors& vector) {
    NodeVectors product = tangent_->multiply(vector);
    skew_.add_product(vector, product);
    return product;
  };
  return minimal_residual(
      multiply, [this](const NodeVectors& vector) { return solve(vector); }, rhs, tolerance, n_products_most);
}

double BodyEquations::factorisation_cost() const {
  constexpr double cost_known = 20, n_free_known = 38000;
  return std::clamp(cost_known * std::sqrt(tangent_->n_free() / n_free_known), 2.0, 200.0);
}

/// The lowest mode by inverse iteration [Golub, Van Loan 2013, 8.2], from the displacement under a uniform acceleration
/// in all directions.
ImplicitCost BodyEquations::measure(const Motion& motion, double duration) {
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point began) {
    return std::chrono::duration<double>(Clock::now() - began).count();
  };
  constexpr int n_repetitions = 3, n_iterations = 12;
  const NodeVectors& u = motion.displacement;
  const double shift = std::pow(2 * std::numbers::pi / (100 * duration), 2);  // so that free bodies have factors too
  ImplicitCost cost;
  auto began = Clock::now();
  factorise(std::make_shared<const FactorOrigin>(FactorOrigin{u, u, NodeVectors(0, 4), motion.time, {1, shift}, 0}));
  cost.factorisation_seconds = since(began);

  NodeVectors force;
  cost.iteration_seconds = std::numeric_limits<double>::max();
  for (int n = 0; n < n_repetitions; ++n) {
    began = Clock::now();
    forces(u, u, {motion.time + duration, 1, false}, force);
    solve(force);
    cost.iteration_seconds = std::min(cost.iteration_seconds, since(began));
  }
  NodeVectors mode = free_part(NodeVectors::Ones(u.rows(), 4));
  double eigenvalue = 0;  // of (K + shift M) x = eigenvalue M x
  for (int n = 0; n < n_iterations; ++n) {
    const NodeVectors push = mass_times(mode), next = free_part(solve(push));
    eigenvalue = next.cwiseProduct(push).sum() / next.cwiseProduct(mass_times(next)).sum();
    mode = next / next.norm();
  }
  cost.lowest_rate = std::sqrt(std::max(eigenvalue - shift, 0.0));
  forget_factors();
  return cost;
}

double BodyEquations::least_factorisation_seconds() const {
  constexpr double operations_per_second = 5e10;  // no core is much faster
  return tangent_->n_operations() / operations_per_second;
}

std::size_t BodyEquations::memory_bytes() const {
  return tangent_->memory_bytes() +
         static_cast<std::size_t>(is_free_.size()) * sizeof(double) * 4;  // with the three arrays of the origin
}

}  // namespace couplet::solid
