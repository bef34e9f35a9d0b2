#include "flow-server/poisson/connected_aggregates.hpp"

#include <algorithm>
#include <map>
#include <tuple>

namespace couplet::flow {

ConnectedAggregates::ConnectedAggregates(const FineLevel& fine) : sizes_(fine.decomposition.mine().sizes()) {
  if (!fine.decomposition.has_cells()) return;
  Triple layers;
  for (int d = 0; d < 3; ++d) layers[d] = fine.axes[d].has_terms ? AggregateChoice::ghost_layers : 0;
  code_ = Field<float>(sizes_, layers);
  touched_ = CellMask(box_of(AggregateChoice(fine, code_).coarse_box().sizes()));
}

void ConnectedAggregates::update(const FineLevel& fine, const CellMask& changed, HaloExchange& halo) {
  if (!fine.decomposition.has_cells()) return;
  AggregateChoice choice(fine, code_);
  touched_.clear();
  changed.for_each([&](const Triple& cell) { touched_.add(choice.group_of(cell)); });
  for (const Member& member : members_) {
    touched_.add(member.coarse);
    if (member.unknown.piece < 0) code_(member.unknown.cell[0], member.unknown.cell[1], member.unknown.cell[2]) = 0;
  }
  if (fine.pieces)
    for (const PieceRows::Row& row : fine.pieces->rows().pieces())
      if (box_of(sizes_).contains(row.unknown.cell)) touched_.add(choice.group_of(row.unknown.cell));
  std::vector<Triple> members;
  touched_.for_each([&](const Triple& C) { choice.cut(C, members); });
  choice.exchange(halo);
  for (const ShareTerm& term : share_terms_) touched_.add_beside_face(term.direction, term.coarse);
  find_members(fine, choice, std::move(members));
  find_links(fine, choice);
  for (const ShareTerm& term : share_terms_) touched_.add_beside_face(term.direction, term.coarse);
}

void ConnectedAggregates::find_members(const FineLevel& fine, const AggregateChoice& choice,
                                       std::vector<Triple> cells) {
  members_.clear(), first_.clear(), coarse_pieces_.clear();
  const Box mine = box_of(sizes_);
  const Box& coarse_box = choice.coarse_box();
  Triple n_coarse_whole;
  for (int d = 0; d < 3; ++d) n_coarse_whole[d] = fine.merging[d].n_coarse();
  const auto global_coarse = [&](Triple C) {
    for (int d = 0; d < 3; ++d) C[d] += coarse_box.begin[d];
    return C;
  };
  std::map<std::tuple<int, int, int, int>, int> place;  // of coarse pieces: k, j, i, number
  const auto add_member = [&](const PressureUnknown& u) {
    const Triple C = choice.group_of(u.cell);
    const int number = choice.code(u);
    int piece = -1;
    if (number > 0) {
      const auto [at, is_new] = place.emplace(std::tuple(C[2], C[1], C[0], number), static_cast<int>(place.size()));
      piece = at->second;
      if (is_new) coarse_pieces_.push_back({name_of(global_coarse(C), number, n_coarse_whole), piece});
    }
    double coarse_volume = 1;
    for (int d = 0; d < 3; ++d) coarse_volume *= choice.coarse_width(d, C[d]);
    members_.push_back({u, C, piece, static_cast<float>(choice.volume(u.cell) / coarse_volume)});
  };
  std::sort(cells.begin(), cells.end(), [](const Triple& a, const Triple& b) {
    return std::tuple(a[2], a[1], a[0]) < std::tuple(b[2], b[1], b[0]);
  });
  auto next = cells.begin();
  for (int k = 0; k < sizes_[2]; ++k)
    for (int j = 0; j < sizes_[1]; ++j) {
      first_.push_back(members_.size());
      for (; next != cells.end() && (*next)[1] == j && (*next)[2] == k; ++next) add_member({*next, -1});
    }
  n_cells_ = members_.size();
  first_.push_back(n_cells_);
  if (fine.pieces)
    for (const PieceRows::Row& row : fine.pieces->rows().pieces())
      if (mine.contains(row.unknown.cell)) add_member(row.unknown);
}

void ConnectedAggregates::find_links(const FineLevel& fine, const AggregateChoice& choice) {
  coarse_links_.clear(), share_terms_.clear();
  const Box mine = box_of(sizes_);
  const Triple origin = fine.decomposition.mine().begin;
  const Box& coarse_box = choice.coarse_box();
  // Every connection of a member, once: from its lower end, inside a cell from that before the other.
  struct Term {
    GridLink link;  // cell: local coarse index
    double share;
    std::tuple<int, int, int, int, int> order;  // of the fine connection, the same on any number of ranks
  };
  std::vector<Term> terms;
  const auto add_connection = [&](const PressureUnknown& u, const PressureUnknown& v, int d, int side, double share,
                                  double area, double conductance) {
    Term term{{}, 0, {origin[2] + u.cell[2], origin[1] + u.cell[1], origin[0] + u.cell[0], u.piece, v.piece}};
    GridLink& link = term.link;
    const Triple A = choice.group_of(u.cell);
    const int number = choice.code(u);
    if (d >= 0 && choice.is_beyond_border(v.cell)) {
      // Half a width to the border on both levels.
      link = {A, d, {number, 0}, conductance * choice.width_at(d, u.cell[d]) / choice.coarse_width(d, A[d])};
      if (side < 0) --link.cell[d], std::swap(link.number[0], link.number[1]);
    } else {
      const Triple B = choice.group_of(v.cell);
      const int other = choice.code(v);
      if (A == B && number == other) return;
      link = {A, d, {number, other}, conductance};
      if (A == B) {
        link.direction = -1;  // a jump remains what it is, however wide the cells
        if (number > other) std::swap(link.number[0], link.number[1]);
      } else {
        link.conductance *=
            choice.distance(d, u.cell[d], side) / (0.5 * (choice.coarse_width(d, A[d]) + choice.coarse_width(d, B[d])));
      }
    }
    if (link.direction >= 0) {
      double coarse_area = 1;
      for (int e = 0; e < 3; ++e)
        if (e != d) coarse_area *= choice.coarse_width(e, A[e]);
      term.share = share * area / coarse_area;
    }
    terms.push_back(term);
  };
  const auto add_connections = [&](const PressureUnknown& u) {
    choice.for_neighbours(u, [&](const PressureUnknown& v, int d, int side, double share, double area, double T) {
      const bool is_beyond = choice.is_beyond_border(v.cell);
      if (d < 0 ? u.piece > v.piece : side < 0 && !is_beyond) {
        // The lower end has it, where that is a member; a regular cell of this rank has it from here.
        const bool is_from_cell = d >= 0 && v.piece < 0 && mine.contains(v.cell) && choice.code(v) == 0;
        const bool is_inside = d < 0 && v.piece < 0 && choice.code(v) == 0;
        if (is_from_cell || is_inside) add_connection(v, u, d, 1, share, area, T);
        return;
      }
      add_connection(u, v, d, side, share, area, T);
    });
  };
  for (const Member& member : members_) add_connections(member.unknown);
  // Regular cells at the upper end of the block, beside members of the next rank.
  for (int d = 0; d < 3; ++d) {
    if (!fine.axes[d].has_terms || fine.decomposition.is_at_border(d, 1)) continue;
    Box last = mine;
    last.begin[d] = last.end[d] - 1;
    for (int k = last.begin[2]; k < last.end[2]; ++k)
      for (int j = last.begin[1]; j < last.end[1]; ++j)
        for (int i = last.begin[0]; i < last.end[0]; ++i) {
          const PressureUnknown u{{i, j, k}, -1};
          if (choice.code(u) != 0 || (*fine.inverse_diagonal)(i, j, k) == 0) continue;
          Triple next = u.cell;
          ++next[d];
          if (choice.code({next, -1}) == 0 && !(fine.pieces && fine.pieces->is_linked(u.cell))) continue;
          choice.for_neighbours(u, [&](const PressureUnknown& v, int e, int side, double share, double area, double T) {
            if (e == d && side > 0 && (v.piece >= 0 || choice.code(v) != 0))
              add_connection(u, v, e, side, share, area, T);
          });
        }
  }
  const auto key = [](const Term& t) {
    const GridLink& link = t.link;
    return std::tuple(link.cell[2], link.cell[1], link.cell[0], link.direction, link.number[0], link.number[1],
                      t.order);
  };
  std::sort(terms.begin(), terms.end(), [&](const Term& a, const Term& b) { return key(a) < key(b); });
  for (const Term& term : terms) {
    GridLink link = term.link;
    for (int d = 0; d < 3; ++d) link.cell[d] += coarse_box.begin[d];
    const auto is_same = [](const GridLink& a, const GridLink& b) {
      return a.cell == b.cell && a.direction == b.direction && a.number == b.number;
    };
    if (link.number == std::array{0, 0}) {
      if (share_terms_.empty() || share_terms_.back().coarse != term.link.cell ||
          share_terms_.back().direction != link.direction)
        share_terms_.push_back({link.direction, term.link.cell, 0});
      share_terms_.back().share += term.share;
    } else if (!coarse_links_.empty() && is_same(coarse_links_.back(), link)) {
      coarse_links_.back().conductance += link.conductance;
    } else {
      coarse_links_.push_back(link);
    }
  }
}

std::span<const ConnectedAggregates::Member> ConnectedAggregates::cells(int j, int k) const {
  const auto row = static_cast<std::size_t>(j + k * sizes_[1]);
  return {members_.data() + first_[row], members_.data() + first_[row + 1]};
}

std::size_t ConnectedAggregates::n_bytes() const {
  return code_.n_bytes() + touched_.n_bytes() + members_.size() * sizeof(Member) +
         coarse_links_.size() * sizeof(GridLink) + share_terms_.size() * sizeof(ShareTerm);
}

}  // namespace couplet::flow
