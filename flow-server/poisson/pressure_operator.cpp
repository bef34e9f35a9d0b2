#include "flow-server/poisson/pressure_operator.hpp"

#include <algorithm>

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

}  // namespace

PressureOperator::PressureOperator(const PressureProblem& problem)
    : sizes_(problem.decomposition->mine().sizes()),
      share_(problem.open_share ? &*problem.open_share : nullptr),
      active_(ActiveCells::all({})) {
  const BlockDecomposition& blocks = *problem.decomposition;
  const std::array<LevelAxis, 3> axes = finest_axes(problem);
  for (int d = 0; d < 3; ++d) {
    layer_[d] = axes[d].has_terms;
    for (int side = 0; side < 2; ++side) {
      is_at_border_[d][side] = blocks.is_at_border(d, side);
      if (!share_ && is_at_border_[d][side] && axes[d].has_terms && axes[d].border_is_open[side]) has_open_face_ = true;
    }
    for (int i = blocks.mine().begin[d]; i < blocks.mine().end[d]; ++i) {
      lower_[d].push_back(axes[d].lower(i));
      upper_[d].push_back(axes[d].upper(i));
      width_[d].push_back(axes[d].width[i]);
    }
  }
  if (!blocks.has_cells()) return;
  const auto open_faces = [&](int i, int j, int k) {
    bool is_open = false;
    for (int d = 0; d < 3; ++d) {
      if (!axes[d].has_terms) continue;
      Triple before{i, j, k};
      --before[d];
      const bool at_start = (*share_)[d](before[0], before[1], before[2]) > 0, at_end = (*share_)[d](i, j, k) > 0;
      const int at = d == 0 ? i : d == 1 ? j : k;
      if (at_start && at == 0 && is_at_border_[d][0]) has_open_face_ = true;
      if (at_end && at + 1 == sizes_[d] && is_at_border_[d][1]) has_open_face_ = true;
      is_open = is_open || at_start || at_end;
    }
    return is_open;
  };
  active_ = share_ ? ActiveCells::where(box_of(sizes_), open_faces) : ActiveCells::all(box_of(sizes_));
  for (int k = 0; k < sizes_[2]; ++k)
    for (int j = 0; j < sizes_[1]; ++j)
      for (const Interval& cells : active_.row(j, k)) {
        double sum = 0;
        for (int i = cells.begin; i < cells.end; ++i) sum += width_[0][i];
        volume_ += sum * width_[1][j] * width_[2][k];
      }
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
                                     Field<double>* residual) const {
  double squares = 0;
  const std::ptrdiff_t to_y = layer_[1] * phi.stride_y(), to_z = layer_[2] * phi.stride_z();
  std::vector<double> row(static_cast<std::size_t>(std::max(sizes_[0], 0)));
  for (int k = 0; k < sizes_[2]; ++k)
    for (int j = 0; j < sizes_[1]; ++j) {
      const RowOperator a = row_operator<has_share>(j, k);
      const double* __restrict b = source.row(j, k);
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
                                    Field<double>& phi, Field<double>& r, Field<float>& f) const {
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
        for (int i = -1; i < sizes_[0] + 1; ++i) direction[i] = correction[i] + share_of_last * direction[i];
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
                                  Field<double>* residual) const {
  return share_ ? residual_of<true>(source, mean, phi, residual) : residual_of<false>(source, mean, phi, residual);
}

DirectionSums PressureOperator::direction_sums(const Field<float>& z, const Field<double>& r,
                                               const Field<float>& p) const {
  return share_ ? direction_sums_of<true>(z, r, p) : direction_sums_of<false>(z, r, p);
}

double PressureOperator::advance(const Field<float>& z, double beta, double alpha, Field<float>& p, Field<double>& phi,
                                 Field<double>& r, Field<float>& f) const {
  return share_ ? advance_of<true>(z, beta, alpha, p, phi, r, f) : advance_of<false>(z, beta, alpha, p, phi, r, f);
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

void PressureOperator::copy(const Field<double>& from, Field<float>& to) const {
  for (int k = 0; k < sizes_[2]; ++k)
    for (int j = 0; j < sizes_[1]; ++j)
      for (const Interval& cells : active_.row(j, k))
        for (int i = cells.begin; i < cells.end; ++i) to(i, j, k) = static_cast<float>(from(i, j, k));
}

}  // namespace couplet::flow
