#include "flow-server/momentum/line_solver.hpp"

#include <algorithm>
#include <utility>

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

/// Thomas' algorithm on lines side by side: x becomes the solution for x_before = x_after = 0. Where `with_neighbours`,
/// a and c become how it depends on those: x + a x_before + c x_after.
void eliminate_rows(int n_rows, int n_lines, Rows<double> a, Rows<const double> b, Rows<double> c, Rows<double> x,
                    bool with_neighbours, bool starts_free, bool ends_free) {
  for (int l = 0; l < n_lines && starts_free; ++l) a[0][l] = 0;
  for (int l = 0; l < n_lines && ends_free; ++l) c[n_rows - 1][l] = 0;
  for (int r = 0; r < n_rows; ++r) {
    double* __restrict ar = a[r], * __restrict cr = c[r], * __restrict xr = x[r];
    const double* __restrict br = b[r];
    if (r == 0) {
#pragma GCC ivdep
      for (int l = 0; l < n_lines; ++l) {
        const double pivot = 1 / br[l];
        cr[l] *= pivot;
        xr[l] *= pivot;
        ar[l] *= -pivot;
      }
      continue;
    }
    const double* __restrict am = a[r - 1], * __restrict cm = c[r - 1], * __restrict xm = x[r - 1];
#pragma GCC ivdep
    for (int l = 0; l < n_lines; ++l) {
      const double pivot = 1 / (br[l] - ar[l] * cm[l]);
      cr[l] *= pivot;
      xr[l] = (xr[l] - ar[l] * xm[l]) * pivot;
      ar[l] *= -am[l] * pivot;
    }
  }
  for (int r = n_rows - 2; r >= 0; --r) {
    double* __restrict ar = a[r], * __restrict xr = x[r];
    const double* __restrict cr = c[r], * __restrict ap = a[r + 1], * __restrict xp = x[r + 1];
#pragma GCC ivdep
    for (int l = 0; l < n_lines; ++l) xr[l] -= cr[l] * xp[l];
    if (!with_neighbours) continue;
#pragma GCC ivdep
    for (int l = 0; l < n_lines; ++l) ar[l] -= cr[l] * ap[l];
  }
  if (!with_neighbours) return;
  // The last row depends on x_after by minus its factor; so do the rows before it, one through the other.
  for (int l = 0; l < n_lines; ++l) c[n_rows - 1][l] *= -1;
  for (int r = n_rows - 2; r >= 0; --r) {
    double* __restrict cr = c[r];
    const double* __restrict cp = c[r + 1];
#pragma GCC ivdep
    for (int l = 0; l < n_lines; ++l) cr[l] *= -cp[l];
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
  if (direction_ == 0) packed_.resize(static_cast<std::size_t>(4 * side_by_side) * n_rows_);
  if (is_one_piece()) return;
  ends_.resize(6 * static_cast<std::size_t>(n_lines_));
  beside_.resize(2 * static_cast<std::size_t>(n_lines_));
  gathered_.resize(6 * static_cast<std::size_t>(n_joined()) * n_blocks_);
  answers_.resize(2 * static_cast<std::size_t>(n_joined()) * n_blocks_);
}

LineSolver::~LineSolver() {
  if (line_ != MPI_COMM_NULL) MPI_Comm_free(&line_);
}

std::size_t LineSolver::n_bytes() const {
  return (ends_.size() + gathered_.size() + answers_.size() + beside_.size() + packed_.size()) * sizeof(double);
}

void LineSolver::solve(Field<double>& lower, const Field<double>& diagonal, Field<double>& upper,
                       Field<double>& solution) {
  for (const Panel& panel : panels_) eliminate(panel, lower, diagonal, upper, solution);
  if (is_one_piece() || panels_.empty()) return;
  join_blocks();
  for (const Panel& panel : panels_) complete(panel, lower, upper, solution);
}

void LineSolver::eliminate(const Panel& panel, Field<double>& lower, const Field<double>& diagonal,
                           Field<double>& upper, Field<double>& solution) {
  const auto [i, j, k] = panel.cell;
  const int n = panel.n_lines;
  const std::ptrdiff_t stride = direction_ == 1 ? solution.stride_y() : solution.stride_z();
  Rows<double> a{lower.row(j, k) + i, stride}, c{upper.row(j, k) + i, stride}, x{solution.row(j, k) + i, stride};
  Rows<const double> b{diagonal.row(j, k) + i, stride};
  if (direction_ == 0) {
    const Field<double>* const fields[4] = {&lower, &upper, &solution, &diagonal};
    const std::ptrdiff_t n_values = static_cast<std::ptrdiff_t>(n_rows_) * n;
    for (int f = 0; f < 4; ++f)
      for (int l = 0; l < n; ++l) {
        const double* from = fields[f]->row(j + l, k);
        double* to = packed_.data() + f * n_values + l;
        for (int r = 0; r < n_rows_; ++r) to[static_cast<std::ptrdiff_t>(r) * n] = from[r];
      }
    a = {packed_.data(), n}, c = {packed_.data() + n_values, n}, x = {packed_.data() + 2 * n_values, n};
    b = {packed_.data() + 3 * n_values, n};
  }
  eliminate_rows(n_rows_, n, a, b, c, x, !is_one_piece(), !is_periodic_ && place_ == 0,
                 !is_periodic_ && place_ == n_blocks_ - 1);
  if (direction_ == 0) {
    const std::pair<Field<double>*, Rows<double>> results[3] = {{&solution, x}, {&lower, a}, {&upper, c}};
    for (int f = 0; f < (is_one_piece() ? 1 : 3); ++f)
      for (int l = 0; l < n; ++l) {
        double* to = results[f].first->row(j + l, k);
        for (int r = 0; r < n_rows_; ++r) to[r] = results[f].second[r][l];
      }
  }
  if (is_one_piece()) return;
  const int last = n_rows_ - 1;
  for (int l = 0; l < n; ++l) {
    double* end = ends_.data() + 6 * static_cast<std::ptrdiff_t>(panel.first_line + l);
    end[0] = x[0][l], end[1] = a[0][l], end[2] = c[0][l];
    end[3] = x[last][l], end[4] = a[last][l], end[5] = c[last][l];
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

/// x = particular + before x_before + after x_after
void LineSolver::complete(const Panel& panel, const Field<double>& before, const Field<double>& after,
                          Field<double>& solution) {
  const auto [i, j, k] = panel.cell;
  const double* const beside = beside_.data() + 2 * static_cast<std::ptrdiff_t>(panel.first_line);
  const auto complete_row = [&](int first, int y, int z, int n, const auto& line_of) {
    const double* __restrict b = before.row(y, z) + first, * __restrict a = after.row(y, z) + first;
    double* __restrict x = solution.row(y, z) + first;
#pragma GCC ivdep
    for (int m = 0; m < n; ++m) x[m] += b[m] * beside[2 * line_of(m)] + a[m] * beside[2 * line_of(m) + 1];
  };
  if (direction_ == 0) {
    for (int l = 0; l < panel.n_lines; ++l) complete_row(0, j + l, k, n_rows_, [l](int) { return l; });
    return;
  }
  for (int r = 0; r < n_rows_; ++r)
    complete_row(i, direction_ == 1 ? r : j, direction_ == 1 ? k : r, panel.n_lines, [](int m) { return m; });
}

}  // namespace couplet::flow
