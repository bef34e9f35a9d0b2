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

/// coarse[I] += factor * sum of share[i] fine[i] over the cells of I.
void add_restricted_row(float* __restrict coarse, const float* __restrict fine, const BlockMerging& merging,
                        float factor) {
  const float* __restrict share = merging.share.data();
  for (const BlockMerging::Run& run : merging.runs) {
    float* __restrict c = coarse + run.first_coarse;
    const float* __restrict r = fine + run.first_fine;
    const float* __restrict s = share + run.first_fine;
    if (run.group_size == 1) {
      for (int I = 0; I < run.n_coarse; ++I) c[I] += factor * (s[I] * r[I]);
    } else if (run.group_size == 2) {
      for (int I = 0; I < run.n_coarse; ++I) c[I] += factor * (s[2 * I] * r[2 * I] + s[2 * I + 1] * r[2 * I + 1]);
    } else {
      for (int I = 0; I < run.n_coarse; ++I)
        c[I] += factor * (s[3 * I] * r[3 * I] + s[3 * I + 1] * r[3 * I + 1] + s[3 * I + 2] * r[3 * I + 2]);
    }
  }
}

/// fine[i] = base[I] + weight[i] (slope towards the neighbour of i), slope[I] being that from I to I + 1.
void interpolate_row(float* __restrict fine, const float* __restrict base, const float* __restrict slope,
                     const BlockMerging& merging) {
  for (const BlockMerging::Run& run : merging.runs) {
    float* __restrict f = fine + run.first_fine;
    const float* __restrict b = base + run.first_coarse;
    const float* __restrict s = slope + run.first_coarse;
    const float* __restrict w = merging.weight.data() + run.first_fine;
    if (run.group_size == 1) {
      for (int I = 0; I < run.n_coarse; ++I) f[I] = b[I];
    } else if (run.group_size == 2) {
      for (int I = 0; I < run.n_coarse; ++I) {
        f[2 * I] = b[I] - w[2 * I] * s[I - 1];
        f[2 * I + 1] = b[I] + w[2 * I + 1] * s[I];
      }
    } else {
      for (int I = 0; I < run.n_coarse; ++I) {
        f[3 * I] = b[I] - w[3 * I] * s[I - 1];
        f[3 * I + 1] = b[I];
        f[3 * I + 2] = b[I] + w[3 * I + 2] * s[I];
      }
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
                               std::optional<FaceFractions> share)
    : axes_(axes),
      decomposition_(&decomposition),
      halo_(decomposition),
      sizes_(decomposition.mine().sizes()),
      share_(std::move(share)),
      active_(ActiveCells::all({})) {
  if (!decomposition.has_cells()) return;
  Triple ghosts;
  for (int d = 0; d < 3; ++d) {
    ghosts[d] = axes_[d].has_terms ? depth : 0;
    wraps_[d] = d < 2 && axes_[d].has_terms && axes_[d].is_periodic && decomposition.shape()[d] == 1;
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
  halo_.exchange<float>({&(*share_)[0], &(*share_)[1], &(*share_)[2]}, depth);
  // The face before the outermost ghost cell is known to the owner of the cell only, hence the exchange.
  inverse_diagonal_ = Field<float>(sizes_, ghosts);
  const Box mine = decomposition.mine();
  for (int k = 0; k < sizes_[2]; ++k)
    for (int j = 0; j < sizes_[1]; ++j)
      for (int i = 0; i < sizes_[0]; ++i) {
        const Triple cell{i, j, k};
        double sum = 0;
        for (int d = 0; d < 3; ++d) {
          if (!axes_[d].has_terms) continue;
          Triple before = cell;
          --before[d];
          const Field<float>& open = (*share_)[d];
          sum += axes_[d].lower(mine.begin[d] + cell[d]) * open(before[0], before[1], before[2]) +
                 axes_[d].upper(mine.begin[d] + cell[d]) * open(i, j, k);
        }
        if (sum > 0) inverse_diagonal_(i, j, k) = static_cast<float>(1 / sum);
      }
  halo_.exchange<float>({&inverse_diagonal_}, depth);
  active_ = ActiveCells::where(range(depth), [&](int i, int j, int k) { return inverse_diagonal_(i, j, k) != 0; });
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
  if (!decomposition_->has_cells()) return;
  const Box& mine = decomposition_->mine();
  for (int d = 0; d < 3; ++d) {
    BlockMerging& block = merging_[d];
    block = {};
    coarse_box_.begin[d] = merging[d].coarse_of(mine.begin[d]);
    coarse_box_.end[d] = merging[d].coarse_of(mine.end[d] - 1) + 1;
    block.n_coarse = coarse_box_.size(d);
    for (int C = coarse_box_.begin[d]; C < coarse_box_.end[d]; ++C) {
      const LevelAxis& coarse = coarse_axes[d];
      const int first = merging[d].first[C], size = merging[d].first[C + 1] - first;
      if (block.runs.empty() || block.runs.back().group_size != size)
        block.runs.push_back({first - mine.begin[d], C - coarse_box_.begin[d], 0, size});
      ++block.runs.back().n_coarse;
      double centre = -0.5 * coarse.width[C];  // of the fine cell, from that of the coarse one
      for (int i = first; i < first + size; ++i) {
        const double width = axes_[d].width[i];
        centre += 0.5 * width;
        // Towards the neighbour across the nearer coarse face; at that face the value beyond a border is 0 for an open
        // one and the same as inside for a closed one.
        const int side = size == 1 || (size == 3 && i == first + 1) ? 0 : (i == first ? -1 : 1);
        double per_distance = 0;
        if (side < 0) per_distance = coarse.lower(C) * coarse.width[C];
        if (side > 0) per_distance = coarse.upper(C) * coarse.width[C];
        block.coarse.push_back(C - coarse_box_.begin[d]);
        block.neighbour.push_back(C - coarse_box_.begin[d] + side);
        block.share.push_back(static_cast<float>(width / coarse.width[C]));
        block.weight.push_back(static_cast<float>(std::abs(centre) * per_distance));
        centre += 0.5 * width;
      }
    }
  }
  base_row_.resize(static_cast<std::size_t>(merging_[0].n_coarse) + 2);
  slope_row_.resize(static_cast<std::size_t>(merging_[0].n_coarse) + 2);
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
  const int K = merging_[2].coarse[static_cast<std::size_t>(k)];
  const bool begins_z = k == 0 || merging_[2].coarse[static_cast<std::size_t>(k - 1)] != K;
  float* residual = residual_row_.data();
  for (int j = 0; j < sizes_[1]; ++j) {
    const int J = merging_[1].coarse[static_cast<std::size_t>(j)];
    float* coarse = coarse_rhs.row(J, K);
    if (begins_z && (j == 0 || merging_[1].coarse[static_cast<std::size_t>(j - 1)] != J))
      std::fill(coarse, coarse + merging_[0].n_coarse, 0.0f);
    const auto intervals = active_.row(j, k);
    if (intervals.empty()) continue;
    const RowCoefficients a = coefficients_at<has_share>(j, k);
    if constexpr (has_share) {
      std::fill(residual_row_.begin(), residual_row_.end(), 0.0f);
      for (const Interval& interval : intervals)
        residual_row<true>(residual, phi.row(j, k), rhs.row(j, k), a, std::max(interval.begin, 0),
                           std::min(interval.end, sizes_[0]));
    } else {
      residual_row<false>(residual, phi.row(j, k), rhs.row(j, k), a, 0, sizes_[0]);
    }
    add_restricted_row(coarse, residual, merging_[0],
                       merging_[1].share[static_cast<std::size_t>(j)] * merging_[2].share[static_cast<std::size_t>(k)]);
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
  has_shares() ? smooth_and_restrict_all<true>(coarse_rhs) : smooth_and_restrict_all<false>(coarse_rhs);
}

void MultigridLevel::smooth() {
  if (!decomposition_->has_cells()) return;
  has_shares() ? smooth_all<true>() : smooth_all<false>();
}

void MultigridLevel::add_correction(const Field<float>& coarse_phi, const FaceFractions* coarse_share) {
  if (!decomposition_->has_cells()) return;
  const int n_coarse = merging_[0].n_coarse;
  float* __restrict base = base_row_.data() + 1;
  float* __restrict slope = slope_row_.data() + 1;
  for (int k = 0; k < sizes_[2]; ++k)
    for (int j = 0; j < sizes_[1]; ++j) {
      const auto intervals = active_.row(j, k);
      if (intervals.empty()) continue;
      const auto at_j = static_cast<std::size_t>(j), at_k = static_cast<std::size_t>(k);
      const int J = merging_[1].coarse[at_j], K = merging_[2].coarse[at_k];
      const int to_J = merging_[1].neighbour[at_j], to_K = merging_[2].neighbour[at_k];
      const float y = merging_[1].weight[at_j], z = merging_[2].weight[at_k];
      const float* __restrict own = coarse_phi.row(J, K);
      const float* __restrict in_y = coarse_phi.row(to_J, K);
      const float* __restrict in_z = coarse_phi.row(J, to_K);
      if (coarse_share) {
        // Constant plus one slope a direction, each only where the coarse face is open.
        const float* __restrict y_face = (*coarse_share)[1].row(std::min(J, to_J), K);
        const float* __restrict z_face = (*coarse_share)[2].row(J, std::min(K, to_K));
        const float* __restrict x_face = (*coarse_share)[0].row(J, K);
        for (int I = 0; I < n_coarse; ++I)
          base[I] = own[I] + (y_face[I] > 0 ? y : 0.0f) * (in_y[I] - own[I]) +
                    (z_face[I] > 0 ? z : 0.0f) * (in_z[I] - own[I]);
        for (int I = -1; I < n_coarse; ++I) slope[I] = x_face[I] > 0 ? own[I + 1] - own[I] : 0.0f;
      } else {
        const float* __restrict in_yz = coarse_phi.row(to_J, to_K);
        for (int I = -1; I <= n_coarse; ++I)
          base[I] = (1 - z) * ((1 - y) * own[I] + y * in_y[I]) + z * ((1 - y) * in_z[I] + y * in_yz[I]);
        for (int I = -1; I < n_coarse; ++I) slope[I] = base[I + 1] - base[I];
      }
      interpolate_row(residual_row_.data(), base, slope, merging_[0]);
      float* __restrict fine = phi.row(j, k);
      const float* __restrict correction = residual_row_.data();
      for (const Interval& interval : intervals)
        for (int i = std::max(interval.begin, 0); i < std::min(interval.end, sizes_[0]); ++i) fine[i] += correction[i];
    }
}

FaceFractions MultigridLevel::coarse_shares() const {
  FaceFractions coarse;
  Triple ghosts;
  for (int d = 0; d < 3; ++d) ghosts[d] = axes_[d].has_terms ? depth : 0;
  for (int d = 0; d < 3; ++d) {
    coarse[d] = Field<float>(coarse_box_.sizes(), ghosts);
    if (!decomposition_->has_cells()) continue;
    for (int k = 0; k < sizes_[2]; ++k)
      for (int j = 0; j < sizes_[1]; ++j)
        for (int i = 0; i < sizes_[0]; ++i) {
          const Triple cell{i, j, k};
          Triple C;
          float area = 1;  // of the fine face over that of the coarse one
          for (int e = 0; e < 3; ++e) {
            C[e] = merging_[e].coarse[static_cast<std::size_t>(cell[e])];
            if (e != d) area *= merging_[e].share[static_cast<std::size_t>(cell[e])];
          }
          const auto at = static_cast<std::size_t>(cell[d]);
          const bool is_last = cell[d] + 1 == sizes_[d] || merging_[d].coarse[at + 1] != C[d];
          if (is_last) coarse[d](C[0], C[1], C[2]) += area * (*share_)[d](i, j, k);
          if (cell[d] == 0 && axes_[d].has_terms) {
            Triple before = cell, C_before = C;
            --before[d], --C_before[d];
            coarse[d](C_before[0], C_before[1], C_before[2]) += area * (*share_)[d](before[0], before[1], before[2]);
          }
        }
  }
  return coarse;
}

std::size_t MultigridLevel::n_bytes() const {
  std::size_t n = phi.n_bytes() + rhs.n_bytes() + inverse_diagonal_.n_bytes();
  if (share_)
    for (const Field<float>& field : *share_) n += field.n_bytes();
  return n;
}

}  // namespace couplet::flow
