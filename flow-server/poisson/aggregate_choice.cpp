#include "flow-server/poisson/aggregate_choice.hpp"

#include <algorithm>
#include <tuple>

namespace couplet::flow {

namespace {

// Below that part of the strongest coupling of either end a face or link does not make one aggregate of two unknowns: a
// gap that is nearly closed separates the sides on coarse levels too.
constexpr double weak_coupling = 0.1;
// Cells with smaller faces, beside a wall, stay where they are: what they join hardly matters.
constexpr double sliver_share = 0.05;

}  // namespace

AggregateChoice::AggregateChoice(const FineLevel& fine, Field<float>& code)
    : fine_(fine), mine_(fine.decomposition.mine()), cell_code_(code) {
  for (int d = 0; d < 3; ++d) {
    const LevelAxis& axis = fine.axes[d];
    const Merging& merging = fine.merging[d];
    coarse_box_.begin[d] = merging.coarse_of(mine_.begin[d]);
    coarse_box_.end[d] = merging.coarse_of(mine_.end[d] - 1) + 1;
    for (int i = mine_.begin[d] - ghost_layers; i < mine_.end[d] + ghost_layers; ++i) {
      const int n = axis.n_cells(), image = i < 0 ? -1 : i >= n ? 1 : 0;
      const bool is_outside = image != 0 && !(axis.is_periodic && axis.has_terms);
      coarse_[d].push_back(
          is_outside ? outside : merging.coarse_of(i - image * n) + image * merging.n_coarse() - coarse_box_.begin[d]);
      width_[d].push_back(is_outside ? 0 : axis.width[i - image * n]);
    }
  }
  if (!fine.pieces) return;
  piece_code_.assign(static_cast<std::size_t>(fine.pieces->n_pieces()), 0.0f);
  piece_row_.assign(piece_code_.size(), nullptr);
  for (const PieceRows::Row& row : fine.pieces->rows().pieces()) {
    piece_row_[row.unknown.piece] = &row;
    if (box_of(mine_.sizes()).contains(row.unknown.cell))
      pieces_.push_back({group_number(group_of(row.unknown.cell)), row.unknown});
  }
  std::stable_sort(pieces_.begin(), pieces_.end(),
                   [](const PieceOfGroup& a, const PieceOfGroup& b) { return a.group < b.group; });
}

void AggregateChoice::cut(const Triple& C, std::vector<Triple>& members) {
  Box cells;
  for (int d = 0; d < 3; ++d) {
    cells.begin[d] = fine_.merging[d].first[C[d] + coarse_box_.begin[d]] - mine_.begin[d];
    cells.end[d] = fine_.merging[d].first[C[d] + 1 + coarse_box_.begin[d]] - mine_.begin[d];
  }
  const std::size_t group = group_number(C);
  const auto begin = std::lower_bound(pieces_.begin(), pieces_.end(), group,
                                      [](const PieceOfGroup& a, std::size_t b) { return a.group < b; });
  auto end = begin;
  while (end != pieces_.end() && end->group == group) ++end;
  const bool has_pieces = begin != end;
  if (!has_pieces && !has_weak_face(cells)) return;
  std::vector<PressureUnknown> all;
  for (int k = cells.begin[2]; k < cells.end[2]; ++k)
    for (int j = cells.begin[1]; j < cells.end[1]; ++j)
      for (int i = cells.begin[0]; i < cells.end[0]; ++i)
        if ((*fine_.inverse_diagonal)(i, j, k) != 0) all.push_back({{i, j, k}, -1});
  for (auto piece = begin; piece != end; ++piece) all.push_back(piece->unknown);
  if (all.empty()) return;
  number_parts(all, has_pieces);
  for (const PressureUnknown& u : all)
    if (u.piece < 0 && code(u) != 0) members.push_back(u.cell);
}

bool AggregateChoice::has_weak_face(const Box& cells) const {
  const Field<float>& inverse = *fine_.inverse_diagonal;
  for (int d = 0; d < 3; ++d) {
    if (!fine_.axes[d].has_terms) continue;
    for (int k = cells.begin[2]; k < cells.end[2] - (d == 2); ++k)
      for (int j = cells.begin[1]; j < cells.end[1] - (d == 1); ++j)
        for (int i = cells.begin[0]; i < cells.end[0] - (d == 0); ++i) {
          if (static_cast<double>((*fine_.share)[d](i, j, k)) >= weak_coupling) continue;
          if (inverse(i, j, k) != 0 && inverse(i + (d == 0), j + (d == 1), k + (d == 2)) != 0) return true;
        }
  }
  return false;
}

void AggregateChoice::number_parts(const std::vector<PressureUnknown>& all, bool has_pieces) {
  const std::size_t n = all.size();
  couplings_.clear();
  // Cells stand in rising order, then pieces.
  const auto is_before = [](const PressureUnknown& u, const PressureUnknown& v) {
    const bool u_is_piece = u.piece >= 0, v_is_piece = v.piece >= 0;
    if (u_is_piece != v_is_piece) return v_is_piece;
    if (u_is_piece) return u.piece < v.piece;
    return std::tie(u.cell[2], u.cell[1], u.cell[0]) < std::tie(v.cell[2], v.cell[1], v.cell[0]);
  };
  const auto place_of = [&](const PressureUnknown& u) {
    const auto at = std::lower_bound(all.begin(), all.end(), u, is_before);
    return at != all.end() && at->cell == u.cell && at->piece == u.piece ? static_cast<std::size_t>(at - all.begin())
                                                                         : n;
  };
  unknowns_.assign(n, {0, 0, 0, n, 0, 0, -1});
  for (std::size_t a = 0; a < n; ++a) {
    unknowns_[a].root = a;
    for_neighbours(all[a], [&](const PressureUnknown& other, int, int, double share, double, double) {
      Unknown& own = unknowns_[a];
      own.most = std::max(own.most, std::min(share, 1.0));
      own.sum += share;
      const std::size_t b = place_of(other);
      if (share > own.strongest) own.strongest = share, own.closest = b;
      if (b < n) couplings_.push_back({a, b, share});
    });
  }
  const auto root_of = [&](std::size_t u) {
    while (unknowns_[u].root != u) u = unknowns_[u].root = unknowns_[unknowns_[u].root].root;
    return u;
  };
  for (const Coupling& one : couplings_)
    if (one.share >= weak_coupling * std::max(unknowns_[one.a].most, unknowns_[one.b].most))
      unknowns_[root_of(one.b)].root = root_of(one.a);
  for (std::size_t a = 0; a < n; ++a)
    if (unknowns_[a].closest < n) unknowns_[root_of(unknowns_[a].closest)].root = root_of(a);
  for (std::size_t u = 0; u < n; ++u) ++unknowns_[root_of(u)].size;
  std::size_t largest = 0;  // the last of those of one size: the same choice along a sheet
  for (std::size_t u = 0; u < n; ++u)
    if (unknowns_[root_of(u)].size >= unknowns_[root_of(largest)].size) largest = u;
  int n_faces = 0, n_parts = 0;
  for (int d = 0; d < 3; ++d) n_faces += fine_.axes[d].has_terms ? 2 : 0;
  unknowns_[root_of(largest)].number = 0;
  for (std::size_t u = 0; u < n; ++u) {
    int part = 0;
    if (has_pieces || unknowns_[u].sum >= sliver_share * n_faces) {
      int& number = unknowns_[root_of(u)].number;
      if (number < 0) number = ++n_parts;
      part = number;
    }
    float& code =
        all[u].piece < 0 ? cell_code_(all[u].cell[0], all[u].cell[1], all[u].cell[2]) : piece_code_[all[u].piece];
    if (part != 0 || all[u].piece >= 0) code = static_cast<float>(part);
  }
}

}  // namespace couplet::flow
