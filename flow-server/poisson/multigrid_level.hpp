#pragma once
// One level of the multigrid on the block of one rank: smoothing, residual, and the way to the next level and back.

#include <array>
#include <optional>
#include <vector>

#include "flow-server/grid/active_cells.hpp"
#include "flow-server/grid/block_decomposition.hpp"
#include "flow-server/grid/field.hpp"
#include "flow-server/grid/halo_exchange.hpp"
#include "flow-server/poisson/coarsening.hpp"
#include "flow-server/poisson/pressure_solver.hpp"

namespace couplet::flow {

/// Levels have that many ghost layers: two smoothing steps and a residual need four layers around a block.
inline constexpr int multigrid_depth = 4;

/// How the cells of this block are joined to coarse ones in one direction; coarse indices are local to the coarse block
/// that lies over this one.
struct BlockMerging {
  struct Run {
    int first_fine, first_coarse, n_coarse, group_size;
  };
  std::vector<Run> runs;       // of coarse cells that hold equally many fine ones
  std::vector<int> coarse;     // (n) of each fine cell
  std::vector<float> share;    // (n) width of the fine cell over that of the coarse one
  std::vector<int> neighbour;  // (n) the coarse cell on the other side of the fine centre
  std::vector<float> weight;   // (n) of that neighbour in linear interpolation between coarse centres
  int n_coarse = 0;
};

/// Rows are divided by the cell volume. Smoothing is red-black Gauss-Seidel by the parity of the global indices; what a
/// rank computes for a ghost cell is, bit for bit, what its owner computes. Ghosts beyond a border of the whole are 0
/// always: a closed face has the coefficient 0, an open one takes phi = 0 there.
class MultigridLevel {
 public:
  /// `share`: open shares of the faces, not yet filled in the ghost layers, or nothing where borders are whole.
  /// The decomposition must outlive this. Collective.
  MultigridLevel(const std::array<LevelAxis, 3>& axes, const BlockDecomposition& decomposition,
                 std::optional<FaceFractions> share);

  const BlockDecomposition& decomposition() const { return *decomposition_; }
  const std::array<LevelAxis, 3>& axes() const { return axes_; }
  bool has_shares() const { return share_.has_value(); }
  const FaceFractions& share() const { return *share_; }  // four ghost layers, filled
  const ActiveCells& active() const { return active_; }   // ghosts included

  Field<float> phi, rhs;  // four ghost layers

  HaloExchange& halo() { return halo_; }

  /// `coarse_origin`: global index of the first coarse cell of the coarse block that lies over this one.
  void join(const std::array<Merging, 3>& merging, const std::array<LevelAxis, 3>& coarse_axes);
  Box coarse_box() const { return coarse_box_; }  // global indices of the coarse cells over this block

  /// Two smoothing steps from phi = 0; the volume-weighted mean of the residual becomes the right-hand side of the
  /// coarse cells. Needs rhs with four filled ghost layers.
  void smooth_and_restrict(Field<float>& coarse_rhs);
  /// Adds the interpolated correction; needs one filled ghost layer of it.
  void add_correction(const Field<float>& coarse_phi, const FaceFractions* coarse_share);
  /// Two smoothing steps; needs phi and rhs with four filled ghost layers.
  void smooth();

  /// Open shares of the faces of the coarse cells over this block: area-weighted means. Entry -1 at a border included.
  FaceFractions coarse_shares() const;

  std::size_t n_bytes() const;

 private:
  Box range(int depth) const;  // local cells and ghosts that other blocks (or their images) own
  struct RowCoefficients;
  template <bool has_share>
  RowCoefficients coefficients_at(int j, int k) const;
  template <bool starts_at_zero, bool has_share>
  void relax_plane(int k, const Box& range, int colour);
  template <bool has_share>
  void restrict_plane(int k, Field<float>& coarse_rhs);
  template <bool has_share>
  void smooth_and_restrict_all(Field<float>& coarse_rhs);
  template <bool has_share>
  void smooth_all();

  std::array<LevelAxis, 3> axes_;
  const BlockDecomposition* decomposition_;
  HaloExchange halo_;
  Triple sizes_;
  // A periodic direction with one block needs no work in ghost layers: the first row is the last one's neighbour. Not
  // along z, in which half-sweeps follow one another.
  std::array<bool, 3> wraps_{};
  std::array<std::vector<float>, 3> lower_, upper_, sum_;  // (n + 2 * depth) coefficients from the first ghost on
  std::vector<float> pattern_;                             // over-relaxation at even places, 0 at odd ones
  std::optional<FaceFractions> share_;
  Field<float> inverse_diagonal_;  // where there are shares; 0: inactive
  ActiveCells active_;
  std::array<BlockMerging, 3> merging_;
  Box coarse_box_;
  std::vector<float> relaxed_row_, residual_row_, base_row_, slope_row_;
};

}  // namespace couplet::flow
