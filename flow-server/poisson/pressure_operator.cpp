#include "flow-server/poisson/pressure_operator.hpp"

#include <algorithm>

#include "flow-server/poisson/cell_mask.hpp"
#include "flow-server/poisson/multigrid.hpp"

namespace couplet::flow {

/// What one row of div grad needs.
struct PressureOperator::RowOperator {
  const double *x_lower, *x_upper, *x_width;
  double y_lower, y_upper, z_lower, z_upper;
  const float *x_share = nullptr, *y_share = nullptr, *z_share = nullptr;  // of the faces at the end of the cell
  std::ptrdiff_t share_to_y = 0, share_to_z = 0;
};

namespace {

template <bool has_share, class RowOperator, class Number>
inline double applied(const RowOperator& a, const Number* __restrict c, std::ptrdiff_t to_y, std::ptrdiff_t to_z,
                      int i) {
  const double own = c[i];
  if constexpr (has_share) {
    return a.x_lower[i] * static_cast<double>(a.x_share[i - 1]) * (c[i - 1] - own) +
           a.x_upper[i] * static_cast<double>(a.x_share[i]) * (c[i + 1] - own) +
           a.y_lower * static_cast<double>(a.y_share[i - a.share_to_y]) * (c[i - to_y] - own) +
           a.y_upper * static_cast<double>(a.y_share[i]) * (c[i + to_y] - own) +
           a.z_lower * static_cast<double>(a.z_share[i - a.share_to_z]) * (c[i - to_z] - own) +
           a.z_upper * static_cast<double>(a.z_share[i]) * (c[i + to_z] - own);
  } else {
    return a.x_lower[i] * (c[i - 1] - own) + a.x_upper[i] * (c[i + 1] - own) + a.y_lower * (c[i - to_y] - own) +
           a.y_upper * (c[i + to_y] - own) + a.z_lower * (c[i - to_z] - own) + a.z_upper * (c[i + to_z] - own);
  }
}

bool is_linked(const PieceRows& pieces, int i, int j, int k) {
  const auto row = pieces.cells(j, k);
  return std::any_of(row.begin(), row.end(), [i](const PieceRows::Row& cell) { return cell.unknown.cell[0] == i; });
}

}  // namespace

PressureOperator::PressureOperator(const PressureProblem& problem)
    : sizes_(problem.decomposition->mine().sizes()), axes_(finest_axes(problem)), active_(ActiveCells::all({})) {
  const BlockDecomposition& blocks = *problem.decomposition;
  for (int d = 0; d < 3; ++d) {
    layer_[d] = axes_[d].has_terms;
    for (int side = 0; side < 2; ++side) {
      is_at_border_[d][side] = blocks.is_at_border(d, side);
      has_open_side_[d][side] = is_at_border_[d][side] && axes_[d].has_terms && axes_[d].border_is_open[side];
    }
    for (int i = blocks.mine().begin[d]; i < blocks.mine().end[d]; ++i) {
      lower_[d].push_back(axes_[d].lower(i));
      upper_[d].push_back(axes_[d].upper(i));
      width_[d].push_back(axes_[d].width[i]);
    }
  }
  if (!blocks.has_cells()) return;
  width_before_.push_back(0);
  for (const double width : width_[0]) width_before_.push_back(width_before_.back() + width);
  const Box all = box_of(sizes_);
  if (problem.open_share) {
    active_ = ActiveCells::of_rows(all, [](int, int, std::vector<Interval>&) {});
    update(problem, std::span(&all, 1));
  } else {
    active_ = ActiveCells::all(all);
    sum_volume();
  }
}

void PressureOperator::update(const PressureProblem& problem, std::span<const Box> changed) {
  share_ = problem.open_share ? &*problem.open_share : nullptr;
  const Box all = box_of(sizes_);
  if (!share_ || all.is_empty()) return;
  CellMask cells(all);
  for (const Box& box : changed)
    for (int d = 0; d < 3; ++d) cells.add(box.grown({d == 0, d == 1, d == 2}));
  for (const PieceRows::Row& row : pieces_.cells()) cells.add(row.unknown.cell);
  if (problem.split) pieces_ = PieceRows(*problem.split, axes_, problem.decomposition->mine().begin, all);
  for (const PieceRows::Row& row : pieces_.cells()) cells.add(row.unknown.cell);
  std::vector<char> row_has_changed(static_cast<std::size_t>(sizes_[1]) * static_cast<std::size_t>(sizes_[2]), 0);
  const auto at = [&](int j, int k) { return static_cast<std::size_t>(j + k * sizes_[1]); };
  cells.for_each([&](const Triple& c) {
    if (is_open(c) != active_.contains(c[0], c[1], c[2])) row_has_changed[at(c[1], c[2])] = 1;
  });
  if (std::find(row_has_changed.begin(), row_has_changed.end(), 1) == row_has_changed.end()) return;
  active_ = ActiveCells::of_rows(all, [&](int j, int k, std::vector<Interval>& intervals) {
    if (row_has_changed[at(j, k)] == 0) {
      const auto kept = active_.row(j, k);
      intervals.insert(intervals.end(), kept.begin(), kept.end());
      return;
    }
    bool was_open = false;
    for (int i = 0; i < sizes_[0]; ++i) {
      const bool is = is_open({i, j, k});
      if (is && !was_open) intervals.push_back({i, i});
      if (is) intervals.back().end = i + 1;
      was_open = is;
    }
  });
  sum_volume();
}

bool PressureOperator::is_open(const Triple& cell) const {
  for (int d = 0; d < 3; ++d) {
    if (layer_[d] == 0) continue;
    Triple before = cell;
    --before[d];
    if ((*share_)[d](before[0], before[1], before[2]) > 0 || (*share_)[d](cell[0], cell[1], cell[2]) > 0) return true;
  }
  return !pieces_.is_empty() && is_linked(pieces_, cell[0], cell[1], cell[2]);
}

bool PressureOperator::has_open_border() const {
  for (int d = 0; d < 3; ++d)
    for (int side = 0; side < 2; ++side) {
      if (!share_ && has_open_side_[d][side]) return true;
      if (!share_ || !is_at_border_[d][side] || layer_[d] == 0) continue;
      Box faces = box_of(sizes_);
      if (faces.is_empty()) continue;
      faces.begin[d] = side == 0 ? -1 : sizes_[d] - 1;
      faces.end[d] = faces.begin[d] + 1;
      for (int k = faces.begin[2]; k < faces.end[2]; ++k)
        for (int j = faces.begin[1]; j < faces.end[1]; ++j)
          for (int i = faces.begin[0]; i < faces.end[0]; ++i)
            if ((*share_)[d](i, j, k) > 0) return true;
    }
  for (const PieceRows::Row& row : pieces_.pieces())
    for (const PieceRows::Entry& entry : pieces_.entries(row))
      for (int d = 0; d < 3; ++d)
        if ((is_at_border_[d][0] && entry.other.cell[d] < 0) ||
            (is_at_border_[d][1] && entry.other.cell[d] >= sizes_[d]))
          return true;
  return false;
}

void PressureOperator::sum_volume() {
  volume_ = 0;
  for (int k = 0; k < sizes_[2]; ++k)
    for (int j = 0; j < sizes_[1]; ++j)
      for (const Interval& cells : active_.row(j, k))
        volume_ += (width_before_[cells.end] - width_before_[cells.begin]) * width_[1][j] * width_[2][k];
}

std::array<double, 2> PressureOperator::moments(const Field<double>& values) const {
  double first = 0, second = 0;
  for (int k = 0; k < sizes_[2]; ++k)
    for (int j = 0; j < sizes_[1]; ++j) {
      const double* __restrict v = values.row(j, k);
      const double* __restrict width = width_[0].data();
      double a = 0, b = 0;
      for (const Interval& cells : active_.row(j, k))
#pragma omp simd reduction(+ : a, b)
        for (int i = cells.begin; i < cells.end; ++i) {
          a += width[i] * v[i];
          b += width[i] * v[i] * v[i];
        }
      first += a * (width_[1][j] * width_[2][k]);
      second += b * (width_[1][j] * width_[2][k]);
    }
  return {first, second};
}

template <bool has_share>
PressureOperator::RowOperator PressureOperator::row_operator(int j, int k) const {
  RowOperator a{lower_[0].data(), upper_[0].data(), width_[0].data(), lower_[1][j],
                upper_[1][j],     lower_[2][k],     upper_[2][k]};
  if constexpr (has_share) {
    a.x_share = (*share_)[0].row(j, k), a.y_share = (*share_)[1].row(j, k), a.z_share = (*share_)[2].row(j, k);
    a.share_to_y = layer_[1] * (*share_)[1].stride_y(), a.share_to_z = layer_[2] * (*share_)[2].stride_z();
  }
  return a;
}

template <bool has_share>
double PressureOperator::residual_of(const Field<double>& source, double mean, const Field<double>& phi,
                                     Field<double>* residual, std::span<const double> piece_phi) const {
  double squares = 0;
  const std::ptrdiff_t to_y = layer_[1] * phi.stride_y(), to_z = layer_[2] * phi.stride_z();
  const auto n = static_cast<std::size_t>(std::max(sizes_[0], 0));
  std::vector<double> row(n), without_links(pieces_.is_empty() ? 0 : n);
  for (int k = 0; k < sizes_[2]; ++k)
    for (int j = 0; j < sizes_[1]; ++j) {
      const RowOperator a = row_operator<has_share>(j, k);
      const double* __restrict b = source.row(j, k);
      if (const auto linked = pieces_.cells(j, k); !linked.empty()) {
        // Before the other terms: a residual near 0 is the difference of large numbers, sums of squares take none.
        std::copy(b, b + sizes_[0], without_links.begin());
        for (const PieceRows::Row& cell : linked)
          without_links[cell.unknown.cell[0]] -= pieces_.applied(cell, phi, piece_phi);
        b = without_links.data();
      }
      const double* __restrict c = phi.row(j, k);
      double* __restrict r = residual ? residual->row(j, k) : row.data();
      double sum = 0;
      for (const Interval& cells : active_.row(j, k))
#pragma omp simd reduction(+ : sum)
        for (int i = cells.begin; i < cells.end; ++i) {
          r[i] = b[i] - mean - applied<has_share>(a, c, to_y, to_z, i);
          sum += a.x_width[i] * r[i] * r[i];
        }
      squares += sum * (width_[1][j] * width_[2][k]);
    }
  return squares;
}

template <bool has_share>
DirectionSums PressureOperator::direction_sums_of(const Field<float>& z, const Field<double>& r,
                                                  const Field<float>& p) const {
  DirectionSums sums;
  const std::ptrdiff_t z_to_y = layer_[1] * z.stride_y(), z_to_z = layer_[2] * z.stride_z();
  const std::ptrdiff_t p_to_y = layer_[1] * p.stride_y(), p_to_z = layer_[2] * p.stride_z();
  for (int k = 0; k < sizes_[2]; ++k)
    for (int j = 0; j < sizes_[1]; ++j) {
      const RowOperator a = row_operator<has_share>(j, k);
      const float* __restrict zc = z.row(j, k);
      const float* __restrict pc = p.row(j, k);
      const double* __restrict rc = r.row(j, k);
      double zr = 0, zaz = 0, zap = 0;
      for (const Interval& cells : active_.row(j, k))
#pragma omp simd reduction(+ : zr, zaz, zap)
        for (int i = cells.begin; i < cells.end; ++i) {
          const double weighted = a.x_width[i] * zc[i];
          zr += weighted * rc[i];
          zaz += weighted * applied<has_share>(a, zc, z_to_y, z_to_z, i);
          zap += weighted * applied<has_share>(a, pc, p_to_y, p_to_z, i);
        }
      const double area = width_[1][j] * width_[2][k];
      sums.correction_residual += zr * area;
      sums.correction_operator += zaz * area;
      sums.correction_conjugate += zap * area;
    }
  return sums;
}

template <bool has_share>
double PressureOperator::advance_of(const Field<float>& z, double beta, double alpha, Field<float>& p,
                                    Field<double>& phi, Field<double>& r, Field<float>& f,
                                    std::span<const float> piece_p) const {
  if (sizes_[0] == 0) return 0;  // a rank without cells has no correction either
  const std::ptrdiff_t p_to_y = layer_[1] * p.stride_y(), p_to_z = layer_[2] * p.stride_z();
  const float share_of_last = static_cast<float>(beta);
  double squares = 0;
  // Plane k of A p follows plane k + 1 of p.
  for (int front = -layer_[2]; front < sizes_[2] + 1; ++front) {
    if (front < sizes_[2] + layer_[2])
      for (int j = -layer_[1]; j < sizes_[1] + layer_[1]; ++j) {
        float* __restrict direction = p.row(j, front);
        const float* __restrict correction = z.row(j, front);
        const auto turn = [&](int begin, int end) {
          for (int i = begin; i < end; ++i) direction[i] = correction[i] + share_of_last * direction[i];
        };
        const bool is_ghost = front < 0 || front >= sizes_[2] || j < 0 || j >= sizes_[1];
        if (is_ghost) {
          turn(-1, sizes_[0] + 1);
          continue;
        }
        turn(-1, 0), turn(sizes_[0], sizes_[0] + 1);
        for (const Interval& cells : active_.row(j, front)) turn(cells.begin, cells.end);
      }
    const int k = front - 1;
    if (k < 0) continue;
    for (int j = 0; j < sizes_[1]; ++j) {
      const RowOperator a = row_operator<has_share>(j, k);
      const float* __restrict pc = p.row(j, k);
      double* __restrict c = phi.row(j, k);
      double* __restrict rc = r.row(j, k);
      float* __restrict fc = f.row(j, k);
      double sum = 0;
      for (const PieceRows::Row& cell : pieces_.cells(j, k))  // before the other terms, as above
        rc[cell.unknown.cell[0]] -= alpha * pieces_.applied(cell, p, piece_p);
      for (const Interval& cells : active_.row(j, k))
#pragma omp simd reduction(+ : sum)
        for (int i = cells.begin; i < cells.end; ++i) {
          const double next = rc[i] - alpha * applied<has_share>(a, pc, p_to_y, p_to_z, i);
          c[i] += alpha * pc[i];
          rc[i] = next;
          fc[i] = static_cast<float>(next);
          sum += a.x_width[i] * next * next;
        }
      squares += sum * (width_[1][j] * width_[2][k]);
    }
  }
  return squares;
}

double PressureOperator::residual(const Field<double>& source, double mean, const Field<double>& phi,
                                  Field<double>* residual, std::span<const double> piece_phi) const {
  return share_ ? residual_of<true>(source, mean, phi, residual, piece_phi)
                : residual_of<false>(source, mean, phi, residual, piece_phi);
}

DirectionSums PressureOperator::direction_sums(const Field<float>& z, const Field<double>& r,
                                               const Field<float>& p) const {
  return share_ ? direction_sums_of<true>(z, r, p) : direction_sums_of<false>(z, r, p);
}

double PressureOperator::advance(const Field<float>& z, double beta, double alpha, Field<float>& p, Field<double>& phi,
                                 Field<double>& r, Field<float>& f, std::span<const float> piece_p) const {
  return share_ ? advance_of<true>(z, beta, alpha, p, phi, r, f, piece_p)
                : advance_of<false>(z, beta, alpha, p, phi, r, f, piece_p);
}

void PressureOperator::subtract(double value, Field<double>& phi) const {
  subtract_to(phi, value, phi);
}

void PressureOperator::subtract_to(const Field<double>& values, double value, Field<double>& difference) const {
  for (int k = 0; k < sizes_[2]; ++k)
    for (int j = 0; j < sizes_[1]; ++j)
      for (const Interval& cells : active_.row(j, k)) {
        const double* from = values.row(j, k);
        double* to = difference.row(j, k);
        for (int i = cells.begin; i < cells.end; ++i) to[i] = from[i] - value;
      }
}

void PressureOperator::add(const Field<double>& correction, Field<double>& phi) const {
  for (int k = 0; k < sizes_[2]; ++k)
    for (int j = 0; j < sizes_[1]; ++j)
      for (const Interval& cells : active_.row(j, k)) {
        const double* __restrict from = correction.row(j, k);
        double* __restrict to = phi.row(j, k);
        for (int i = cells.begin; i < cells.end; ++i) to[i] += from[i];
      }
}

template <class Number>
void PressureOperator::copy(const Field<Number>& from, Field<float>& to) const {
  for (int k = 0; k < sizes_[2]; ++k)
    for (int j = 0; j < sizes_[1]; ++j)
      for (const Interval& cells : active_.row(j, k))
        for (int i = cells.begin; i < cells.end; ++i) to(i, j, k) = static_cast<float>(from(i, j, k));
}

template void PressureOperator::copy<float>(const Field<float>&, Field<float>&) const;
template void PressureOperator::copy<double>(const Field<double>&, Field<float>&) const;

void PressureOperator::add_parts(const Field<float>& part, const Field<double>* values, std::span<double> sums) const {
  for (int k = 0; k < sizes_[2]; ++k)
    for (int j = 0; j < sizes_[1]; ++j)
      for (const Interval& cells : active_.row(j, k))
        for (int i = cells.begin; i < cells.end; ++i)
          if (part(i, j, k) > 0)
            sums[static_cast<std::size_t>(part(i, j, k)) - 1] +=
                width_[0][i] * width_[1][j] * width_[2][k] * (values ? (*values)(i, j, k) : 1);
}

void PressureOperator::subtract_parts(const Field<float>& part, std::span<const double> means,
                                      Field<double>& values) const {
  for (int k = 0; k < sizes_[2]; ++k)
    for (int j = 0; j < sizes_[1]; ++j)
      for (const Interval& cells : active_.row(j, k))
        for (int i = cells.begin; i < cells.end; ++i)
          if (part(i, j, k) > 0) values(i, j, k) -= means[static_cast<std::size_t>(part(i, j, k)) - 1];
}

}  // namespace couplet::flow
