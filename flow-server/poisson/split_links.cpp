#include "flow-server/poisson/split_links.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <utility>

namespace couplet::flow {

namespace {

constexpr int link_tag = 310;

/// Shifts by the length of periodic directions, so that cell + shift may lie in ghosts.
std::vector<Triple> image_shifts(const Triple& n_cells, const std::array<bool, 3>& is_periodic) {
  std::vector<Triple> shifts;
  const auto reach = [&](int d) { return is_periodic[d] ? 1 : 0; };
  for (int z = -reach(2); z <= reach(2); ++z)
    for (int y = -reach(1); y <= reach(1); ++y)
      for (int x = -reach(0); x <= reach(0); ++x) shifts.push_back({x * n_cells[0], y * n_cells[1], z * n_cells[2]});
  return shifts;
}

Triple moved(Triple cell, const Triple& by) {
  for (int d = 0; d < 3; ++d) cell[d] += by[d];
  return cell;
}

Triple upper_end(const GridLink& link) {
  Triple cell = link.cell;
  if (link.direction >= 0) ++cell[link.direction];
  return cell;
}

bool touches(const GridLink& link, const Box& box, const std::vector<Triple>& shifts) {
  return std::any_of(shifts.begin(), shifts.end(), [&](const Triple& shift) {
    return box.contains(moved(link.cell, shift)) || box.contains(moved(upper_end(link), shift));
  });
}

}  // namespace

std::vector<int> piece_numbers(const SplitCells& split) {
  std::vector<std::size_t> order(split.cell.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto is_before = [&](std::size_t a, std::size_t b) {
    return std::tie(split.cell[a], a) < std::tie(split.cell[b], b);
  };
  std::sort(order.begin(), order.end(), is_before);
  std::vector<int> number(order.size(), 1);
  for (std::size_t n = 1; n < order.size(); ++n)
    if (split.cell[order[n]] == split.cell[order[n - 1]]) number[order[n]] = number[order[n - 1]] + 1;
  return number;
}

std::vector<NamedPlace> piece_names(const SplitCells& split, std::span<const int> number,
                                    const BlockDecomposition& decomposition) {
  std::vector<NamedPlace> names;
  for (std::size_t p = 0; p < split.cell.size(); ++p)
    names.push_back({name_of(moved(split.cell[p], decomposition.mine().begin), number[p], decomposition.all().sizes()),
                     static_cast<int>(p)});
  return names;
}

std::vector<NamedPlace> own_piece_names(const SplitCells& split, std::vector<NamedPlace> names,
                                        const BlockDecomposition& decomposition) {
  const Box mine = box_of(decomposition.mine().sizes());
  std::erase_if(names,
                [&](const NamedPlace& one) { return !mine.contains(split.cell[static_cast<std::size_t>(one.place)]); });
  return names;
}

std::vector<GridLink> own_links(const SplitCells& split, std::span<const int> number,
                                const BlockDecomposition& decomposition) {
  const Box mine = decomposition.mine();
  const auto number_of = [&](const PressureUnknown& unknown) { return unknown.piece < 0 ? 0 : number[unknown.piece]; };
  std::vector<GridLink> own;
  for (const SplitCells::Link& link : split.links) {
    const PressureUnknown *lower = &link.a, *upper = &link.b;
    GridLink one;
    for (int d = 0; d < 3; ++d) {
      if (link.a.cell[d] != link.b.cell[d]) one.direction = d;
      if (link.a.cell[d] > link.b.cell[d]) std::swap(lower, upper);
    }
    bool is_own = box_of(mine.sizes()).contains(lower->cell);
    // The end beyond a border has no owner.
    if (one.direction >= 0 && lower->cell[one.direction] < 0 && decomposition.is_at_border(one.direction, 0))
      is_own = box_of(mine.sizes()).contains(upper->cell);
    if (!is_own) continue;
    one.cell = moved(lower->cell, mine.begin);
    one.number = {number_of(*lower), number_of(*upper)};
    one.conductance = link.conductance;
    own.push_back(one);
  }
  return own;
}

std::vector<GridLink> links_in(const std::vector<Box>& boxes, const std::vector<GridLink>& own,
                               const BlockDecomposition& decomposition) {
  const Triple n_cells = decomposition.all().sizes();
  const std::vector<Triple> shifts = image_shifts(n_cells, decomposition.is_periodic());
  const auto n_ranks = static_cast<std::size_t>(decomposition.n_ranks());
  const MPI_Comm communicator = decomposition.communicator();
  std::vector<std::vector<GridLink>> sent(n_ranks), received(n_ranks);
  std::vector<int> n_sent(n_ranks), n_received(n_ranks);
  for (std::size_t rank = 0; rank < n_ranks; ++rank) {
    for (const GridLink& link : own)
      if (touches(link, boxes[rank], shifts)) sent[rank].push_back(link);
    n_sent[rank] = static_cast<int>(sent[rank].size());
  }
  MPI_Alltoall(n_sent.data(), 1, MPI_INT, n_received.data(), 1, MPI_INT, communicator);
  std::vector<MPI_Request> requests;
  for (std::size_t rank = 0; rank < n_ranks; ++rank) {
    if (n_received[rank] == 0) continue;
    if (static_cast<int>(rank) == decomposition.rank()) {
      received[rank] = sent[rank];
      continue;
    }
    received[rank].resize(static_cast<std::size_t>(n_received[rank]));
    requests.emplace_back();
    MPI_Irecv(received[rank].data(), static_cast<int>(received[rank].size() * sizeof(GridLink)), MPI_BYTE,
              static_cast<int>(rank), link_tag, communicator, &requests.back());
  }
  for (std::size_t rank = 0; rank < n_ranks; ++rank) {
    if (sent[rank].empty() || static_cast<int>(rank) == decomposition.rank()) continue;
    requests.emplace_back();
    MPI_Isend(sent[rank].data(), static_cast<int>(sent[rank].size() * sizeof(GridLink)), MPI_BYTE,
              static_cast<int>(rank), link_tag, communicator, &requests.back());
  }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  std::vector<GridLink> all;
  for (const std::vector<GridLink>& part : received) all.insert(all.end(), part.begin(), part.end());
  return all;
}

LocalSplit localised(const std::vector<GridLink>& links, const Triple& origin, const Box& range, const Triple& n_cells,
                     const std::array<bool, 3>& is_periodic) {
  struct Ends {
    Triple lower, upper;
    const GridLink* link;
  };
  std::vector<Ends> found;
  // Number of the cell in the range with one layer around it, number of the piece in the cell.
  const Box around = range.grown({1, 1, 1});
  using Piece = std::pair<std::int64_t, int>;
  const auto piece_of = [&](const Triple& cell, int number) {
    const Triple at{cell[0] - around.begin[0], cell[1] - around.begin[1], cell[2] - around.begin[2]};
    return Piece(at[0] + around.size(0) * (at[1] + static_cast<std::int64_t>(around.size(1)) * at[2]), number);
  };
  std::vector<Piece> pieces;
  for (const Triple& shift : image_shifts(n_cells, is_periodic))
    for (const GridLink& link : links) {
      Ends ends{moved(link.cell, shift), moved(upper_end(link), shift), &link};
      for (int d = 0; d < 3; ++d) ends.lower[d] -= origin[d], ends.upper[d] -= origin[d];
      if (!range.contains(ends.lower) && !range.contains(ends.upper)) continue;
      found.push_back(ends);
      if (link.number[0] > 0) pieces.push_back(piece_of(ends.lower, link.number[0]));
      if (link.number[1] > 0) pieces.push_back(piece_of(ends.upper, link.number[1]));
    }
  std::sort(pieces.begin(), pieces.end());
  pieces.erase(std::unique(pieces.begin(), pieces.end()), pieces.end());
  LocalSplit local;
  for (const auto& [at, number] : pieces) {
    const std::int64_t nx = around.size(0), ny = around.size(1);
    const Triple cell{around.begin[0] + static_cast<int>(at % nx), around.begin[1] + static_cast<int>(at / nx % ny),
                      around.begin[2] + static_cast<int>(at / nx / ny)};
    local.split.cell.push_back(cell);
    local.name.push_back(name_of(moved(cell, origin), number, n_cells));
  }
  const auto unknown = [&](const Triple& cell, int number) {
    if (number == 0) return PressureUnknown{cell, -1};
    const auto at = std::lower_bound(pieces.begin(), pieces.end(), piece_of(cell, number));
    return PressureUnknown{cell, static_cast<int>(at - pieces.begin())};
  };
  for (const Ends& ends : found)
    local.split.links.push_back(
        {unknown(ends.lower, ends.link->number[0]), unknown(ends.upper, ends.link->number[1]), ends.link->conductance});
  return local;
}

}  // namespace couplet::flow
