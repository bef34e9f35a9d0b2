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
  const int n = static_cast<int>(cells_.size());
  volume_ = Eigen::Map<const Eigen::VectorXd>(volumes.data(), n);

  // - volume * (div grad): symmetric and positive.
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<std::vector<int>> joined(static_cast<std::size_t>(n));
  std::vector<bool> is_open(static_cast<std::size_t>(n), false);
  for (int row = 0; row < n; ++row) {
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
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    sum[part_[c]] += volume_[static_cast<Eigen::Index>(c)] * values[static_cast<Eigen::Index>(c)];
    volume[part_[c]] += volume_[static_cast<Eigen::Index>(c)];
  }
  for (std::size_t c = 0; c < cells_.size(); ++c)
    if (!part_is_open_[part_[c]]) values[static_cast<Eigen::Index>(c)] -= sum[part_[c]] / volume[part_[c]];
}

void CoarsestSolve::solve(const Field<float>& rhs, Field<float>& phi) {
  right_hand_side_.resize(volume_.size());
  for (Eigen::Index c = 0; c < volume_.size(); ++c) {
    const Cell& cell = cells_[static_cast<std::size_t>(c)];
    right_hand_side_[c] = rhs(cell.i, cell.j, cell.k);
  }
  remove_means(right_hand_side_);
  right_hand_side_.array() *= -volume_.array();
  solution_ = factors_.solve(right_hand_side_);
  remove_means(solution_);
  for (Eigen::Index c = 0; c < volume_.size(); ++c) {
    const Cell& cell = cells_[static_cast<std::size_t>(c)];
    phi(cell.i, cell.j, cell.k) = static_cast<float>(solution_[c]);
  }
}

}  // namespace couplet::flow
