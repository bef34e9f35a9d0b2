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

/// Modes that are known: their shapes and momenta M phi, with phi^T M phi = 1.
struct KnownModes {
  std::vector<Eigen::VectorXd> shape, momentum;
};

/// (K - shift M)^-1 for Spectra, on what is left beside the known modes; the solver has factorised the matrix.
class ShiftInverse {
 public:
  using Scalar = double;
  ShiftInverse(const TangentSolver& solver, const FreeVectors& vectors, const KnownModes& known)
      : solver_(solver), vectors_(vectors), known_(known) {}
  Eigen::Index rows() const { return vectors_.size(); }
  Eigen::Index cols() const { return vectors_.size(); }
  void set_shift(double) {}
  void perform_op(const double* in, double* out) const {
    vectors_.from_nodes(solver_.solve(vectors_.at_nodes(in)), out);
    Eigen::Map<Eigen::VectorXd> x(out, rows());
    for (std::size_t n = 0; n < known_.shape.size(); ++n) x -= known_.momentum[n].dot(x) * known_.shape[n];
  }

 private:
  const TangentSolver& solver_;
  const FreeVectors& vectors_;
  const KnownModes& known_;
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

/// A shift below all eigenvalues, factorised: a small part of the highest ones; more when the body is not stable, or so
/// soft in some motion that the matrix is nearly singular.
double factorise_below_all(TangentSolver& solver, const NodeVectors& displacement) {
  constexpr double smallest_part = 1e-10;  // above round-off, below the lowest mode of any body that is not a string
  const double scale = std::abs(high_eigenvalue(solver, displacement));
  for (double part = smallest_part;; part *= 10) {
    const bool is_last = part > 0.1;
    try {
      factorise_shifted(solver, displacement, -part * scale);
      if (solver.n_negative_pivots() == 0) return -part * scale;
    } catch (const report::NumericsError&) {
      if (is_last) throw;
    }
    if (is_last)
      throw report::NumericsError("modes", "the stiffness has eigenvalues below " + report::text(-scale) + " 1/s^2",
                                  "the body is far from stable at the displacement given");
  }
}

struct EigenPairs {
  Eigen::VectorXd value;  // rising
  Eigen::MatrixXd vector;
};

/// Beside the known modes; the factors of the solver are those of the shift. The iteration starts from a vector that is
/// like no mode, another one for each seed.
EigenPairs lowest_pairs(const TangentSolver& solver, const FreeVectors& vectors, const KnownModes& known, double shift,
                        int n_pairs, double tolerance, unsigned seed) {
  constexpr int n_restarts_max = 300;
  const auto n_vectors = static_cast<int>(std::min<Eigen::Index>(vectors.size(), 2 * n_pairs + 18));
  ShiftInverse inverse(solver, vectors, known);
  MassProduct mass(solver, vectors);
  Spectra::SymGEigsShiftSolver<ShiftInverse, MassProduct, Spectra::GEigsMode::ShiftInvert> lanczos(
      inverse, mass, n_pairs, n_vectors, shift);
  Eigen::VectorXd start(vectors.size());
  for (double& entry : start) {
    seed = seed * 1664525u + 1013904223u;  // Lehmer's generator with an increment [Knuth 1998, 3.2]
    entry = static_cast<double>(seed >> 8) / 16777216.0 - 0.5;
  }
  lanczos.init(start.data());
  const auto n_found =
      lanczos.compute(Spectra::SortRule::LargestAlge, n_restarts_max, tolerance, Spectra::SortRule::SmallestAlge);
  if (n_found < n_pairs || lanczos.info() != Spectra::CompInfo::Successful)
    throw report::NumericsError(
        "modes", "only " + std::to_string(n_found) + " of " + std::to_string(n_pairs) + " modes have converged",
        "ask for a few modes more or fewer");
  return {lanczos.eigenvalues(), lanczos.eigenvectors()};
}

void add_known(const TangentSolver& solver, const FreeVectors& vectors, const Eigen::VectorXd& shape,
               KnownModes& known) {
  Eigen::VectorXd momentum(shape.size());
  vectors.from_nodes(solver.mass_times(vectors.at_nodes(shape.data())), momentum.data());
  const double norm = std::sqrt(shape.dot(momentum));
  known.shape.push_back(shape / norm);
  known.momentum.push_back(momentum / norm);
}

Mode make_mode(const TangentSolver& solver, double eigenvalue, double shift, NodeVectors shape) {
  const auto norm_squared = [&](const NodeVectors& of) { return of.cwiseProduct(solver.mass_times(of)).sum(); };
  shape /= std::sqrt(norm_squared(shape));
  Eigen::Index row = 0, column = 0;
  shape.cwiseAbs().maxCoeff(&row, &column);
  if (shape(row, column) < 0) shape = -shape;

  Mode mode;
  // Round-off of K phi is some 1e-16 of the highest eigenvalues, of which the shift is 1e-10 or more.
  if (std::abs(eigenvalue) <= 1e-5 * std::abs(shift)) eigenvalue = 0;
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
  const double shift = factorise_below_all(solver, displacement);
  constexpr double tolerance = 1e-11, tolerance_of_check = 1e-6;  // of 1/(lambda - shift)
  KnownModes known;
  const EigenPairs first = lowest_pairs(solver, vectors, known, shift, n_modes, tolerance, 1);
  std::vector<std::pair<double, std::size_t>> found;  // eigenvalues and places among the known modes
  const auto keep = [&](double eigenvalue, const Eigen::VectorXd& shape) {
    add_known(solver, vectors, shape, known);
    found.emplace_back(eigenvalue, known.shape.size() - 1);
    std::sort(found.begin(), found.end());
  };
  for (int n = 0; n < n_modes; ++n) keep(first.value[n], first.vector.col(n));
  // One start vector may miss copies of equal eigenvalues: what is the lowest of those that are left?
  const auto n_wanted = static_cast<std::size_t>(n_modes);
  for (unsigned seed = 2; known.shape.size() < static_cast<std::size_t>(vectors.size()) - 1; ++seed) {
    const double highest = found[n_wanted - 1].first;
    const EigenPairs left = lowest_pairs(solver, vectors, known, shift, 1, tolerance_of_check, seed);
    if (!(left.value[0] - shift < (1 - 1e-5) * (highest - shift))) break;
    const EigenPairs missed = lowest_pairs(solver, vectors, known, shift, 1, tolerance, seed);
    keep(missed.value[0], missed.vector.col(0));
  }
  std::vector<Mode> modes;
  for (std::size_t n = 0; n < n_wanted; ++n)
    modes.push_back(make_mode(solver, found[n].first, shift, vectors.at_nodes(known.shape[found[n].second].data())));
  return modes;
}

}  // namespace couplet::solid
