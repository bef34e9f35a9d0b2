#pragma once
// One level of the multigrid on the block of one rank: smoothing, residual, and the way to the next level and back.

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "flow-server/grid/active_cells.hpp"
#include "flow-server/grid/block_decomposition.hpp"
#include "flow-server/grid/field.hpp"
#include "flow-server/grid/halo_exchange.hpp"
#include "flow-server/poisson/cell_mask.hpp"
#include "flow-server/poisson/coarsening.hpp"
#include "flow-server/poisson/level_pieces.hpp"
#include "flow-server/poisson/level_transfer.hpp"
#include "flow-server/poisson/pressure_solver.hpp"

namespace couplet::flow {

/// Levels have that many ghost layers: two smoothing steps and a residual need four layers around a block.
inline constexpr int multigrid_depth = 4;

/// Rows are divided by the cell volume. Smoothing is red-black Gauss-Seidel by the parity of the global indices; what a
/// rank computes for a ghost cell is, bit for bit, what its owner computes. Ghosts beyond a border of the whole are 0
/// always: a closed face has the coefficient 0, an open one takes phi = 0 there.
class MultigridLevel {
 public:
  /// What the faces of a level can be. With shares all are closed until set_share() and update().
  enum class Faces { whole, with_shares, with_shares_and_links };
  /// The decomposition must outlive this.
  MultigridLevel(const std::array<LevelAxis, 3>& axes, const BlockDecomposition& decomposition, Faces faces);

  /// Open share of the face between a cell of this block, or a ghost before it, and the next one. Counts from update()
  /// on.
  void set_share(int direction, const Triple& cell, float share);
  /// Collective. What depends on the shares that have been set since the last call, on any rank, is made anew, and so
  /// is the choice of the unknowns of the next level. `links`: of split cells, those with an end in four layers around
  /// this block; none: no cell of the whole is split.
  void update(const std::vector<GridLink>* links);

  const BlockDecomposition& decomposition() const { return *decomposition_; }
  const std::array<LevelAxis, 3>& axes() const { return axes_; }
  bool has_shares() const { return share_.has_value(); }
  const FaceFractions& share() const { return *share_; }  // four ghost layers, filled
  /// Collective. Parts that end on this level get numbers from `n_sealed` + 1 on; see LevelTransfer::inject. Returns
  /// how many sealed parts there are then.
  int number_parts(const Field<float>& coarse_phi, int n_sealed);
  const ActiveCells& active() const { return active_; }  // ghosts included

  LevelPieces* pieces() { return pieces_.get(); }  // where cells are split
  const LevelPieces* pieces() const { return pieces_.get(); }

  Field<float> phi, rhs;  // four ghost layers

  HaloExchange& halo() { return halo_; }

  /// Both must outlive this.
  void join(const std::array<Merging, 3>& merging, const std::array<LevelAxis, 3>& coarse_axes);
  LevelTransfer& transfer() { return *transfer_; }

  /// Two smoothing steps from phi = 0; the volume-weighted mean of the residual becomes the right-hand side of the
  /// coarse cells. Needs rhs with four filled ghost layers.
  void smooth_and_restrict(Field<float>& coarse_rhs);
  /// Adds the interpolated correction; needs one filled ghost layer of it.
  void add_correction(const Field<float>& coarse_phi, const FaceFractions* coarse_share) {
    transfer_->add_correction(coarse_phi, coarse_share, active_, phi);
  }
  /// Two smoothing steps; needs phi and rhs with four filled ghost layers.
  void smooth();
  /// One more on the pieces and what is linked to them in their cell. The ghosts of phi are to be filled after it.
  void smooth_pieces();

  std::size_t n_bytes() const;
  Traffic traffic() const;

 private:
  void mark_links();
  void set_diagonals(std::vector<char>& row_has_changed);
  void set_active(const std::vector<char>& row_has_changed);
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
  CellMask changed_;  // both cells of each face whose share has been set anew
  std::unique_ptr<LevelPieces> pieces_;
  std::optional<LevelTransfer> transfer_;
  std::vector<float> relaxed_row_, residual_row_, piece_residual_;
};

}  // namespace couplet::flow
