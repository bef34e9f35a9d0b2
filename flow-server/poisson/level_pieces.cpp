#include "flow-server/poisson/level_pieces.hpp"

#include <Eigen/Core>
#include <algorithm>

namespace couplet::flow {

namespace {

/// Of all pieces, or of those in a box.
std::vector<NamedPlace> names_of(const LocalSplit& local, const Box* within) {
  std::vector<NamedPlace> names;
  for (std::size_t p = 0; p < local.name.size(); ++p)
    if (!within || within->contains(local.split.cell[p])) names.push_back({local.name[p], static_cast<int>(p)});
  return names;
}

/// Unknowns of one cell; a few stand without memory from the heap.
template <int most>
using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most, most>;
template <int most>
using BlockValues = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1>;
constexpr int few = 8;

/// Elimination without exchange of rows, which an M-matrix does not need. A row that nothing outside the block holds is
/// singular: its unknown keeps its value.
template <int most>
void solve_block(Block<most>& a, BlockValues<most>& b, const BlockValues<most>& kept) {
  constexpr double round_off = 1e-14;
  const Eigen::Index n = b.size();
  const BlockValues<most> diagonal = a.diagonal();
  for (Eigen::Index p = 0; p < n; ++p) {
    if (a(p, p) <= round_off * diagonal[p]) {
      a.row(p).setZero();
      a(p, p) = 1, b[p] = kept[p];
    }
    for (Eigen::Index row = p + 1; row < n; ++row) {
      const double factor = a(row, p) / a(p, p);
      if (factor == 0) continue;
      for (Eigen::Index column = p; column < n; ++column) a(row, column) -= factor * a(p, column);
      b[row] -= factor * b[p];
    }
  }
  for (Eigen::Index p = n - 1; p >= 0; --p) {
    for (Eigen::Index column = p + 1; column < n; ++column) b[p] -= a(p, column) * b[column];
    b[p] /= a(p, p);
  }
}

}  // namespace

LevelPieces::LevelPieces(const std::vector<GridLink>& links, const std::array<LevelAxis, 3>& axes,
                         const BlockDecomposition& decomposition, const Box& range)
    : LevelPieces(
          localised(links, decomposition.mine().begin, range, decomposition.all().sizes(), decomposition.is_periodic()),
          axes, decomposition, range) {}

LevelPieces::LevelPieces(const LocalSplit& local, const std::array<LevelAxis, 3>& axes,
                         const BlockDecomposition& decomposition, const Box& range)
    : phi(local.name.size()),
      rhs(local.name.size()),
      axes_(axes),
      origin_(decomposition.mine().begin),
      mine_(box_of(decomposition.mine().sizes())),
      cell_(local.split.cell),
      names_(names_of(local, nullptr)),
      own_names_(names_of(local, &mine_)),
      rows_(local.split, axes, origin_, range),
      to_ghosts_(decomposition.communicator(), decomposition.partitions(), own_names_, names_),
      kept_rhs_(rows_.cells().size()) {
  find_cells();
}

void LevelPieces::find_cells() {
  const auto pieces = rows_.pieces();
  for (std::size_t first = 0, end = 0; first < pieces.size(); first = end) {
    const Triple& cell = pieces[first].unknown.cell;
    for (end = first + 1; end < pieces.size() && pieces[end].unknown.cell == cell;) ++end;
    PiecesOfCell one{pieces.subspan(first, end - first), nullptr, 0};
    bool is_linked_inside = false;
    for (const PieceRows::Row& piece : one.rows)
      for (const PieceRows::Entry& entry : rows_.entries(piece))
        is_linked_inside = is_linked_inside || (entry.other.cell == cell && entry.other.piece < 0);
    if (is_linked_inside)
      for (const PieceRows::Row& row : rows_.cells(cell[1], cell[2]))
        if (row.unknown.cell[0] == cell[0]) one.own = &row;
    for (int d = 0; d < 3; ++d) one.colour += origin_[d] + cell[d];
    one.colour &= 1;
    pieces_of_cell_.push_back(one);
  }
}

void LevelPieces::relax_colour(int colour, const Box& cells, const CellValues* values) {
  for (const PiecesOfCell& one : pieces_of_cell_) {
    if (one.colour != colour || !cells.contains(one.rows.front().unknown.cell)) continue;
    const PieceRows::Row* own = values ? one.own : nullptr;
    if (one.rows.size() == 1 && !own) {  // by far the most
      const PieceRows::Row& row = one.rows.front();
      double sum = -static_cast<double>(rhs[row.unknown.piece]);
      for (const PieceRows::Entry& entry : rows_.entries(row)) {
        if (entry.other.piece >= 0)
          sum += entry.coefficient * static_cast<double>(phi[entry.other.piece]);
        else if (values)
          sum += entry.coefficient *
                 static_cast<double>(values->phi(entry.other.cell[0], entry.other.cell[1], entry.other.cell[2]));
      }
      phi[row.unknown.piece] = static_cast<float>(sum / row.sum);
      continue;
    }
    if (one.rows.size() < few)
      relax_block<few>(one.rows, own, values);
    else
      relax_block<Eigen::Dynamic>(one.rows, own, values);
  }
}

template <int most>
void LevelPieces::relax_block(std::span<const PieceRows::Row> rows, const PieceRows::Row* own,
                              const CellValues* values) {
  const Triple& cell = rows.front().unknown.cell;
  const auto n_pieces = static_cast<Eigen::Index>(rows.size());
  const Eigen::Index n = n_pieces + (own ? 1 : 0);
  Block<most> a = Block<most>::Zero(n, n);
  BlockValues<most> b = BlockValues<most>::Zero(n), kept(n);
  const auto add = [&](Eigen::Index at, const PieceRows::Row& row) {
    a(at, at) += row.sum;
    for (const PieceRows::Entry& entry : rows_.entries(row)) {
      Eigen::Index other = -1;
      if (entry.other.cell == cell) {
        if (entry.other.piece < 0 && own) other = n_pieces;
        for (Eigen::Index p = 0; p < n_pieces; ++p)
          if (rows[static_cast<std::size_t>(p)].unknown.piece == entry.other.piece) other = p;
      }
      if (other >= 0)
        a(at, other) -= entry.coefficient;
      else if (entry.other.piece >= 0)
        b[at] += entry.coefficient * static_cast<double>(phi[entry.other.piece]);
      else if (values)
        b[at] += entry.coefficient *
                 static_cast<double>(values->phi(entry.other.cell[0], entry.other.cell[1], entry.other.cell[2]));
    }
  };
  for (Eigen::Index p = 0; p < n_pieces; ++p) {
    const PieceRows::Row& row = rows[static_cast<std::size_t>(p)];
    add(p, row);
    b[p] -= static_cast<double>(rhs[row.unknown.piece]);
    kept[p] = static_cast<double>(phi[row.unknown.piece]);
  }
  if (own) {
    add(n_pieces, *own);
    b[n_pieces] -= static_cast<double>(values->rhs(cell[0], cell[1], cell[2]));
    kept[n_pieces] = static_cast<double>(values->phi(cell[0], cell[1], cell[2]));
    for (int d = 0; d < 3; ++d) {
      if (!axes_[d].has_terms) continue;
      Triple before = cell, after = cell;
      --before[d], ++after[d];
      const int axis_cells = axes_[d].n_cells(), at = ((origin_[d] + cell[d]) % axis_cells + axis_cells) % axis_cells;
      const double lower = axes_[d].lower(at) * static_cast<double>(values->share[d](before[0], before[1], before[2]));
      const double upper = axes_[d].upper(at) * static_cast<double>(values->share[d](cell[0], cell[1], cell[2]));
      a(n_pieces, n_pieces) += lower + upper;
      b[n_pieces] += lower * static_cast<double>(values->phi(before[0], before[1], before[2])) +
                     upper * static_cast<double>(values->phi(after[0], after[1], after[2]));
    }
  }
  solve_block<most>(a, b, kept);
  for (Eigen::Index p = 0; p < n_pieces; ++p)
    phi[rows[static_cast<std::size_t>(p)].unknown.piece] = static_cast<float>(b[p]);
  if (own) values->phi(cell[0], cell[1], cell[2]) = static_cast<float>(b[n_pieces]);
}

bool LevelPieces::is_linked(const Triple& cell) const {
  const auto row = rows_.cells(cell[1], cell[2]);
  return std::any_of(row.begin(), row.end(), [&](const PieceRows::Row& one) { return one.unknown.cell[0] == cell[0]; });
}

double LevelPieces::link_sum(const Triple& cell) const {
  for (const PieceRows::Row& row : rows_.cells(cell[1], cell[2]))
    if (row.unknown.cell[0] == cell[0]) return row.sum;
  return 0;
}

void LevelPieces::relax_from_zero() {
  std::fill(phi.begin(), phi.end(), 0.0f);
  relax_colour(0, mine_.grown({1, 1, 1}), nullptr);
  relax_colour(1, mine_, nullptr);
  exchange(phi);
}

void LevelPieces::relax(const FaceFractions& share, const Field<float>& cell_rhs, Field<float>& cell_phi) {
  const CellValues values{share, cell_rhs, cell_phi};
  relax_colour(0, mine_.grown({1, 1, 1}), &values);
  relax_colour(1, mine_, &values);
}

void LevelPieces::take_from(Field<float>& cell_rhs) {
  std::size_t c = 0;
  for (const PieceRows::Row& row : rows_.cells()) {
    float& value = cell_rhs(row.unknown.cell[0], row.unknown.cell[1], row.unknown.cell[2]);
    kept_rhs_[c++] = value;
    double sum = static_cast<double>(value);
    for (const PieceRows::Entry& entry : rows_.entries(row))
      sum -= entry.coefficient * static_cast<double>(phi[entry.other.piece]);
    value = static_cast<float>(sum);
  }
}

void LevelPieces::restore(Field<float>& cell_rhs) const {
  std::size_t c = 0;
  for (const PieceRows::Row& row : rows_.cells())
    cell_rhs(row.unknown.cell[0], row.unknown.cell[1], row.unknown.cell[2]) = kept_rhs_[c++];
}

void LevelPieces::residual(const Field<float>& cell_phi, std::vector<float>& residual) const {
  residual.assign(phi.size(), 0.0f);
  for (const PieceRows::Row& row : rows_.pieces())
    if (mine_.contains(row.unknown.cell))
      residual[row.unknown.piece] = static_cast<float>(static_cast<double>(rhs[row.unknown.piece]) -
                                                       rows_.applied(row, cell_phi, std::span<const float>(phi)));
}

std::size_t LevelPieces::n_bytes() const {
  return (phi.size() + rhs.size() + kept_rhs_.size()) * sizeof(float) + rows_.n_bytes() +
         pieces_of_cell_.size() * sizeof(PiecesOfCell);
}

}  // namespace couplet::flow
