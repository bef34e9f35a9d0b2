#pragma once
// div grad in double precision on the cells of one rank, and the volume-weighted sums that go with it.

#include <array>
#include <vector>

#include "flow-server/grid/active_cells.hpp"
#include "flow-server/poisson/coarsening.hpp"
#include "flow-server/poisson/piece_rows.hpp"
#include "flow-server/poisson/pressure_solver.hpp"

namespace couplet::flow {

/// Sums over the cells of this rank.
struct DirectionSums {
  double correction_residual = 0;   // <z, r>
  double correction_operator = 0;   // <z, A z>
  double correction_conjugate = 0;  // <z, A p>

  DirectionSums& operator+=(const DirectionSums& other) {
    correction_residual += other.correction_residual;
    correction_operator += other.correction_operator;
    correction_conjugate += other.correction_conjugate;
    return *this;
  }
};

/// A phi = div grad phi. Ghosts of phi beyond a border of the whole must be 0; ghosts at neighbours filled. Where cells
/// are split, the arguments called piece_... hold the values of the further pieces, those of ghosts filled as well.
class PressureOperator {
 public:
  explicit PressureOperator(const PressureProblem& problem);

  /// Shares of the problem have changed at faces of cells within the given boxes (local indices), or split cells.
  void update(const PressureProblem& problem, std::span<const Box> changed);

  const ActiveCells& active() const { return active_; }
  const PieceRows& pieces() const { return pieces_; }  // rows of the cells of this rank; empty where none is split
  bool has_open_border() const;                        // of the whole, at a cell of this rank
  double volume() const { return volume_; }            // of the active cells of this rank [m^3]

  /// Sum of volume * value, and of volume * value^2.
  std::array<double, 2> moments(const Field<double>& values) const;
  /// residual = source - mean - A phi; returns the sum of volume * residual^2.
  double residual(const Field<double>& source, double mean, const Field<double>& phi, Field<double>* residual,
                  std::span<const double> piece_phi = {}) const;
  /// Sums of which the next direction is made. `z` and `p` with one filled ghost layer.
  DirectionSums direction_sums(const Field<float>& z, const Field<double>& r, const Field<float>& p) const;
  /// p = z + beta p (one ghost layer too), phi += alpha p, r -= alpha A p, f = r; returns the sum of volume * r^2.
  double advance(const Field<float>& z, double beta, double alpha, Field<float>& p, Field<double>& phi,
                 Field<double>& r, Field<float>& f, std::span<const float> piece_p = {}) const;
  void subtract(double value, Field<double>& phi) const;
  void subtract_to(const Field<double>& values, double value, Field<double>& difference) const;
  void add(const Field<double>& correction, Field<double>& phi) const;
  template <class Number>
  void copy(const Field<Number>& from, Field<float>& to) const;
  /// Sums over parts of volume * value (none: 1); `part`: from 1 on, what is below belongs to none.
  void add_parts(const Field<float>& part, const Field<double>* values, std::span<double> sums) const;
  void subtract_parts(const Field<float>& part, std::span<const double> means, Field<double>& values) const;

 private:
  bool is_open(const Triple& cell) const;
  void sum_volume();
  struct RowOperator;
  template <bool has_share>
  RowOperator row_operator(int j, int k) const;
  template <bool has_share>
  double residual_of(const Field<double>& source, double mean, const Field<double>& phi, Field<double>* residual,
                     std::span<const double> piece_phi) const;
  template <bool has_share>
  DirectionSums direction_sums_of(const Field<float>& z, const Field<double>& r, const Field<float>& p) const;
  template <bool has_share>
  double advance_of(const Field<float>& z, double beta, double alpha, Field<float>& p, Field<double>& phi,
                    Field<double>& r, Field<float>& f, std::span<const float> piece_p) const;

  Triple sizes_, layer_;  // cells; 1 in directions with terms, else 0
  std::array<LevelAxis, 3> axes_;
  std::array<std::vector<double>, 3> lower_, upper_, width_;  // (n) of the cells of this rank
  std::vector<double> width_before_;                          // (n + 1) along x, of the cells before each one
  const FaceFractions* share_ = nullptr;                      // of the problem
  PieceRows pieces_;
  ActiveCells active_;
  std::array<std::array<bool, 2>, 3> is_at_border_{};
  std::array<std::array<bool, 2>, 3> has_open_side_{};  // where borders are whole
  double volume_ = 0;
};

}  // namespace couplet::flow
