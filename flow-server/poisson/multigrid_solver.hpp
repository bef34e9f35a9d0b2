#pragma once
// Conjugate gradients in double precision around the multigrid in single precision.

#include "flow-server/grid/halo_exchange.hpp"
#include "flow-server/poisson/multigrid.hpp"
#include "flow-server/poisson/piece_operator.hpp"
#include "flow-server/poisson/pressure_operator.hpp"
#include "flow-server/poisson/pressure_solver.hpp"

namespace couplet::flow {

/// Flexible conjugate gradients (Polak-Ribiere): Y. Notay, "Flexible conjugate gradients", SIAM J. Sci. Comput. 22
/// (2000). Two reductions an iteration.
class MultigridSolver : public PressureSolver {
 public:
  /// Collective. The problem must outlive this.
  explicit MultigridSolver(const PressureProblem& problem);

  SolveReport solve(const Field<double>& source, Field<double>& phi, const SolveLimits& limits,
                    std::span<const double> piece_source, std::span<double> piece_phi) override;
  void update(std::span<const Box> changed) override;
  std::size_t n_bytes() const override;
  Traffic traffic() const override;

 private:
  template <std::size_t n>
  std::array<double, n> sum_over_ranks(std::array<double, n> sums);
  void sum_over_ranks(std::vector<double>& sums);

  void make_solver();
  void find_parts();
  /// Takes the mean over each sealed part out of the values; returns the largest integral that was taken out.
  double remove_means(Field<double>& values, std::span<double> piece_values);

  /// What the pieces of split cells have beside the fields.
  struct Pieces {
    std::vector<double> source, phi, residual;  // (n_pieces) each
    std::vector<float> direction;
  };

  const PressureProblem& problem_;
  const BlockDecomposition* decomposition_;
  std::unique_ptr<PressureOperator> operator_;
  std::unique_ptr<PieceOperator> piece_operator_;  // where cells are split
  std::unique_ptr<Multigrid> multigrid_;
  Pieces pieces_;
  HaloExchange halo_;
  Field<double> residual_;
  Field<float> direction_;
  bool is_singular_ = false;  // one part, sealed
  /// Where only some parts of the fluid are sealed, or several: their number for each unknown, from 1 on; -1: not
  /// sealed.
  int n_sealed_ = 0;
  Field<float> part_;
  std::vector<float> piece_part_;
  std::vector<double> part_volume_;  // (n_sealed) [m^3]
  Field<double> balanced_source_;
  double volume_ = 0;                  // of all active cells [m^3]
  Traffic reductions_, last_traffic_;  // of sums; of what update() has replaced
};

}  // namespace couplet::flow
