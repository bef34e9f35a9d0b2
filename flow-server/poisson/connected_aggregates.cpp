#include "flow-server/poisson/connected_aggregates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

namespace couplet::flow {

namespace {

// Below that part of the strongest coupling of either end a face or link does not make one aggregate of two unknowns: a
// gap that is nearly closed separates the sides on coarse levels too.
constexpr double weak_coupling = 0.1;
// Cells with smaller faces, beside a wall, stay where they are: what they join hardly matters.
constexpr double sliver_share = 0.05;

constexpr int outside = std::numeric_limits<int>::min();
constexpr int ghost_layers = 4;

}  // namespace

/// One level while its aggregates are chosen.
class ConnectedAggregates::Choice {
 public:
  Choice(const FineLevel& fine, Field<float>& code) : fine_(fine), mine_(fine.decomposition.mine()), cell_code_(code) {
    for (int d = 0; d < 3; ++d) {
      const LevelAxis& axis = fine.axes[d];
      const Merging& merging = fine.merging[d];
      coarse_box_.begin[d] = merging.coarse_of(mine_.begin[d]);
      coarse_box_.end[d] = merging.coarse_of(mine_.end[d] - 1) + 1;
      for (int i = mine_.begin[d] - ghost_layers; i < mine_.end[d] + ghost_layers; ++i) {
        const int n = axis.n_cells(), image = i < 0 ? -1 : i >= n ? 1 : 0;
        const bool is_outside = image != 0 && !(axis.is_periodic && axis.has_terms);
        coarse_[d].push_back(is_outside ? outside
                                        : merging.coarse_of(i - image * n) + image * merging.n_coarse() -
                                              coarse_box_.begin[d]);
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

  const Box& coarse_box() const { return coarse_box_; }
  Triple group_of(const Triple& cell) const {
    return {coarse_at(0, cell[0]), coarse_at(1, cell[1]), coarse_at(2, cell[2])};
  }
  bool is_beyond_border(const Triple& cell) const {
    return coarse_at(0, cell[0]) == outside || coarse_at(1, cell[1]) == outside || coarse_at(2, cell[2]) == outside;
  }
  double width_at(int d, int i) const { return width_[d][static_cast<std::size_t>(i + ghost_layers)]; }
  double volume(const Triple& cell) const { return width_at(0, cell[0]) * width_at(1, cell[1]) * width_at(2, cell[2]); }
  double coarse_width(int d, int C) const {
    const int n = fine_.coarse_axes[d].n_cells();
    return fine_.coarse_axes[d].width[((coarse_box_.begin[d] + C) % n + n) % n];
  }
  int code(const PressureUnknown& u) const {
    return static_cast<int>(u.piece < 0 ? cell_code_(u.cell[0], u.cell[1], u.cell[2]) : piece_code_[u.piece]);
  }
  void exchange(HaloExchange& halo) {
    halo.exchange<float>({&cell_code_}, 1);
    if (fine_.pieces) fine_.pieces->exchange(piece_code_);
  }

  /// The aggregates of one coarse cell; appends its cells that do not belong to the coarse cell itself.
  void cut(const Triple& C, std::vector<Triple>& members) {
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

  /// Calls visit(other, direction, side, share, area, conductance) for each neighbour, those beyond an open border too;
  /// share: of a full face of that area; direction -1: in the same cell.
  template <class Visit>
  void for_neighbours(const PressureUnknown& u, const Visit& visit) const {
    const Triple& c = u.cell;
    const PieceRows::Row* row = u.piece < 0 ? nullptr : piece_row_[u.piece];
    if (u.piece < 0)
      for (int d = 0; d < 3; ++d) {
        if (!fine_.axes[d].has_terms) continue;
        for (const int side : {-1, 1}) {
          PressureUnknown other{c, -1};
          other.cell[d] += side;
          const Triple& face = side < 0 ? other.cell : c;
          const double share = static_cast<double>((*fine_.share)[d](face[0], face[1], face[2]));
          if (share == 0) continue;
          const double area = volume(c) / width_at(d, c[d]);
          visit(other, d, side, share, area, share * area / distance(d, c[d], side));
        }
      }
    if (!fine_.pieces) return;
    if (u.piece < 0)
      for (const PieceRows::Row& one : fine_.pieces->rows().cells(c[1], c[2]))
        if (one.unknown.cell[0] == c[0]) row = &one;
    if (!row) return;
    for (const PieceRows::Entry& entry : fine_.pieces->rows().entries(*row)) {
      int direction = -1, side = 0;
      double length = std::numeric_limits<double>::infinity();  // of the cell along the link
      for (int d = 0; d < 3; ++d) {
        if (entry.other.cell == c && fine_.axes[d].has_terms) length = std::min(length, width_at(d, c[d]));
        if (entry.other.cell[d] != c[d]) direction = d, side = entry.other.cell[d] - c[d], length = width_at(d, c[d]);
      }
      const double conductance = entry.coefficient * row->volume, area = row->volume / length;
      const double apart = direction < 0 ? length : distance(direction, c[direction], side);
      visit(entry.other, direction, side, conductance * apart / area, area, conductance);
    }
  }
  /// Between the centres of a cell and the next one, or the border.
  double distance(int d, int i, int side) const { return 0.5 * (width_at(d, i) + width_at(d, i + side)); }

 private:
  int coarse_at(int d, int i) const { return coarse_[d][static_cast<std::size_t>(i + ghost_layers)]; }
  std::size_t group_number(const Triple& C) const {
    return static_cast<std::size_t>(C[0] + coarse_box_.size(0) * (C[1] + coarse_box_.size(1) * C[2]));
  }
  bool has_weak_face(const Box& cells) const {
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

  void number_parts(const std::vector<PressureUnknown>& all, bool has_pieces) {
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

  const FineLevel& fine_;
  Box mine_, coarse_box_;  // in indices of the whole
  Field<float>& cell_code_;
  std::array<std::vector<int>, 3> coarse_;        // local coarse index of each cell from the first ghost on
  std::array<std::vector<double>, 3> width_;      // likewise; 0 beyond a border
  std::vector<float> piece_code_;                 // (n_pieces)
  std::vector<const PieceRows::Row*> piece_row_;  // (n_pieces) none: too far off
  struct Coupling {
    std::size_t a, b;
    double share;
  };
  /// Of those that become one coarse cell.
  struct Unknown {
    double most, sum;  // of its couplings, capped at a full face; of all
    double strongest;
    std::size_t closest;  // across the strongest coupling, where it is of the same coarse cell
    std::size_t root;     // of the tree of those that are connected
    int size, number;     // of what is connected, at its root
  };
  std::vector<Coupling> couplings_;
  std::vector<Unknown> unknowns_;
  struct PieceOfGroup {
    std::size_t group;
    PressureUnknown unknown;
  };
  std::vector<PieceOfGroup> pieces_;  // of this block, in rising order of groups
};

ConnectedAggregates::ConnectedAggregates(const FineLevel& fine) : sizes_(fine.decomposition.mine().sizes()) {
  if (!fine.decomposition.has_cells()) return;
  Triple layers;
  for (int d = 0; d < 3; ++d) layers[d] = fine.axes[d].has_terms ? ghost_layers : 0;
  code_ = Field<float>(sizes_, layers);
  touched_ = CellMask(box_of(Choice(fine, code_).coarse_box().sizes()));
}

void ConnectedAggregates::update(const FineLevel& fine, const CellMask& changed, HaloExchange& halo) {
  if (!fine.decomposition.has_cells()) return;
  Choice choice(fine, code_);
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

void ConnectedAggregates::find_members(const FineLevel& fine, const Choice& choice, std::vector<Triple> cells) {
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

void ConnectedAggregates::find_links(const FineLevel& fine, const Choice& choice) {
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
