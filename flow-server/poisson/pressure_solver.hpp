#pragma once
// The door to every solver of the pressure equation.

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "flow-server/grid/block_decomposition.hpp"
#include "flow-server/grid/field.hpp"
#include "flow-server/grid/stretched_grid.hpp"
#include "flow-server/grid/traffic.hpp"

namespace couplet::flow {

/// Open share of each face, 0 to 1, entry i of the field of a direction being the face between the cells i and i + 1 of
/// it; entry -1 is the first face of the block. One ghost layer, filled.
using FaceFractions = std::array<Field<float>, 3>;

/// An unknown of the pressure: a cell's place in the fields, or an entry of the list of further pieces.
struct PressureUnknown {
  Triple cell{0, 0, 0};  // local index, ghosts included; of the piece's cell where there is a piece
  int piece = -1;        // index into SplitCells::cell; -1: the cell itself

  friend bool operator==(const PressureUnknown&, const PressureUnknown&) = default;
};

/// Cells that surfaces cut into several pieces have an unknown for each: one, best the largest, takes the cell's place
/// in the fields, the others stand in this list. Rows are divided by the volume of their cell like all others.
struct SplitCells {
  /// Two unknowns, one of them a piece, of the same cell or of two cells that share a face. A cell beyond an open
  /// border of the grid stands for phi = 0 on that border.
  struct Link {
    PressureUnknown a, b;
    double conductance;  // area over distance [m]: flux = conductance (phi_b - phi_a); > 0

    friend bool operator==(const Link&, const Link&) = default;
  };
  /// (n_pieces) the cell of each further piece, a local index: the cells of this rank and those of the first ghost
  /// layer, images across a periodic direction included. The pieces of one cell stand in the same order on all ranks,
  /// in ghosts too; nothing else about the order matters. Each has a link.
  std::vector<Triple> cell;
  /// Every connection that is not the one of two neighbours' fields across their face, which open_share holds (its
  /// share then counts only the part of the face that joins these two). All with at least one end in a cell of this
  /// rank: those across the border of the block are given by the ranks on both sides, those across a periodic direction
  /// from both ends.
  std::vector<Link> links;

  friend bool operator==(const SplitCells&, const SplitCells&) = default;
};

/// div grad phi = source, discretised with the cell volumes, face areas and centre distances of the grid. On a closed
/// face the normal derivative is 0; on an open face of a border of the grid phi = 0, half a cell away from the next
/// centre.
struct PressureProblem {
  const StretchedGrid* grid = nullptr;
  const BlockDecomposition* decomposition = nullptr;
  std::array<std::array<bool, 2>, 3> border_is_open{};  // whole borders; side 0: start, 1: end
  /// Where given, these count in place of border_is_open; cells without an open face are left out.
  std::optional<FaceFractions> open_share = std::nullopt;
  /// Only with open_share, on all ranks or on none (with empty lists where a rank has no split cell).
  std::optional<SplitCells> split = std::nullopt;
};

struct SolveLimits {
  double relative = 1e-6;  // of the residual norm that the start has with phi = 0
  double absolute = 0;     // residual norm [unit of the source]; whichever is reached first ends the solve
  int largest_iterations = 100;
};

struct SolveReport {
  int iterations = 0;
  int cycles = 0;            // of the multigrid; 0 for a direct solve
  double source_norm = 0;    // root of the volume-weighted mean of squares
  double true_residual = 0;  // same norm of source - div grad phi, computed in double from the solution itself
  double removed_mean = 0;   // of the source, in a problem without any open border, if the fluid is one part
  /// Integral of the source over a part of the fluid without an open border, the largest of all: what was taken out for
  /// phi to exist [unit of the source times m^3].
  double largest_defect = 0;
};

class PressureSolver {
 public:
  virtual ~PressureSolver() = default;
  /// Collective. `phi` holds the start on entry (its ghosts need not be filled) and the solution, with one filled ghost
  /// layer at neighbours, on return. In each connected part of the fluid without an open border the mean of the source
  /// is taken out and phi has mean 0. Throws NumericsError when the residual is not a number or does not fall.
  /// `piece_source` and `piece_phi`: the same for the list of further pieces (n_pieces); of the source the entries of
  /// this rank count, phi comes back with those of the ghosts.
  virtual SolveReport solve(const Field<double>& source, Field<double>& phi, const SolveLimits& limits,
                            std::span<const double> piece_source = {}, std::span<double> piece_phi = {}) = 0;
  /// Collective. open_share and split of the problem have changed, the shares only at faces of cells within the given
  /// boxes (local indices, ghosts included; any number, on each rank its own).
  virtual void update(std::span<const Box> changed) = 0;
  virtual std::size_t n_bytes() const = 0;  // memory held on this rank
  virtual Traffic traffic() const = 0;      // sent so far by this rank
};

enum class PressureMethod { automatic, multigrid, fast_diagonalisation };

/// `automatic` takes fast diagonalisation where it can be used and is expected to be faster. Throws SceneError when the
/// method cannot solve the problem.
std::unique_ptr<PressureSolver> make_pressure_solver(const PressureProblem& problem, PressureMethod method);

}  // namespace couplet::flow
