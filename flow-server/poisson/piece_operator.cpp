#include "flow-server/poisson/piece_operator.hpp"

namespace couplet::flow {

PieceOperator::PieceOperator(const PressureProblem& problem, const PressureOperator& cells,
                             const std::vector<NamedPlace>& names)
    : rows_(cells.pieces()),
      n_pieces_(static_cast<int>(problem.split->cell.size())),
      to_ghosts_(problem.decomposition->communicator(), problem.decomposition->partitions(),
                 own_piece_names(*problem.split, names, *problem.decomposition), names) {}

double PieceOperator::volume() const {
  double sum = 0;
  for (const PieceRows::Row& row : rows_.pieces()) sum += row.volume;
  return sum;
}

std::array<double, 2> PieceOperator::moments(std::span<const double> values) const {
  double first = 0, second = 0;
  for (const PieceRows::Row& row : rows_.pieces()) {
    const double value = values[static_cast<std::size_t>(row.unknown.piece)];
    first += row.volume * value, second += row.volume * value * value;
  }
  return {first, second};
}

void PieceOperator::add_parts(std::span<const float> part, std::span<const double> values,
                              std::span<double> sums) const {
  for (const PieceRows::Row& row : rows_.pieces()) {
    const auto p = static_cast<std::size_t>(row.unknown.piece);
    if (part[p] > 0) sums[static_cast<std::size_t>(part[p]) - 1] += row.volume * (values.empty() ? 1 : values[p]);
  }
}

double PieceOperator::residual(std::span<const double> source, double mean, const Field<double>& phi,
                               std::span<const double> piece_phi, std::span<double> residual) const {
  double squares = 0;
  for (const PieceRows::Row& row : rows_.pieces()) {
    const auto p = static_cast<std::size_t>(row.unknown.piece);
    residual[p] = source[p] - mean - rows_.applied(row, phi, piece_phi);
    squares += row.volume * residual[p] * residual[p];
  }
  return squares;
}

DirectionSums PieceOperator::direction_sums(const Field<float>& z, std::span<const float> piece_z,
                                            std::span<const double> piece_r, const Field<float>& p,
                                            std::span<const float> piece_p) const {
  DirectionSums sums;
  const auto add = [&](const PieceRows::Row& row) {
    const double weighted = row.volume * PieceRows::value(row.unknown, z, piece_z);
    sums.correction_operator += weighted * rows_.applied(row, z, piece_z);
    sums.correction_conjugate += weighted * rows_.applied(row, p, piece_p);
    if (row.unknown.piece >= 0)
      sums.correction_residual += weighted * piece_r[static_cast<std::size_t>(row.unknown.piece)];
  };
  for (const PieceRows::Row& row : rows_.cells()) add(row);
  for (const PieceRows::Row& row : rows_.pieces()) add(row);
  return sums;
}

void PieceOperator::turn(std::span<const float> z, double beta, std::span<float> p) const {
  const float share_of_last = static_cast<float>(beta);
  for (std::size_t q = 0; q < p.size(); ++q) p[q] = z[q] + share_of_last * p[q];
}

double PieceOperator::advance(double alpha, const Field<float>& p, std::span<const float> piece_p,
                              std::span<double> piece_phi, std::span<double> piece_r, std::span<float> piece_f) const {
  double squares = 0;
  for (const PieceRows::Row& row : rows_.pieces()) {
    const auto q = static_cast<std::size_t>(row.unknown.piece);
    piece_phi[q] += alpha * static_cast<double>(piece_p[q]);
    piece_r[q] -= alpha * rows_.applied(row, p, piece_p);
    piece_f[q] = static_cast<float>(piece_r[q]);
    squares += row.volume * piece_r[q] * piece_r[q];
  }
  return squares;
}

}  // namespace couplet::flow
