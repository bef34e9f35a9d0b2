#include "solid-server/dynamics/stable_step.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "proto/report/failure.hpp"
#include "solid-server/support/symmetric_eigenvalues.hpp"

namespace couplet::solid {

namespace {

constexpr int n_steps_max = 60;
constexpr double wanted_accuracy = 0.001;       // of omega^2: half of that in the step
constexpr double relative_displacement = 1e-6;  // of the smallest length: round-off 1e-10, curvature 1e-6 of the result

/// Numbers between -1 and 1 that have nothing to do with any mode (Lehmer's generator), 0 at supports.
NodeVectors scattered(const NodeVectors& inverse_mass) {
  NodeVectors values(inverse_mass.rows(), 4);
  std::uint64_t seed = 48271;
  for (Eigen::Index n = 0; n < values.size(); ++n) {
    seed = seed * 48271 % 2147483647;
    values.data()[n] = inverse_mass.data()[n] > 0 ? 2.0 * static_cast<double>(seed) / 2147483647.0 - 1 : 0;
  }
  return values;
}

/// Goes through long vectors with a team, in pieces whose size does not depend on it.
class VectorWork {
 public:
  VectorWork(Eigen::Index n, WorkTeam& team)
      : n_(n), team_(team), result_(static_cast<std::size_t>((n + piece_size - 1) / piece_size)) {}

  /// The results of work(first, number) for each piece.
  template <class Work>
  const std::vector<double>& run(const Work& work) {
    team_.run([&](int member) {
      const auto [first, last] = share_of(static_cast<int>(result_.size()), member, team_.n_members());
      for (int piece = first; piece < last; ++piece) {
        const Eigen::Index start = piece * piece_size;
        result_[static_cast<std::size_t>(piece)] = work(start, std::min(piece_size, n_ - start));
      }
    });
    return result_;
  }
  template <class Work>
  double sum(const Work& work) {
    const auto& parts = run(work);
    return std::accumulate(parts.begin(), parts.end(), 0.0);
  }
  template <class Work>
  double largest(const Work& work) {
    const auto& parts = run(work);
    return *std::max_element(parts.begin(), parts.end());
  }

 private:
  static constexpr Eigen::Index piece_size = 4096;
  Eigen::Index n_;
  WorkTeam& team_;
  std::vector<double> result_;
};

struct RitzValue {
  double value, residual;
};

RitzValue largest_ritz_value(const std::vector<double>& diagonal, const std::vector<double>& beside) {
  const auto n = static_cast<Eigen::Index>(diagonal.size());
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(Eigen::Map<const Eigen::VectorXd>(diagonal.data(), n),
                                Eigen::Map<const Eigen::VectorXd>(beside.data(), n - 1));
  return {solver.eigenvalues()[n - 1], beside.back() * std::abs(solver.eigenvectors()(n - 1, n - 1))};
}

}  // namespace

double stable_step(const std::function<void(const NodeVectors&, NodeVectors&)>& internal_force,
                   const NodeVectors& displacement, const NodeVectors& inverse_mass, double smallest_length,
                   double extra_rate_squared, WorkTeam& team, double stiffness_damping) {
  using Vector = Eigen::Map<Eigen::ArrayXd>;
  const auto flat = [](NodeVectors& v) { return Vector(v.data(), v.size()); };
  NodeVectors force_here(displacement.rows(), 4), force(displacement.rows(), 4), near(displacement.rows(), 4);
  NodeVectors q_values = scattered(inverse_mass), other_values = NodeVectors::Zero(q_values.rows(), 4);
  internal_force(displacement, force_here);
  const Eigen::Map<const Eigen::ArrayXd> u(displacement.data(), displacement.size()),
      m(inverse_mass.data(), inverse_mass.size());
  Vector f0 = flat(force_here), f = flat(force), moved = flat(near);
  NodeVectors *q_of = &q_values, *before_of = &other_values;  // the Lanczos vectors of this step and the one before
  VectorWork work(u.size(), team);

  const double first_norm =
      std::sqrt(work.sum([&](auto i, auto n) { return flat(*q_of).segment(i, n).square().sum(); }));
  if (first_norm == 0) throw report::SceneError("solid", "no node of any body is free to move", "fix fewer surfaces");
  work.run([&](auto i, auto n) { return (flat(*q_of).segment(i, n) /= first_norm, 0.0); });

  std::vector<double> diagonal, beside;
  RitzValue largest{};
  for (int step = 0; step < n_steps_max; ++step) {
    // r = M^-1/2 K M^-1/2 q - beside q_before, in the place of q_before
    Vector q = flat(*q_of), r = flat(*before_of);
    const double size =
        work.largest([&](auto i, auto n) { return (m.segment(i, n).sqrt() * q.segment(i, n)).abs().maxCoeff(); });
    const double scale = relative_displacement * smallest_length / size;
    work.run([&](auto i, auto n) {
      return (moved.segment(i, n) = u.segment(i, n) + scale * (m.segment(i, n).sqrt() * q.segment(i, n)), 0.0);
    });
    internal_force(near, force);
    const double b = step > 0 ? beside.back() : 0;
    diagonal.push_back(work.sum([&](auto i, auto n) {
      r.segment(i, n) = m.segment(i, n).sqrt() * (f0.segment(i, n) - f.segment(i, n)) / scale - b * r.segment(i, n);
      return (r.segment(i, n) * q.segment(i, n)).sum();
    }));
    beside.push_back(std::sqrt(work.sum([&](auto i, auto n) {
      r.segment(i, n) -= diagonal.back() * q.segment(i, n);
      return r.segment(i, n).square().sum();
    })));
    largest = largest_ritz_value(diagonal, beside);
    if (!(largest.residual > wanted_accuracy * largest.value)) break;
    work.run([&](auto i, auto n) { return (r.segment(i, n) /= beside.back(), 0.0); });
    std::swap(q_of, before_of);
  }
  const double rate_squared = largest.value + largest.residual + extra_rate_squared;
  if (!std::isfinite(rate_squared) || rate_squared <= 0)
    throw report::NumericsError("stable step", "the largest eigenvalue of the body is " + std::to_string(rate_squared),
                                "the body is badly deformed: check loads and time.step");
  const double rate = std::sqrt(rate_squared), zeta = stiffness_damping * rate / 2;
  return 2 / rate *
         (std::sqrt(1 + zeta * zeta) - zeta);  // the v of the half step lags [Belytschko, Liu, Moran 2000, ch. 6]
}

}  // namespace couplet::solid
