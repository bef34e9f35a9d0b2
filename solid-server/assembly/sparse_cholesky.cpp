#include "solid-server/assembly/sparse_cholesky.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <string>

#include "proto/report/failure.hpp"
#include "solid-server/assembly/elimination_order.hpp"
#include "solid-server/assembly/front_kernels.hpp"
#include "solid-server/dynamics/work_team.hpp"

namespace couplet::solid {

namespace {

std::size_t at(Index n) {
  return static_cast<std::size_t>(n);
}

// Columns that are eliminated before the columns to the right are updated; also the width of the tiles of an update.
constexpr Index panel_columns = 128;
// Rows of a tile: with its columns it stays in the second-level cache.
constexpr Index tile_rows = 512;

}  // namespace

/// One member alone has a branch; all members share a front of the trunk: tiles go round among them. Which one computes
/// a tile does not change it.
struct SparseCholesky::Crew {
  int member, n_members;
  WorkTeam* team;
  SmallBlock* inverse;  // of the diagonal block at hand

  void barrier() const {
    if (n_members > 1) team->barrier();
  }
  bool owns(Index tile) const { return tile % n_members == member; }
  bool owns_column(Index column) const { return owns(column / 64); }
};

void SparseCholesky::AlignedDelete::operator()(double* values) const {
  std::free(values);
}

SparseCholesky::Values SparseCholesky::allocate(std::size_t n) {
  const std::size_t n_bytes = (std::max(n, std::size_t{1}) * sizeof(double) + 63) / 64 * 64;
  return Values(static_cast<double*>(std::aligned_alloc(64, n_bytes)));
}

SparseCholesky::SparseCholesky(const NodePairs& pairs, const FreeComponents& free, WorkTeam& team) : team_(team) {
  tree_ = make_front_tree(pairs, free, elimination_order(pairs, n_free_of_nodes(free)));
  std::size_t place = 0;
  for (const FrontTree::Front& front : tree_.front) {
    n_operations_ += front.n_operations;
    update_place_.push_back(place);
    place += at(FrontTree::padded(front.n_rows));
  }
  diagonal_place_.resize(at(tree_.n_unknowns));
  for (Index node = 0; node < pairs.n_nodes(); ++node)
    for (std::size_t i = 0; i < 3; ++i)
      if (const Index unknown = tree_.unknown[3 * at(node) + i]; unknown >= 0)
        diagonal_place_[at(unknown)] = 9 * at(pairs.start[at(node)]) + 4 * i;
  sign_.resize(at(tree_.n_unknowns));
  diagonal_.resize(at(tree_.n_unknowns));
  update_.resize(tree_.front.size());
  // The system grants more memory than there is; a run that uses it is ended without a word.
  const auto physical = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  if (static_cast<double>(memory_bytes()) > physical) refuse_size();
  factor_ = allocate(tree_.factor_size);
  if (!factor_) refuse_size();
}

std::size_t SparseCholesky::memory_bytes() const {
  return (tree_.factor_size + tree_.update_size) * sizeof(double) + tree_.entry.size() * sizeof(FrontTree::Entry) +
         tree_.row.size() * sizeof(Index) + tree_.run.size() * sizeof(FrontTree::Run);
}

void SparseCholesky::refuse_size() const {
  throw report::NumericsError(
      "solver",
      "the factors of " + std::to_string(tree_.n_unknowns) + " unknowns need " +
          report::text(static_cast<double>(memory_bytes()) / 1e9) + " GB of memory, more than there is",
      "coarsen the mesh, integrate explicitly (time_integration), or use a machine with more memory");
}

void SparseCholesky::refuse_pivot() const {
  const auto found = std::find(tree_.unknown.begin(), tree_.unknown.end(), bad_unknown_.load());
  const auto place = static_cast<std::size_t>(found - tree_.unknown.begin());
  throw report::NumericsError(
      "solver",
      std::string("the stiffness matrix is singular or not a number at the ") + "xyz"[place % 3] +
          " component of node " + std::to_string(place / 3),
      "hold the body against every rigid motion and connect all its parts; if it is held, take smaller steps");
}

void SparseCholesky::factorise(const std::vector<double>& blocks) {
  for (std::size_t n = 0; n < diagonal_.size(); ++n) diagonal_[n] = blocks[diagonal_place_[n]];
  next_branch_ = 0;
  lacks_memory_ = false;
  bad_unknown_ = -1;
  SmallBlock inverse_of_trunk;
  team_.run([&](int member) {
    SmallBlock inverse;
    const Crew alone{0, 1, nullptr, &inverse};
    for (std::size_t b = next_branch_++; b < tree_.branch.size(); b = next_branch_++)
      for (Index f = tree_.branch[b].first; f < tree_.branch[b].last; ++f) eliminate(alone, f, blocks);
    const Crew all{member, team_.n_members(), &team_, &inverse_of_trunk};
    all.barrier();
    for (const Index f : tree_.trunk) eliminate(all, f, blocks);
  });
  for (Values& update : update_) update.reset();
  if (lacks_memory_) refuse_size();
  if (bad_unknown_ >= 0) refuse_pivot();
  n_negative_ = static_cast<int>(std::count(sign_.begin(), sign_.end(), -1.0));
}

void SparseCholesky::eliminate(const Crew& crew, Index f, const std::vector<double>& blocks) {
  const FrontTree::Front& front = tree_.front[at(f)];
  if (crew.member == 0) {
    update_[at(f)] = allocate(at(front.n_rows) * at(FrontTree::padded(front.n_rows)));
    if (!update_[at(f)]) lacks_memory_ = true;
  }
  crew.barrier();
  if (lacks_memory_) return;
  fill(crew, f, blocks);
  crew.barrier();
  if (crew.member == 0)
    for (Index c = front.first_child; c < front.last_child; ++c) update_[at(tree_.child[at(c)])].reset();
  factorise_columns(crew, f);
  update_rows(crew, f);
  crew.barrier();
}

/// The matrix and what the children leave, each member for its own columns.
void SparseCholesky::fill(const Crew& crew, Index f, const std::vector<double>& blocks) {
  const FrontTree::Front& front = tree_.front[at(f)];
  const auto leading = at(front.leading()), update_leading = at(FrontTree::padded(front.n_rows));
  double* const L = factor_.get() + front.place;
  for (Index j = 0; j < front.n_columns; ++j)
    if (crew.owns_column(j)) std::memset(L + at(j) * leading, 0, leading * sizeof(double));
  for (Index j = 0; j < front.n_rows; ++j)
    if (crew.owns_column(front.n_columns + j)) {
      const auto first = at(j / panel_columns * panel_columns);  // the tile on the diagonal is computed as a whole
      std::memset(update_[at(f)].get() + at(j) * update_leading + first, 0, (update_leading - first) * sizeof(double));
    }

  for (std::size_t e = front.first_entry; e < front.last_entry; ++e) {
    const FrontTree::Entry& entry = tree_.entry[e];
    const double* block = &blocks[9 * at(entry.pair)];
    const int row_step = entry.is_transposed ? 1 : 3, column_step = entry.is_transposed ? 3 : 1;
    Index column = entry.column;
    for (int k = 0; k < 3; ++k) {
      if (!(entry.free_of_column >> k & 1)) continue;
      double* target = L + at(column) * leading + at(entry.row);
      if (crew.owns_column(column++))
        for (int i = 0; i < 3; ++i)
          if (entry.free_of_row >> i & 1) *target++ += block[i * row_step + k * column_step];
    }
  }
  for (Index c = front.first_child; c < front.last_child; ++c) take_child(crew, f, tree_.child[at(c)]);
}

void SparseCholesky::take_child(const Crew& crew, Index f, Index child) {
  const FrontTree::Front &front = tree_.front[at(f)], &from = tree_.front[at(child)];
  const auto leading = at(front.leading()), update_leading = at(FrontTree::padded(front.n_rows));
  double* const L = factor_.get() + front.place;
  const FrontTree::Run* const last = tree_.run.data() + from.last_run;
  for (const FrontTree::Run* run = tree_.run.data() + from.first_run; run != last; ++run)
    for (Index t = 0; t < run->length; ++t) {
      const Index j = run->from + t, to = run->to + t;
      if (!crew.owns_column(to)) continue;
      const double* source = update_[at(child)].get() + at(j) * at(FrontTree::padded(from.n_rows));
      double* target = to < front.n_columns
                           ? L + at(to) * leading
                           : update_[at(f)].get() + at(to - front.n_columns) * update_leading - at(front.n_columns);
      for (const FrontTree::Run* rows = run; rows != last; ++rows) {
        const Index skipped = rows == run ? t : 0;
        double* __restrict sum = target + at(rows->to + skipped);
        const double* __restrict part = source + at(rows->from + skipped);
        for (Index n = 0; n < rows->length - skipped; ++n) sum[n] += part[n];
      }
    }
}

/// Panel by panel; inside a panel block by block.
void SparseCholesky::factorise_columns(const Crew& crew, Index f) {
  const FrontTree::Front& front = tree_.front[at(f)];
  const Index size = front.size(), n_columns = front.n_columns;
  const auto leading = at(front.leading());
  double* const L = factor_.get() + front.place;
  double* const sign = &sign_[at(front.first_column)];
  const auto tile = [&](Index row, Index column, Index n_rows, Index n) {
    return Tile(L + at(column) * leading + at(row), n_rows, n, Eigen::OuterStride<>(front.leading()));
  };
  const auto for_own_tiles = [&](Index first, const auto& visit) {
    Index count = 0;
    for (Index row = first; row < size; row += tile_rows)
      if (crew.owns(count++)) visit(row, std::min(tile_rows, size - row));
  };
  for (Index panel = 0; panel < n_columns; panel += panel_columns) {
    const Index panel_end = std::min(panel + panel_columns, n_columns);
    for (Index j = panel; j < panel_end; j += block_columns) {
      const Index width = std::min<Index>(block_columns, panel_end - j), next = j + width, right = panel_end - next;
      if (crew.member == 0) {
        const int bad =
            factorise_block(tile(j, j, width, width), &diagonal_[at(front.first_column + j)], sign + j, *crew.inverse);
        if (bad >= 0) {
          const Index unknown = front.first_column + j + bad;
          Index known = bad_unknown_;
          while ((known < 0 || unknown < known) && !bad_unknown_.compare_exchange_weak(known, unknown)) continue;
        }
      }
      crew.barrier();
      for_own_tiles(next, [&](Index row, Index n_rows) {
        const Eigen::MatrixXd below = tile(row, j, n_rows, width);
        tile(row, j, n_rows, width).noalias() = below * crew.inverse->topLeftCorner(width, width).transpose();
      });
      crew.barrier();
      if (right == 0) continue;
      for_own_tiles(next, [&](Index row, Index n_rows) {
        subtract_product(tile(row, next, n_rows, right), tile(row, j, n_rows, width), tile(next, j, right, width),
                         sign + j);
      });
      crew.barrier();
    }
    Index count = 0;
    for (Index column = panel_end; column < n_columns; column += panel_columns)
      for (Index row = column; row < size; row += tile_rows) {
        if (!crew.owns(count++)) continue;
        const Index n_rows = std::min(tile_rows, size - row), n = std::min(panel_columns, n_columns - column),
                    depth = panel_end - panel;
        subtract_product(tile(row, column, n_rows, n), tile(row, panel, n_rows, depth), tile(column, panel, n, depth),
                         sign + panel);
      }
    crew.barrier();
  }
}

/// What is left on the rows below: minus L_below S L_below^T.
void SparseCholesky::update_rows(const Crew& crew, Index f) {
  const FrontTree::Front& front = tree_.front[at(f)];
  const Index update_leading = FrontTree::padded(front.n_rows);
  const auto below = [&](Index row, Index n) {
    return ConstTile(factor_.get() + front.place + at(front.n_columns + row), n, front.n_columns,
                     Eigen::OuterStride<>(front.leading()));
  };
  Index count = 0;
  for (Index column = 0; column < front.n_rows; column += panel_columns)
    for (Index row = column; row < front.n_rows; row += tile_rows) {
      if (!crew.owns(count++)) continue;
      const Index n_rows = std::min(tile_rows, front.n_rows - row), n = std::min(panel_columns, front.n_rows - column);
      subtract_product(Tile(update_[at(f)].get() + at(column) * at(update_leading) + at(row), n_rows, n,
                            Eigen::OuterStride<>(update_leading)),
                       below(row, n_rows), below(column, n), &sign_[at(front.first_column)]);
    }
}

NodeVectors SparseCholesky::solve(const NodeVectors& rhs) const {
  Eigen::VectorXd unknowns(tree_.n_unknowns), updates(static_cast<Eigen::Index>(tree_.update_size));
  for (std::size_t n = 0; n < tree_.unknown.size(); ++n)
    if (const Index unknown = tree_.unknown[n]; unknown >= 0)
      unknowns[unknown] = rhs(static_cast<Index>(n / 3), static_cast<Index>(n % 3));
  std::atomic<std::size_t> next_forward{0}, next_backward{0};
  team_.run([&](int member) {
    for (std::size_t b = next_forward++; b < tree_.branch.size(); b = next_forward++)
      for (Index f = tree_.branch[b].first; f < tree_.branch[b].last; ++f)
        solve_forward(f, unknowns.data(), updates.data());
    team_.barrier();
    if (member == 0) {
      for (const Index f : tree_.trunk) solve_forward(f, unknowns.data(), updates.data());
      for (std::size_t t = tree_.trunk.size(); t-- > 0;) solve_backward(tree_.trunk[t], unknowns.data());
    }
    team_.barrier();
    for (std::size_t b = next_backward++; b < tree_.branch.size(); b = next_backward++)
      for (Index f = tree_.branch[b].last; f-- > tree_.branch[b].first;) solve_backward(f, unknowns.data());
  });
  NodeVectors solution = NodeVectors::Zero(rhs.rows(), 4);
  for (std::size_t n = 0; n < tree_.unknown.size(); ++n)
    if (const Index unknown = tree_.unknown[n]; unknown >= 0)
      solution(static_cast<Index>(n / 3), static_cast<Index>(n % 3)) = unknowns[unknown];
  return solution;
}

/// S y of L y = b; what it takes from later unknowns goes to `updates`.
void SparseCholesky::solve_forward(Index f, double* unknowns, double* updates) const {
  const FrontTree::Front& front = tree_.front[at(f)];
  Eigen::VectorXd b = Eigen::VectorXd::Zero(front.size());
  Eigen::Map<Eigen::VectorXd> x(unknowns + front.first_column, front.n_columns);
  b.head(front.n_columns) = x;
  for (Index c = front.first_child; c < front.last_child; ++c) {
    const FrontTree::Front& child = tree_.front[at(tree_.child[at(c)])];
    const double* part = updates + update_place_[at(tree_.child[at(c)])];
    for (std::size_t r = child.first_run; r < child.last_run; ++r)
      for (Index n = 0; n < tree_.run[r].length; ++n) b[tree_.run[r].to + n] += part[tree_.run[r].from + n];
  }
  const double* L = factor_.get() + front.place;
  const Eigen::OuterStride<> leading(front.leading());
  auto y = b.head(front.n_columns);
  ConstTile(L, front.n_columns, front.n_columns, leading).triangularView<Eigen::Lower>().solveInPlace(y);
  auto rest = b.tail(front.n_rows);
  rest.noalias() -= ConstTile(L + front.n_columns, front.n_rows, front.n_columns, leading) * y;
  Eigen::Map<Eigen::VectorXd>(updates + update_place_[at(f)], front.n_rows) = rest;
  x = y.cwiseProduct(Eigen::Map<const Eigen::VectorXd>(&sign_[at(front.first_column)], front.n_columns));
}

/// L^T x = S y.
void SparseCholesky::solve_backward(Index f, double* unknowns) const {
  const FrontTree::Front& front = tree_.front[at(f)];
  Eigen::VectorXd b(front.size());
  Eigen::Map<Eigen::VectorXd> x(unknowns + front.first_column, front.n_columns);
  b.head(front.n_columns) = x;
  for (Index r = 0; r < front.n_rows; ++r) b[front.n_columns + r] = unknowns[tree_.row[front.first_row + at(r)]];
  const double* L = factor_.get() + front.place;
  const Eigen::OuterStride<> leading(front.leading());
  auto y = b.head(front.n_columns);
  y.noalias() -=
      ConstTile(L + front.n_columns, front.n_rows, front.n_columns, leading).transpose() * b.tail(front.n_rows);
  ConstTile(L, front.n_columns, front.n_columns, leading).transpose().triangularView<Eigen::Upper>().solveInPlace(y);
  x = y;
}

}  // namespace couplet::solid
