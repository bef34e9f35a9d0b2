#pragma once
// The rows of further pieces in double precision: what PressureOperator does for cells.

#include <span>
#include <vector>

#include "flow-server/poisson/piece_exchange.hpp"
#include "flow-server/poisson/pressure_operator.hpp"
#include "flow-server/poisson/split_links.hpp"

namespace couplet::flow {

/// Values of pieces stand in the order of the list of the problem. Those of ghosts are filled by exchange().
class PieceOperator {
 public:
  /// Collective. Both must outlive this, the problem as it is.
  PieceOperator(const PressureProblem& problem, const PressureOperator& cells)
      : PieceOperator(problem, cells,
                      piece_names(*problem.split, piece_numbers(*problem.split), *problem.decomposition)) {}

  int n_pieces() const { return n_pieces_; }  // ghosts included
  double volume() const;                      // of the cells of the pieces of this rank

  /// Collective. Ghosts from their owners.
  template <class Number>
  void exchange(std::vector<Number>& values) {
    to_ghosts_.move(values.data(), values.data());
  }
  /// Sum of volume * value and of volume * value^2.
  std::array<double, 2> moments(std::span<const double> values) const;
  /// Sums over parts of volume * value (none: 1); `part`: from 1 on, what is below belongs to none.
  void add_parts(std::span<const float> part, std::span<const double> values, std::span<double> sums) const;
  /// residual = source - mean - A phi; returns the sum of volume * residual^2.
  double residual(std::span<const double> source, double mean, const Field<double>& phi,
                  std::span<const double> piece_phi, std::span<double> residual) const;
  /// What links and pieces add to the sums over cells.
  DirectionSums direction_sums(const Field<float>& z, std::span<const float> piece_z, std::span<const double> piece_r,
                               const Field<float>& p, std::span<const float> piece_p) const;
  /// p = z + beta p, ghosts too.
  void turn(std::span<const float> z, double beta, std::span<float> p) const;
  /// phi += alpha p, r -= alpha A p, f = r; returns the sum of volume * r^2. p of cells and pieces as turned.
  double advance(double alpha, const Field<float>& p, std::span<const float> piece_p, std::span<double> piece_phi,
                 std::span<double> piece_r, std::span<float> piece_f) const;

  const Traffic& traffic() const { return to_ghosts_.traffic(); }

 private:
  PieceOperator(const PressureProblem& problem, const PressureOperator& cells, const std::vector<NamedPlace>& names);

  const PieceRows& rows_;
  int n_pieces_;
  PieceExchange to_ghosts_;
};

}  // namespace couplet::flow
