#include "solid-server/modal/modal_analysis.hpp"

#include <Spectra/SymGEigsShiftSolver.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "proto/report/failure.hpp"

namespace couplet::solid {

namespace {

/// Vectors of free components, as Spectra wants them, and of nodes.
class FreeVectors {
 public:
  explicit FreeVectors(const TangentSolver& solver) {
    for (Eigen::Index n = 0; n < solver.free().rows(); ++n)
      for (Eigen::Index i = 0; i < 3; ++i)
        if (solver.free()(n, i)) place_.push_back(4 * n + i);
    n_nodes_ = solver.free().rows();
  }

  Eigen::Index size() const { return static_cast<Eigen::Index>(place_.size()); }

  NodeVectors at_nodes(const double* values) const {
    NodeVectors vectors = NodeVectors::Zero(n_nodes_, 4);
    for (std::size_t n = 0; n < place_.size(); ++n) vectors.data()[place_[n]] = values[n];
    return vectors;
  }
  void from_nodes(const NodeVectors& vectors, double* values) const {
    for (std::size_t n = 0; n < place_.size(); ++n) values[n] = vectors.data()[place_[n]];
  }

 private:
  std::vector<Eigen::Index> place_;
  Eigen::Index n_nodes_ = 0;
};

/// (K - shift M)^-1 for Spectra; the solver has factorised it.
class ShiftInverse {
 public:
  using Scalar = double;
  ShiftInverse(const TangentSolver& solver, const FreeVectors& vectors) : solver_(solver), vectors_(vectors) {}
  Eigen::Index rows() const { return vectors_.size(); }
  Eigen::Index cols() const { return vectors_.size(); }
  void set_shift(double) {}
  void perform_op(const double* in, double* out) const {
    vectors_.from_nodes(solver_.solve(vectors_.at_nodes(in)), out);
  }

 private:
  const TangentSolver& solver_;
  const FreeVectors& vectors_;
};

class MassProduct {
 public:
  using Scalar = double;
  MassProduct(const TangentSolver& solver, const FreeVectors& vectors) : solver_(solver), vectors_(vectors) {}
  Eigen::Index rows() const { return vectors_.size(); }
  Eigen::Index cols() const { return vectors_.size(); }
  void perform_op(const double* in, double* out) const {
    vectors_.from_nodes(solver_.mass_times(vectors_.at_nodes(in)), out);
  }

