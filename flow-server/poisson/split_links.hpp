#pragma once
// The links of split cells under names that all ranks share, and their way to the ranks that need them.

#include <span>
#include <vector>

#include "flow-server/poisson/coarsening.hpp"
#include "flow-server/poisson/piece_exchange.hpp"
#include "flow-server/poisson/pressure_solver.hpp"

namespace couplet::flow {

/// A link from a cell to the next one along a direction, or inside the cell.
struct GridLink {
  Triple cell{0, 0, 0};             // of the lower end, in indices of the whole
  int direction = -1;               // -1: both ends in the cell
  std::array<int, 2> number{0, 0};  // of the unknown in its cell, lower end first; see UnknownName
  double conductance = 0;
};

/// The number of each piece among those of its cell, from 1 on.
std::vector<int> piece_numbers(const SplitCells& split);

/// The names of all pieces in the list, with their places; `number`: see piece_numbers(). Of these, those of the cells
/// of this rank.
std::vector<NamedPlace> piece_names(const SplitCells& split, std::span<const int> number,
                                    const BlockDecomposition& decomposition);
std::vector<NamedPlace> own_piece_names(const SplitCells& split, std::vector<NamedPlace> names,
                                        const BlockDecomposition& decomposition);

/// The links whose lower end lies on this rank: each link of the whole is among those of exactly one.
std::vector<GridLink> own_links(const SplitCells& split, std::span<const int> number,
                                const BlockDecomposition& decomposition);

/// Collective. All links with an end in the box of this rank among `boxes`, one box a rank, in indices of the whole;
/// boxes may reach beyond the ends of periodic directions.
std::vector<GridLink> links_in(const std::vector<Box>& boxes, const std::vector<GridLink>& own,
                               const BlockDecomposition& decomposition);

/// Pieces and links in local indices of a block.
struct LocalSplit {
  SplitCells split;               // pieces in rising order of (k, j, i, number)
  std::vector<UnknownName> name;  // (n_pieces)
};

/// The links with an end in the local box `range`, with their images across periodic directions.
LocalSplit localised(const std::vector<GridLink>& links, const Triple& origin, const Box& range, const Triple& n_cells,
                     const std::array<bool, 3>& is_periodic);

}  // namespace couplet::flow
