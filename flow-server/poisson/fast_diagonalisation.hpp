#pragma once
// Direct solves by the eigenvectors of the one-dimensional operators.

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "flow-server/grid/halo_exchange.hpp"
#include "flow-server/grid/redistribution.hpp"
#include "flow-server/poisson/coarsening.hpp"
#include "flow-server/poisson/pressure_operator.hpp"
#include "flow-server/poisson/pressure_solver.hpp"

namespace couplet::flow {

/// On a box whose borders are whole, div grad is a sum of three one-dimensional operators: R. E. Lynch, J. R. Rice, D.
/// H. Thomas, "Direct solution of partial difference equations by tensor product methods", Numer. Math. 6 (1964).
/// Products with the eigenvectors of x and y leave a tridiagonal system along z for each pair of them; where z is
/// periodic its eigenvectors are used as well. Ranks share planes for the products in x and y and lines for the rest;
/// what belongs to one cell is computed by the same arithmetic on any number of ranks.
class FastDiagonalisation : public PressureSolver {
 public:
  /// Throws SceneError when the problem has open shares. Collective.
  explicit FastDiagonalisation(const PressureProblem& problem);

  SolveReport solve(const Field<double>& source, Field<double>& phi, const SolveLimits& limits,
                    std::span<const double> piece_source, std::span<double> piece_phi) override;
  void update(std::span<const Box>) override {}  // has no shares
  std::size_t n_bytes() const override;
  Traffic traffic() const override;

 private:
  /// A = to_values diag(eigenvalue) from_values for the one-dimensional operator A.
  struct Spectrum {
    Eigen::MatrixXd from_values, to_values;  // (n, n)
    Eigen::VectorXd eigenvalue;              // (n) rising, none positive [1/m^2]
  };
  static Spectrum spectrum_of(const LevelAxis& axis);
  void transform_planes(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y);
  bool holds_constant(int j) const;  // as its last value
  void solve_tridiagonal(int j);
  void solve_by_spectrum(int j);
  /// right_hand_side_ becomes the solution.
  void apply_inverse();
  std::array<double, 2> sum_over_ranks(std::array<double, 2> sums);
  Field<double>& lines() { return planes_to_lines_ ? lines_ : planes_; }

  const BlockDecomposition* decomposition_;
  PressureOperator operator_;
  std::array<LevelAxis, 3> axes_;
  int last_;  // direction of the tridiagonal systems: z, in two dimensions y
  HaloExchange halo_;
  bool is_singular_ = false;
  double volume_ = 0;            // of all cells [m^3]
  Spectrum x_, y_, along_last_;  // y_ in three dimensions; the last where it is periodic
  Box planes_box_, lines_box_;   // of this rank: whole in all directions but the last; but the one before
  std::unique_ptr<Redistribution> to_planes_, planes_to_lines_, lines_to_planes_, from_planes_;  // none: one rank
  Field<double> planes_, lines_;
  Field<double> right_hand_side_;  // on the blocks of the problem
  Eigen::MatrixXd product_;
  std::vector<double> eliminated_;  // (nx, n of the last direction)
  Traffic reductions_;
};

/// Is a direct solve expected to be faster than the multigrid to a residual of 1e-3?
bool prefers_fast_diagonalisation(const PressureProblem& problem);

}  // namespace couplet::flow