 private:
  const TangentSolver& solver_;
  const FreeVectors& vectors_;
};

void factorise_shifted(TangentSolver& solver, const NodeVectors& displacement, double shift) {
  solver.assemble(displacement, {1, -shift});
  solver.factorise();
}

/// An eigenvalue somewhere in the upper half of the spectrum: the Rayleigh quotient of a vector that is like no mode.
double high_eigenvalue(TangentSolver& solver, const NodeVectors& displacement) {
  if (solver.assemble(displacement, {1, 0}) >= 0)
    throw report::NumericsError("modes", "the body is turned inside out at the displacement given",
                                "choose one that it can have");
  NodeVectors vector = NodeVectors::Zero(displacement.rows(), 4);
  for (Eigen::Index n = 0; n < vector.rows(); ++n)
    for (Eigen::Index i = 0; i < 3; ++i)
      if (solver.free()(n, i)) vector(n, i) = (n * 3 + i) * 37 % 11 < 5 ? -1 : 1;
  return vector.cwiseProduct(solver.multiply(vector)).sum() / vector.cwiseProduct(solver.mass_times(vector)).sum();
}

/// A shift below all eigenvalues, factorised: a small part of the highest ones, more when the body is not stable.
double factorise_below_all(TangentSolver& solver, const NodeVectors& displacement) {
  constexpr double smallest_part = 1e-10;  // above round-off, below the lowest mode of any body that is not a string
  const double scale = std::abs(high_eigenvalue(solver, displacement));
  for (double part = smallest_part; part <= 1; part *= 10) {
    factorise_shifted(solver, displacement, -part * scale);
    if (solver.n_negative_pivots() == 0) return -part * scale;
  }
  throw report::NumericsError("modes", "the stiffness has eigenvalues below " + report::text(-scale) + " 1/s^2",
                              "the body is far from stable at the displacement given");
}

struct EigenPairs {
  Eigen::VectorXd value;  // rising
  Eigen::MatrixXd vector;
};

/// The factors of the solver are those of the shift.
EigenPairs lowest_pairs(const TangentSolver& solver, const FreeVectors& vectors, double shift, int n_pairs,
                        int n_vectors) {
  constexpr double tolerance = 1e-11;  // of 1/(lambda - shift)
  constexpr int n_restarts_max = 300;
  ShiftInverse inverse(solver, vectors);
  MassProduct mass(solver, vectors);
  Spectra::SymGEigsShiftSolver<ShiftInverse, MassProduct, Spectra::GEigsMode::ShiftInvert> lanczos(
      inverse, mass, n_pairs, n_vectors, shift);
  lanczos.init();
  const auto n_found =
      lanczos.compute(Spectra::SortRule::LargestAlge, n_restarts_max, tolerance, Spectra::SortRule::SmallestAlge);
  if (n_found < n_pairs || lanczos.info() != Spectra::CompInfo::Successful)
    throw report::NumericsError(
        "modes", "only " + std::to_string(n_found) + " of " + std::to_string(n_pairs) + " modes have converged",
        "ask for a few modes more or fewer");
  return {lanczos.eigenvalues(), lanczos.eigenvectors()};
}

Mode make_mode(const TangentSolver& solver, double eigenvalue, double shift, NodeVectors shape) {
  const auto norm_squared = [&](const NodeVectors& of) { return of.cwiseProduct(solver.mass_times(of)).sum(); };
  shape /= std::sqrt(norm_squared(shape));
  Eigen::Index row = 0, column = 0;
  shape.cwiseAbs().maxCoeff(&row, &column);
  if (shape(row, column) < 0) shape = -shape;

  Mode mode;
  mode.eigenvalue = eigenvalue;
  mode.frequency = std::copysign(std::sqrt(std::abs(eigenvalue)) / (2 * std::numbers::pi), eigenvalue);
  const NodeVectors momentum = solver.mass_times(shape), force = solver.multiply(shape);  // the latter shifted
  for (int i = 0; i < 3; ++i) mode.direction_share[static_cast<std::size_t>(i)] = shape.col(i).dot(momentum.col(i));
  mode.residual = (force - (eigenvalue - shift) * momentum).norm() / force.norm();
  mode.shape = std::move(shape);
  return mode;
}

}  // namespace

std::vector<Mode> modal_analysis(TangentSolver& solver, const NodeVectors& displacement, int n_modes) {
  const FreeVectors vectors(solver);
  if (n_modes < 1 || n_modes >= vectors.size())
    throw report::SceneError("modes",
                             "cannot find " + std::to_string(n_modes) + " modes of a body with " +
                                 std::to_string(vectors.size()) + " free components",
                             "choose a number between 1 and " + std::to_string(vectors.size() - 1));
  constexpr int n_attempts_max = 4;
  int n_pairs = n_modes, extra_vectors = 20;
  for (int attempt = 0; attempt < n_attempts_max; ++attempt, extra_vectors *= 2) {
    const double shift = factorise_below_all(solver, displacement);
    const auto n_vectors = static_cast<int>(std::min<Eigen::Index>(vectors.size(), 2 * n_pairs + extra_vectors));
    const EigenPairs pairs = lowest_pairs(solver, vectors, shift, n_pairs, n_vectors);
    std::vector<Mode> modes;
    for (int n = 0; n < n_modes; ++n)
      modes.push_back(make_mode(solver, pairs.value[n], shift, vectors.at_nodes(pairs.vector.col(n).data())));

    // A little above the last pair. Equal eigenvalues may end up on both sides of n_pairs: then one more is looked for.
    const double last = pairs.value[n_pairs - 1];
    factorise_shifted(solver, displacement, last + 1e-6 * (last - shift));
    const int n_below = solver.n_negative_pivots();
    if (n_below == n_pairs) return modes;
    n_pairs = std::min(std::max(n_below, n_modes), static_cast<int>(vectors.size()) - 1);
  }
  throw report::NumericsError("modes", "some of the lowest " + std::to_string(n_modes) + " modes were not found",
                              "ask for a few modes more or fewer");
}

}  // namespace couplet::solid
