#include "flow-server/momentum/line_solver.hpp"

#include <algorithm>

namespace couplet::flow {

namespace {

// Lines along x lie apart in memory: this many are copied side by side, so that each row is one vector of the
// processor.
constexpr int side_by_side = 8;

/// Rows of a panel: row r of its lines stands at start + r * stride, one line after the other.
template <class Number>
struct Rows {
  Number* start;
  std::ptrdiff_t stride;
  Number* operator[](int r) const { return start + r * stride; }
};

/// Thomas' algorithm on lines side by side. On return x holds the solution for x_before = x_after = 0, and, where they
/// are asked for, before and after hold how it depends on those. `after` must be given: it holds the factors meanwhile.
void eliminate_rows(int n_rows, int n_lines, Rows<const double> a, Rows<const double> b, Rows<const double> c,
                    Rows<double> x, double* before, double* after, bool starts_free, bool ends_free) {
  for (int r = 0; r < n_rows; ++r) {
    const double* __restrict ar = a[r], * __restrict br = b[r], * __restrict cr = c[r];
    double* __restrict xr = x[r], * __restrict factor = after + static_cast<std::ptrdiff_t>(r) * n_lines;
    const bool is_last = r == n_rows - 1;
    if (r == 0) {
#pragma GCC ivdep
      for (int l = 0; l < n_lines; ++l) {
        const double pivot = 1 / br[l];
        factor[l] = is_last && ends_free ? 0 : cr[l] * pivot;
        xr[l] *= pivot;
        if (before) before[l] = starts_free ? 0 : -ar[l] * pivot;
      }
      continue;
    }
    const double* __restrict xm = x[r - 1], * __restrict factor_m = factor - n_lines;
#pragma GCC ivdep
    for (int l = 0; l < n_lines; ++l) {
      const double pivot = 1 / (br[l] - ar[l] * factor_m[l]);
      factor[l] = is_last && ends_free ? 0 : cr[l] * pivot;
      xr[l] = (xr[l] - ar[l] * xm[l]) * pivot;
    }
    if (!before) continue;
    double* __restrict before_r = before + static_cast<std::ptrdiff_t>(r) * n_lines;
#pragma GCC ivdep
    for (int l = 0; l < n_lines; ++l) before_r[l] = -ar[l] * before_r[l - n_lines] / (br[l] - ar[l] * factor_m[l]);
  }
  for (int r = n_rows - 2; r >= 0; --r) {
    const double* __restrict factor = after + static_cast<std::ptrdiff_t>(r) * n_lines;
    const double* __restrict xp = x[r + 1];
    double* __restrict xr = x[r];
#pragma GCC ivdep
    for (int l = 0; l < n_lines; ++l) xr[l] -= factor[l] * xp[l];
    if (!before) continue;
    double* __restrict before_r = before + static_cast<std::ptrdiff_t>(r) * n_lines;
#pragma GCC ivdep
    for (int l = 0; l < n_lines; ++l) before_r[l] -= factor[l] * before_r[l + n_lines];
  }
  if (!before) return;
  // The last row depends on x_after by minus its factor; so do the rows before it, one through the other.
  for (int r = n_rows - 1; r >= 0; --r) {
    double* __restrict after_r = after + static_cast<std::ptrdiff_t>(r) * n_lines;
#pragma GCC ivdep
    for (int l = 0; l < n_lines; ++l) after_r[l] *= r == n_rows - 1 ? -1 : -after_r[l + n_lines];
  }
}

}  // namespace

LineSolver::LineSolver(const BlockDecomposition& decomposition, int direction)
    : direction_(direction), is_periodic_(decomposition.is_periodic()[direction]) {
  const Triple sizes = decomposition.mine().sizes();
  n_rows_ = sizes[direction];
  n_lines_ = n_rows_ == 0 ? 0 : static_cast<int>(decomposition.mine().n_cells() / n_rows_);
  const int width = direction == 0 ? side_by_side : sizes[0];  // of a panel
  const int across = direction == 2 ? 1 : 2;                   // the direction from panel row to panel row
  const int along = direction == 0 ? 1 : 0;                    // the direction from line to line in a panel
  for (int q = 0; n_lines_ > 0 && q < sizes[across]; ++q)
    for (int l = 0; l < sizes[along]; l += width) {
      Triple cell{0, 0, 0};
      cell[across] = q;
      cell[along] = l;
      panels_.push_back({cell, q * sizes[along] + l, std::min(width, sizes[along] - l)});
    }
  n_blocks_ = decomposition.shape()[direction];
  // Blocks of one line differ in their place along the direction only.
  const Triple shape = decomposition.shape();
  const int stride = direction == 0 ? 1 : direction == 1 ? shape[0] : shape[0] * shape[1];
  const bool takes_part = decomposition.has_cells();
  place_ = takes_part ? decomposition.rank() / stride % n_blocks_ : 0;
  if (n_blocks_ > 1)
    MPI_Comm_split(decomposition.communicator(), takes_part ? decomposition.rank() - place_ * stride : MPI_UNDEFINED,
                   place_, &line_);
  for (int p = 0; p <= n_blocks_; ++p)
    first_line_.push_back(static_cast<int>(static_cast<std::int64_t>(n_lines_) * p / n_blocks_));
  const std::size_t n_widest = panels_.empty() ? 0 : static_cast<std::size_t>(n_rows_) * std::min(width, sizes[along]);
  if (direction_ == 0) workspace_.resize(4 * n_widest);
  after_.resize(is_one_piece() ? n_widest : static_cast<std::size_t>(n_rows_) * n_lines_);
  if (is_one_piece()) return;
  before_.resize(static_cast<std::size_t>(n_rows_) * n_lines_);
  ends_.resize(6 * static_cast<std::size_t>(n_lines_));
  beside_.resize(2 * static_cast<std::size_t>(n_lines_));
  gathered_.resize(6 * static_cast<std::size_t>(n_joined()) * n_blocks_);
  answers_.resize(2 * static_cast<std::size_t>(n_joined()) * n_blocks_);
}

LineSolver::~LineSolver() {
  if (line_ != MPI_COMM_NULL) MPI_Comm_free(&line_);
}

std::size_t LineSolver::n_bytes() const {
  return (before_.size() + after_.size() + ends_.size() + gathered_.size() + answers_.size() + beside_.size() +
          workspace_.size()) *
         sizeof(double);
}

void LineSolver::solve(const Field<double>& lower, const Field<double>& diagonal, const Field<double>& upper,
                       Field<double>& solution) {
  for (const Panel& panel : panels_) eliminate(panel, lower, diagonal, upper, solution);
  if (is_one_piece() || panels_.empty()) return;
  join_blocks();
  for (const Panel& panel : panels_) complete(panel, solution);
}

void LineSolver::eliminate(const Panel& panel, const Field<double>& lower, const Field<double>& diagonal,
                           const Field<double>& upper, Field<double>& solution) {
  const auto [i, j, k] = panel.cell;
  const int n = panel.n_lines;
  const std::ptrdiff_t stride = direction_ == 1 ? solution.stride_y() : solution.stride_z();
  Rows<const double> a{lower.row(j, k) + i, direction_ == 1 ? lower.stride_y() : lower.stride_z()};
  Rows<const double> b{diagonal.row(j, k) + i, direction_ == 1 ? diagonal.stride_y() : diagonal.stride_z()};
  Rows<const double> c{upper.row(j, k) + i, direction_ == 1 ? upper.stride_y() : upper.stride_z()};
  Rows<double> x{solution.row(j, k) + i, stride};
  if (direction_ == 0) {
    const std::size_t n_values = static_cast<std::size_t>(n_rows_) * n;
    const Field<double>* const fields[4] = {&lower, &diagonal, &upper, &solution};
    for (int f = 0; f < 4; ++f)
      for (int l = 0; l < n; ++l) {
        const double* from = fields[f]->row(j + l, k);
        double* to = workspace_.data() + f * n_values + l;
        for (int r = 0; r < n_rows_; ++r) to[static_cast<std::ptrdiff_t>(r) * n] = from[r];
      }
    a = {workspace_.data(), n};
    b = {workspace_.data() + n_values, n};
    c = {workspace_.data() + 2 * n_values, n};
    x = {workspace_.data() + 3 * n_values, n};
  }
  const std::size_t offset = is_one_piece() ? 0 : static_cast<std::size_t>(panel.first_line) * n_rows_;
  double* const before = is_one_piece() ? nullptr : before_.data() + offset;
  double* const after = after_.data() + offset;
  eliminate_rows(n_rows_, n, a, b, c, x, before, after, !is_periodic_ && place_ == 0,
                 !is_periodic_ && place_ == n_blocks_ - 1);
  if (direction_ == 0) {
    for (int l = 0; l < n; ++l) {
      double* to = solution.row(j + l, k);
      for (int r = 0; r < n_rows_; ++r) to[r] = x[r][l];
    }
  }
  if (is_one_piece()) return;
  const std::ptrdiff_t last = static_cast<std::ptrdiff_t>(n_rows_ - 1) * n;
  for (int l = 0; l < n; ++l) {
    double* end = ends_.data() + 6 * static_cast<std::ptrdiff_t>(panel.first_line + l);
    end[0] = x[0][l], end[1] = before[l], end[2] = after[l];
    end[3] = x[n_rows_ - 1][l], end[4] = before[last + l], end[5] = after[last + l];
  }
}

/// Every block gets the ends of all blocks for its share of the lines, solves them and sends back what the others need.
void LineSolver::join_blocks() {
  if (n_blocks_ == 1) {
    gathered_ = ends_;
    solve_joined();
    beside_ = answers_;
    return;
  }
  std::vector<int> n_sent, sent_from, n_received, received_from;
  for (int p = 0; p < n_blocks_; ++p) {
    n_sent.push_back(6 * (first_line_[p + 1] - first_line_[p]));
    sent_from.push_back(6 * first_line_[p]);
    n_received.push_back(6 * n_joined());
    received_from.push_back(6 * n_joined() * p);
  }
  MPI_Alltoallv(ends_.data(), n_sent.data(), sent_from.data(), MPI_DOUBLE, gathered_.data(), n_received.data(),
                received_from.data(), MPI_DOUBLE, line_);
  solve_joined();
  for (int p = 0; p < n_blocks_; ++p) {
    n_sent[p] /= 3, sent_from[p] /= 3, n_received[p] /= 3, received_from[p] /= 3;
  }
  MPI_Alltoallv(answers_.data(), n_received.data(), received_from.data(), MPI_DOUBLE, beside_.data(), n_sent.data(),
                sent_from.data(), MPI_DOUBLE, line_);
  traffic_.messages += 2 * (n_blocks_ - 1);
  traffic_.bytes += static_cast<std::int64_t>(sizeof(double)) *
                    (6 * (n_lines_ - n_joined()) + 2 * static_cast<std::int64_t>(n_joined()) * (n_blocks_ - 1));
}

/// First unknown f and last unknown e of the blocks p = 0 .. P-1 of a line:
///     f_p = y_f + b_f e_(p-1) + a_f f_(p+1),   e_p = y_e + b_e e_(p-1) + a_e f_(p+1).
/// Elimination from the first block on expresses f_p and e_p by f_(p+1); in a periodic line they also depend on w =
/// e_(P-1), which stands before the first block, and f_P is v = f_0. Two equations for w and v close the ring.
void LineSolver::solve_joined() {
  struct Dependence {  // constant + on_w w + on_next f_(p+1)
    double constant, on_w, on_next;
  };
  std::vector<Dependence> first(n_blocks_), last(n_blocks_);
  const int n = n_joined();
  for (int l = 0; l < n; ++l) {
    Dependence previous{0, is_periodic_ ? 1.0 : 0.0, 0};  // e_(p-1), its on_next being that on f_p
    for (int p = 0; p < n_blocks_; ++p) {
      const double* end = gathered_.data() + 6 * (static_cast<std::ptrdiff_t>(p) * n + l);
      // f_p (1 - b_f previous.on_next) = y_f + b_f (previous.constant + previous.on_w w) + a_f f_(p+1)
      const double pivot = 1 / (1 - end[1] * previous.on_next);
      first[p] = {(end[0] + end[1] * previous.constant) * pivot, end[1] * previous.on_w * pivot, end[2] * pivot};
      last[p] = {end[3] + end[4] * (previous.constant + previous.on_next * first[p].constant),
                 end[4] * (previous.on_w + previous.on_next * first[p].on_w),
                 end[4] * previous.on_next * first[p].on_next + end[5]};
      previous = last[p];
    }
    double w = 0, v = 0;
    if (is_periodic_) {
      // f_0 by w and v alone, from the last block back.
      Dependence next{0, 0, 1};
      for (int p = n_blocks_ - 1; p >= 0; --p)
        next = {first[p].constant + first[p].on_next * next.constant, first[p].on_w + first[p].on_next * next.on_w,
                first[p].on_next * next.on_next};
      // v (1 - next.on_next) - w next.on_w = next.constant;  w (1 - previous.on_w) - v previous.on_next =
      // previous.constant
      const double determinant = (1 - next.on_next) * (1 - previous.on_w) - next.on_w * previous.on_next;
      v = (next.constant * (1 - previous.on_w) + next.on_w * previous.constant) / determinant;
      w = ((1 - next.on_next) * previous.constant + previous.on_next * next.constant) / determinant;
    }
    double f_next = v;
    for (int p = n_blocks_ - 1; p >= 0; --p) {
      double* answer = answers_.data() + 2 * (static_cast<std::ptrdiff_t>(p) * n + l);
      answer[1] = f_next;  // x_after of block p
      f_next = first[p].constant + first[p].on_w * w + first[p].on_next * f_next;
      // x_before is e_(p-1), which depends on f_p.
      answer[0] = p == 0 ? w : last[p - 1].constant + last[p - 1].on_w * w + last[p - 1].on_next * f_next;
    }
  }
}

void LineSolver::complete(const Panel& panel, Field<double>& solution) {
  const auto [i, j, k] = panel.cell;
  const int n = panel.n_lines;
  const std::size_t offset = static_cast<std::size_t>(panel.first_line) * n_rows_;
  const double* const beside = beside_.data() + 2 * static_cast<std::ptrdiff_t>(panel.first_line);
  for (int r = 0; r < n_rows_; ++r) {
    const double* before = before_.data() + offset + static_cast<std::ptrdiff_t>(r) * n;
    const double* after = after_.data() + offset + static_cast<std::ptrdiff_t>(r) * n;
    // x = particular + before x_before + after x_after
    for (int l = 0; l < n; ++l) {
      double& x = direction_ == 0   ? solution(r, j + l, k)
                  : direction_ == 1 ? solution(i + l, r, k)
                                    : solution(i + l, j, r);
      x += before[l] * beside[2 * l] + after[l] * beside[2 * l + 1];
    }
  }
}

}  // namespace couplet::flow
