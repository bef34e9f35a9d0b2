#include "flow-server/poisson/coarsest_solve.hpp"

#include <array>
#include <map>

namespace couplet::flow {

CoarsestSolve::CoarsestSolve(const MultigridLevel& level) {
  const Box box = level.decomposition().mine();
  const auto& axes = level.axes();
  std::vector<int> number(static_cast<std::size_t>(box.n_cells()), -1);
  const auto at = [&](const Triple& c) -> int& {
    return number[static_cast<std::size_t>(c[0] + box.size(0) * (c[1] + box.size(1) * c[2]))];
  };
  std::vector<double> volumes;
  for (int k = 0; k < box.size(2); ++k)
    for (int j = 0; j < box.size(1); ++j)
      for (int i = 0; i < box.size(0); ++i) {
        if (!level.active().contains(i, j, k)) continue;
        at({i, j, k}) = static_cast<int>(cells_.size());
        cells_.push_back({i, j, k});
        volumes.push_back(axes[0].width[i] * axes[1].width[j] * axes[2].width[k]);
      }
  std::map<UnknownName, int> row_of_piece;
  std::vector<UnknownName> piece_name;
  if (level.pieces()) {
    for (const NamedPlace& one : level.pieces()->own_names()) {
      row_of_piece[one.name] = static_cast<int>(cells_.size() + pieces_.size());
      const Triple& c = level.pieces()->cell_of(one.place);
      volumes.push_back(axes[0].width[c[0]] * axes[1].width[c[1]] * axes[2].width[c[2]]);
      pieces_.push_back(one.place);
    }
    for (const NamedPlace& one : level.pieces()->names()) piece_name.push_back(one.name);
  }
  const int n = static_cast<int>(volumes.size());
  volume_ = Eigen::Map<const Eigen::VectorXd>(volumes.data(), n);

  // - volume * (div grad): symmetric and positive.
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<std::vector<int>> joined(static_cast<std::size_t>(n));
  std::vector<bool> is_open(static_cast<std::size_t>(n), false);
  for (int row = 0; row < static_cast<int>(cells_.size()); ++row) {
    const Triple cell{cells_[row].i, cells_[row].j, cells_[row].k};
    for (int d = 0; d < 3; ++d)
      for (const int side : {-1, 1}) {
        Triple other = cell, face = cell;
        other[d] += side;
        if (side < 0) --face[d];
        double coefficient = side < 0 ? axes[d].lower(cell[d]) : axes[d].upper(cell[d]);
        if (coefficient == 0) continue;
        if (level.has_shares()) coefficient *= level.share()[d](face[0], face[1], face[2]);
        if (coefficient == 0) continue;
        entries.emplace_back(row, row, volume_[row] * coefficient);
        const bool is_beyond = other[d] < 0 || other[d] >= box.size(d);
        if (is_beyond && !axes[d].is_periodic) {
          is_open[row] = true;
          continue;
        }
        other[d] = (other[d] + box.size(d)) % box.size(d);
        entries.emplace_back(row, at(other), -volume_[row] * coefficient);
        joined[row].push_back(at(other));
      }
  }
  if (level.pieces()) {
    const PieceRows& rows = level.pieces()->rows();
    const auto add = [&](const PieceRows::Row& row) {
      if (!box_of(box.sizes()).contains(row.unknown.cell)) return;
      const int from = row.unknown.piece < 0 ? at(row.unknown.cell) : row_of_piece.at(piece_name[row.unknown.piece]);
      for (const PieceRows::Entry& entry : rows.entries(row)) {
        Triple other = entry.other.cell;
        bool is_beyond = false;
        for (int d = 0; d < 3; ++d) {
          is_beyond = is_beyond || (!axes[d].is_periodic && (other[d] < 0 || other[d] >= box.size(d)));
          other[d] = (other[d] + box.size(d)) % box.size(d);
        }
        entries.emplace_back(from, from, row.volume * entry.coefficient);
        if (is_beyond) {
          is_open[from] = true;
          continue;
        }
        const int to = entry.other.piece < 0 ? at(other) : row_of_piece.at(piece_name[entry.other.piece]);
        entries.emplace_back(from, to, -row.volume * entry.coefficient);
        joined[from].push_back(to);
      }
    };
    for (const PieceRows::Row& row : rows.cells()) add(row);
    for (const PieceRows::Row& row : rows.pieces()) add(row);
  }
  part_.assign(static_cast<std::size_t>(n), -1);
  for (int seed = 0; seed < n; ++seed) {
    if (part_[seed] >= 0) continue;
    const int part = static_cast<int>(part_is_open_.size());
    part_is_open_.push_back(false);
    std::vector<int> open_ends{seed};
    part_[seed] = part;
    while (!open_ends.empty()) {
      const int cell = open_ends.back();
      open_ends.pop_back();
      if (is_open[cell]) part_is_open_[part] = true;
      for (const int other : joined[cell])
        if (part_[other] < 0) part_[other] = part, open_ends.push_back(other);
    }
    // A value for the seed makes a closed part regular; with a right-hand side of mean 0 the solution is exact.
    if (!part_is_open_[part]) {
      double diagonal = 0;
      for (const auto& entry : entries)
        if (entry.row() == seed && entry.col() == seed) diagonal += entry.value();
      entries.emplace_back(seed, seed, diagonal > 0 ? diagonal : 1.0);
    }
  }
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  factors_.compute(matrix);
}

void CoarsestSolve::remove_means(Eigen::VectorXd& values) const {
  std::vector<double> sum(part_is_open_.size(), 0.0), volume(part_is_open_.size(), 0.0);
  for (std::size_t c = 0; c < part_.size(); ++c) {
    sum[part_[c]] += volume_[static_cast<Eigen::Index>(c)] * values[static_cast<Eigen::Index>(c)];
    volume[part_[c]] += volume_[static_cast<Eigen::Index>(c)];
  }
  for (std::size_t c = 0; c < part_.size(); ++c)
    if (!part_is_open_[part_[c]]) values[static_cast<Eigen::Index>(c)] -= sum[part_[c]] / volume[part_[c]];
}

void CoarsestSolve::solve(MultigridLevel& level) {
  const auto n_cells = static_cast<Eigen::Index>(cells_.size()), n_pieces = static_cast<Eigen::Index>(pieces_.size());
  right_hand_side_.resize(volume_.size());
  for (Eigen::Index c = 0; c < n_cells; ++c) {
    const Cell& cell = cells_[static_cast<std::size_t>(c)];
    right_hand_side_[c] = level.rhs(cell.i, cell.j, cell.k);
  }
  for (Eigen::Index p = 0; p < n_pieces; ++p)
    right_hand_side_[n_cells + p] = level.pieces()->rhs[pieces_[static_cast<std::size_t>(p)]];
  remove_means(right_hand_side_);
  right_hand_side_.array() *= -volume_.array();
  solution_ = factors_.solve(right_hand_side_);
  remove_means(solution_);
  for (Eigen::Index c = 0; c < n_cells; ++c) {
    const Cell& cell = cells_[static_cast<std::size_t>(c)];
    level.phi(cell.i, cell.j, cell.k) = static_cast<float>(solution_[c]);
  }
  for (Eigen::Index p = 0; p < n_pieces; ++p)
    level.pieces()->phi[pieces_[static_cast<std::size_t>(p)]] = static_cast<float>(solution_[n_cells + p]);
}

void CoarsestSolve::number_parts(MultigridLevel& level) const {
  std::vector<float> number;
  int n = 0;
  for (const bool is_open : part_is_open_) number.push_back(is_open ? -1.0f : static_cast<float>(++n));
  for (std::size_t c = 0; c < cells_.size(); ++c) level.phi(cells_[c].i, cells_[c].j, cells_[c].k) = number[part_[c]];
  for (std::size_t p = 0; p < pieces_.size(); ++p) level.pieces()->phi[pieces_[p]] = number[part_[cells_.size() + p]];
}

}  // namespace couplet::flow
