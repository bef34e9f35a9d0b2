#include "flow-server/poisson/multigrid_level.hpp"

#include <algorithm>
#include <cmath>

namespace couplet::flow {

/// What the sweep over one row needs besides the row itself.
struct MultigridLevel::RowCoefficients {
  const float *x_lower, *x_upper, *x_sum;
  float y_lower, y_upper, z_lower, z_upper;
  std::ptrdiff_t before_y, after_y, before_z, after_z;  // to the same cell of the rows and planes beside this one
  // with shares: of the faces at the end of the cell; those at its start stand one entry, row, plane before
  const float *x_share, *y_share, *z_share;
  std::ptrdiff_t share_to_y, share_to_z;
  const float* inverse_diagonal;
};

namespace {

constexpr int depth = multigrid_depth;
constexpr int n_half_sweeps = 4;
// Yavneh, "On red-black SOR smoothing in multigrid", SIAM J. Sci. Comput. 17 (1996): a little over-relaxation halves
// the convergence factor of red-black smoothing in three dimensions.
constexpr float over_relaxation = 1.15f;

/// Sum of coefficient times neighbour.
template <bool has_share, class Coefficients>
inline float neighbour_sum(const Coefficients& a, const float* c, int i) {
  if constexpr (has_share) {
    return a.x_lower[i] * a.x_share[i - 1] * c[i - 1] + a.x_upper[i] * a.x_share[i] * c[i + 1] +
           a.y_lower * a.y_share[i - a.share_to_y] * c[i + a.before_y] + a.y_upper * a.y_share[i] * c[i + a.after_y] +
           a.z_lower * a.z_share[i - a.share_to_z] * c[i + a.before_z] + a.z_upper * a.z_share[i] * c[i + a.after_z];
  } else {
    return a.x_lower[i] * c[i - 1] + a.x_upper[i] * c[i + 1] + a.y_lower * c[i + a.before_y] +
           a.y_upper * c[i + a.after_y] + a.z_lower * c[i + a.before_z] + a.z_upper * c[i + a.after_z];
  }
}

/// One colour of the cells begin <= i < end of a row: omega[i] is the over-relaxation there and 0 at the other colour.
/// `out` is another row: written in place, each vector would have to wait for the one before, whose last value it
/// reads.
template <bool starts_at_zero, bool has_share, class Coefficients>
void relax_row(float* __restrict out, const float* __restrict c, const float* __restrict f,
               const float* __restrict omega, const Coefficients& coefficients, int begin, int end) {
  const Coefficients a = coefficients;
  const float yz_sum = (a.y_lower + a.y_upper) + (a.z_lower + a.z_upper);
#pragma GCC ivdep
  for (int i = begin; i < end; ++i) {
    if constexpr (starts_at_zero) {
      // From phi = 0 the neighbours give nothing.
      if constexpr (has_share) {
        out[i] = -omega[i] * f[i] * a.inverse_diagonal[i];
      } else {
        out[i] = -omega[i] * f[i] / (a.x_sum[i] + yz_sum);
      }
    } else {
      const float excess = neighbour_sum<has_share>(a, c, i) - f[i];
      if constexpr (has_share) {
        out[i] = c[i] + omega[i] * (excess * a.inverse_diagonal[i] - c[i]);
      } else {
        out[i] = c[i] + omega[i] * (excess / (a.x_sum[i] + yz_sum) - c[i]);
      }
    }
  }
}

template <bool has_share, class Coefficients>
void residual_row(float* __restrict out, const float* __restrict c, const float* __restrict f,
                  const Coefficients& coefficients, int begin, int end) {
  const Coefficients a = coefficients;
  const float yz_sum = (a.y_lower + a.y_upper) + (a.z_lower + a.z_upper);
#pragma GCC ivdep
  for (int i = begin; i < end; ++i) {
    const float excess = neighbour_sum<has_share>(a, c, i) - f[i];
    if constexpr (has_share) {
      // f - A phi, with the diagonal as the inverse of its inverse.
      out[i] = c[i] / a.inverse_diagonal[i] - excess;
    } else {
      out[i] = c[i] * (a.x_sum[i] + yz_sum) - excess;
    }
  }
}

/// Local index as the index of the whole, wrapped in a periodic direction; -1 beyond a border.
int wrapped(int global, const LevelAxis& axis) {
  const int n = axis.n_cells();
  if (global >= 0 && global < n) return global;
  return axis.is_periodic ? ((global % n) + n) % n : -1;
}

}  // namespace

MultigridLevel::MultigridLevel(const std::array<LevelAxis, 3>& axes, const BlockDecomposition& decomposition,
                               Faces faces)
    : axes_(axes),
      decomposition_(&decomposition),
      halo_(decomposition),
      sizes_(decomposition.mine().sizes()),
      active_(ActiveCells::all({})) {
  if (faces != Faces::whole) share_.emplace();
  if (!decomposition.has_cells()) return;
  Triple ghosts;
  for (int d = 0; d < 3; ++d) {
    ghosts[d] = axes_[d].has_terms ? depth : 0;
    wraps_[d] = d < 2 && faces != Faces::with_shares_and_links && axes_[d].has_terms && axes_[d].is_periodic &&
                decomposition.shape()[d] == 1;
    const int begin = decomposition.mine().begin[d];
    for (int i = -depth; i < sizes_[d] + depth; ++i) {
      const int global = wrapped(begin + i, axes_[d]);
      lower_[d].push_back(global < 0 ? 0 : static_cast<float>(axes_[d].lower(global)));
      upper_[d].push_back(global < 0 ? 0 : static_cast<float>(axes_[d].upper(global)));
      sum_[d].push_back(lower_[d].back() + upper_[d].back());
    }
  }
  phi = Field<float>(sizes_, ghosts);
  rhs = Field<float>(sizes_, ghosts);
  for (int i = 0; i < sizes_[0] + 2 * depth + 2; ++i) pattern_.push_back(i % 2 == 0 ? over_relaxation : 0);
  residual_row_.resize(static_cast<std::size_t>(sizes_[0]));
  relaxed_row_.resize(static_cast<std::size_t>(sizes_[0] + 2 * depth));
  if (!share_) {
    active_ = ActiveCells::all(range(depth));
    return;
  }
  for (Field<float>& open : *share_) open = Field<float>(sizes_, ghosts);
  inverse_diagonal_ = Field<float>(sizes_, ghosts);
  changed_ = CellMask(box_of(sizes_));
  active_ = ActiveCells::of_rows(range(depth), [](int, int, std::vector<Interval>&) {});
}

void MultigridLevel::set_share(int direction, const Triple& cell, float share) {
  float& place = (*share_)[direction](cell[0], cell[1], cell[2]);
  if (place == share) return;
  place = share;
  changed_.add_beside_face(direction, cell);
}

void MultigridLevel::update(const std::vector<GridLink>* links) {
  const bool has_cells = decomposition_->has_cells();
  mark_links();
  pieces_ =
      links ? std::make_unique<LevelPieces>(*links, axes_, *decomposition_, has_cells ? range(depth) : Box{}) : nullptr;
  mark_links();
  std::vector<char> row_has_changed;
  if (has_cells) {
    halo_.exchange<float>({&(*share_)[0], &(*share_)[1], &(*share_)[2]}, depth);
    // What has changed in the blocks beside this one matters in the outermost cells.
    for (int d = 0; d < 3; ++d)
      for (int side = 0; side < 2; ++side) {
        if (!axes_[d].has_terms || decomposition_->is_at_border(d, side)) continue;
        Box layer = box_of(sizes_);
        (side == 0 ? layer.end[d] : layer.begin[d]) = side == 0 ? 1 : sizes_[d] - 1;
        changed_.add(layer);
      }
    set_diagonals(row_has_changed);
    // The face before the outermost ghost cell is known to the owner of the cell only, hence the exchange.
    halo_.exchange<float>({&inverse_diagonal_}, depth);
  }
  int n_changed = std::count(row_has_changed.begin(), row_has_changed.end(), 1) > 0 ? 1 : 0;
  MPI_Allreduce(MPI_IN_PLACE, &n_changed, 1, MPI_INT, MPI_MAX, decomposition_->communicator());
  if (n_changed > 0 && has_cells) set_active(row_has_changed);
  if (transfer_) transfer_->update(pieces_.get(), changed_, halo_);
  changed_.clear();
}

/// Links of a cell count in its row.
void MultigridLevel::mark_links() {
  if (!pieces_) return;
  for (const PieceRows::Row& row : pieces_->rows().cells()) changed_.add(row.unknown.cell);
}

void MultigridLevel::set_diagonals(std::vector<char>& row_has_changed) {
  row_has_changed.assign(static_cast<std::size_t>(sizes_[1]) * static_cast<std::size_t>(sizes_[2]), 0);
  std::array<std::vector<double>, 3> lower, upper;
  for (int d = 0; d < 3; ++d)
    for (int i = decomposition_->mine().begin[d]; i < decomposition_->mine().end[d]; ++i) {
      lower[d].push_back(axes_[d].lower(i));
      upper[d].push_back(axes_[d].upper(i));
    }
  changed_.for_each([&](const Triple& cell) {
    const auto& [i, j, k] = cell;
    double sum = 0;
    for (int d = 0; d < 3; ++d) {
      if (!axes_[d].has_terms) continue;
      Triple before = cell;
      --before[d];
      const Field<float>& open = (*share_)[d];
      sum += lower[d][cell[d]] * open(before[0], before[1], before[2]) + upper[d][cell[d]] * open(i, j, k);
    }
    if (pieces_) sum += pieces_->link_sum(cell);
    const float inverse = sum > 0 ? static_cast<float>(1 / sum) : 0.0f;
    float& place = inverse_diagonal_(i, j, k);
    if ((inverse != 0) != (place != 0)) {
      row_has_changed[static_cast<std::size_t>(j + k * sizes_[1])] = 1;
      if (inverse == 0) phi(i, j, k) = rhs(i, j, k) = 0;  // no sweep writes them any more
    }
    if (place != inverse) place = inverse;
  });
}

void MultigridLevel::set_active(const std::vector<char>& row_has_changed) {
  const Box all = range(depth);
  const bool has_neighbour_in_x = all.size(0) > sizes_[0];
  const auto append = [&](int j, int k, std::vector<Interval>& intervals) {
    const bool is_own = j >= 0 && j < sizes_[1] && k >= 0 && k < sizes_[2];
    if (is_own && !has_neighbour_in_x && row_has_changed[static_cast<std::size_t>(j + k * sizes_[1])] == 0) {
      const auto kept = active_.row(j, k);
      intervals.insert(intervals.end(), kept.begin(), kept.end());
      return;
    }
    const float* inverse = inverse_diagonal_.row(j, k);
    bool was_active = false;
    for (int i = all.begin[0]; i < all.end[0]; ++i) {
      const bool is = inverse[i] != 0;
      if (is && !was_active) intervals.push_back({i, i});
      if (is) intervals.back().end = i + 1;
      was_active = is;
    }
  };
  active_ = ActiveCells::of_rows(all, append);
}

Box MultigridLevel::range(int layers) const {
  Box box = box_of(sizes_);
  for (int d = 0; d < 3; ++d) {
    if (!axes_[d].has_terms || wraps_[d]) continue;
    if (!decomposition_->is_at_border(d, 0)) box.begin[d] -= layers;
    if (!decomposition_->is_at_border(d, 1)) box.end[d] += layers;
  }
  return box;
}

void MultigridLevel::join(const std::array<Merging, 3>& merging, const std::array<LevelAxis, 3>& coarse_axes) {
  transfer_.emplace(FineLevel{axes_, *decomposition_, share_ ? &*share_ : nullptr, &inverse_diagonal_, merging,
                              coarse_axes, nullptr});
}

template <bool has_share>
MultigridLevel::RowCoefficients MultigridLevel::coefficients_at(int j, int k) const {
  const auto at_j = static_cast<std::size_t>(j + depth), at_k = static_cast<std::size_t>(k + depth);
  RowCoefficients a{};
  a.x_lower = lower_[0].data() + depth, a.x_upper = upper_[0].data() + depth, a.x_sum = sum_[0].data() + depth;
  a.y_lower = lower_[1][at_j], a.y_upper = upper_[1][at_j];
  a.z_lower = lower_[2][at_k], a.z_upper = upper_[2][at_k];
  const std::ptrdiff_t stride_y = axes_[1].has_terms ? phi.stride_y() : 0;
  const std::ptrdiff_t stride_z = axes_[2].has_terms ? phi.stride_z() : 0;
  const int last = sizes_[1] - 1;
  a.before_y = wraps_[1] && j == 0 ? last * stride_y : -stride_y;
  a.after_y = wraps_[1] && j == last ? -last * stride_y : stride_y;
  a.before_z = -stride_z, a.after_z = stride_z;
  if constexpr (has_share) {
    a.x_share = (*share_)[0].row(j, k), a.y_share = (*share_)[1].row(j, k), a.z_share = (*share_)[2].row(j, k);
    a.share_to_y = stride_y, a.share_to_z = stride_z;
    a.inverse_diagonal = inverse_diagonal_.row(j, k);
  }
  return a;
}

template <bool starts_at_zero, bool has_share>
void MultigridLevel::relax_plane(int k, const Box& cells, int colour) {
  if (k < cells.begin[2] || k >= cells.end[2]) return;
  const Triple& first = decomposition_->mine().begin;
  for (int j = cells.begin[1]; j < cells.end[1]; ++j) {
    const RowCoefficients a = coefficients_at<has_share>(j, k);
    float* row = phi.row(j, k);
    float* relaxed = relaxed_row_.data() + depth;
    const float* f = rhs.row(j, k);
    const float* omega = pattern_.data() + depth + ((first[0] + first[1] + j + first[2] + k + colour) & 1);
    const auto relax = [&](int begin, int end) {
      if (begin >= end) return;
      if constexpr (starts_at_zero) {
        relax_row<true, has_share>(row, nullptr, f, omega, a, begin, end);
      } else {
        relax_row<false, has_share>(relaxed, row, f, omega, a, begin, end);
        std::copy(relaxed + begin, relaxed + end, row + begin);
      }
    };
    if constexpr (has_share) {
      for (const Interval& interval : active_.row(j, k))
        relax(std::max(interval.begin, cells.begin[0]), std::min(interval.end, cells.end[0]));
    } else {
      relax(cells.begin[0], cells.end[0]);
    }
    if (wraps_[0]) row[-1] = row[sizes_[0] - 1], row[sizes_[0]] = row[0];
  }
}

template <bool has_share>
void MultigridLevel::restrict_plane(int k, Field<float>& coarse_rhs) {
  if (k < 0 || k >= sizes_[2]) return;
  float* residual = residual_row_.data();
  for (int j = 0; j < sizes_[1]; ++j) {
    const auto intervals = active_.row(j, k);
    if (!intervals.empty()) {
      const RowCoefficients a = coefficients_at<has_share>(j, k);
      if constexpr (has_share) {
        std::fill(residual_row_.begin(), residual_row_.end(), 0.0f);
        for (const Interval& interval : intervals)
          residual_row<true>(residual, phi.row(j, k), rhs.row(j, k), a, std::max(interval.begin, 0),
                             std::min(interval.end, sizes_[0]));
      } else {
        residual_row<false>(residual, phi.row(j, k), rhs.row(j, k), a, 0, sizes_[0]);
      }
    }
    transfer_->restrict_row(j, k, intervals.empty() ? nullptr : residual, coarse_rhs);
  }
}

// Half-sweep s reaches plane k one step after half-sweep s - 1 has left plane k + 1: all of them, and the residual, go
// over the planes together, and what they share stays in the cache. From four good ghost layers each half-sweep uses
// up one.
template <bool has_share>
void MultigridLevel::smooth_and_restrict_all(Field<float>& coarse_rhs) {
  const Box first = range(depth), second = range(depth - 1), third = range(depth - 2), fourth = range(depth - 3);
  for (int front = first.begin[2]; front < first.end[2] + n_half_sweeps; ++front) {
    relax_plane<true, has_share>(front, first, 0);
    relax_plane<false, has_share>(front - 1, second, 1);
    relax_plane<false, has_share>(front - 2, third, 0);
    relax_plane<false, has_share>(front - 3, fourth, 1);
    restrict_plane<has_share>(front - 4, coarse_rhs);
  }
}

template <bool has_share>
void MultigridLevel::smooth_all() {
  const Box first = range(depth - 1), second = range(depth - 2), third = range(depth - 3), fourth = range(0);
  for (int front = first.begin[2]; front < first.end[2] + n_half_sweeps; ++front) {
    relax_plane<false, has_share>(front, first, 0);
    relax_plane<false, has_share>(front - 1, second, 1);
    relax_plane<false, has_share>(front - 2, third, 0);
    relax_plane<false, has_share>(front - 3, fourth, 1);
  }
}

void MultigridLevel::smooth_and_restrict(Field<float>& coarse_rhs) {
  if (!decomposition_->has_cells()) return;
  if (pieces_) {
    pieces_->relax_from_zero();
    pieces_->take_from(rhs);
  }
  has_shares() ? smooth_and_restrict_all<true>(coarse_rhs) : smooth_and_restrict_all<false>(coarse_rhs);
  if (pieces_) {
    pieces_->restore(rhs);
    pieces_->residual(phi, piece_residual_);
  }
  transfer_->finish_restriction(piece_residual_, coarse_rhs);
}

void MultigridLevel::smooth() {
  if (!decomposition_->has_cells()) return;
  if (pieces_) pieces_->take_from(rhs);
  has_shares() ? smooth_all<true>() : smooth_all<false>();
  if (pieces_) pieces_->restore(rhs);
}

void MultigridLevel::smooth_pieces() {
  if (!pieces_ || !decomposition_->has_cells()) return;
  halo_.exchange<float>({&phi}, 2);
  pieces_->relax(*share_, rhs, phi);
}

int MultigridLevel::number_parts(const Field<float>& coarse_phi, int n_sealed) {
  const MPI_Comm communicator = decomposition_->communicator();
  int n_alone = decomposition_->has_cells() ? transfer_->inject(coarse_phi, active_, phi) : 0, n_before = 0, n_all = 0;
  MPI_Exscan(&n_alone, &n_before, 1, MPI_INT, MPI_SUM, communicator);
  MPI_Allreduce(&n_alone, &n_all, 1, MPI_INT, MPI_SUM, communicator);
  if (decomposition_->rank() == 0) n_before = 0;
  const auto renumber = [&](float& value) {
    if (value < -1) value = static_cast<float>(n_sealed + n_before - 1) - value;
  };
  if (n_alone > 0) {
    for (int k = 0; k < sizes_[2]; ++k)
      for (int j = 0; j < sizes_[1]; ++j)
        for (int i = 0; i < sizes_[0]; ++i) renumber(phi(i, j, k));
    if (pieces_)
      for (float& value : pieces_->phi) renumber(value);
  }
  return n_sealed + n_all;
}

std::size_t MultigridLevel::n_bytes() const {
  std::size_t n = phi.n_bytes() + rhs.n_bytes() + inverse_diagonal_.n_bytes() + changed_.n_bytes();
  if (share_)
    for (const Field<float>& field : *share_) n += field.n_bytes();
  if (pieces_) n += pieces_->n_bytes();
  return n + (transfer_ ? transfer_->n_bytes() : 0);
}

Traffic MultigridLevel::traffic() const {
  Traffic sum = halo_.traffic();
  if (pieces_) sum += pieces_->traffic();
  return sum;
}

}  // namespace couplet::flow
