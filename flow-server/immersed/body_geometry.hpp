#pragma once
// Everything that one position of the bodies means for the flow.

#include <vector>

#include "flow-server/immersed/pressure_pieces.hpp"
#include "flow-server/immersed/surface_tree.hpp"
#include "flow-server/immersed/wall_layer.hpp"

namespace couplet::flow {

struct BodyFlowSettings {
  WallLayerSettings wall;
};

/// The bodies at one time and the pressure of the further pieces that goes with it: a part of the state of the flow.
class BodyGeometry {
 public:
  BodyGeometry(const FlowBlock& block, const BodyFlowSettings& settings);

  /// The same surfaces, moved; where none of them has, nothing is done anew.
  void place(std::vector<BodySurface> surfaces);

  const std::vector<BodySurface>& surfaces() const { return surfaces_; }
  const std::vector<SurfaceTree>& trees() const { return trees_; }  // of each surface
  const EdgeCrossings& crossings() const { return crossings_; }
  const CutCells& cut() const { return cut_; }
  const PressurePieces& pieces() const { return pieces_; }
  const WallLayer& layer() const { return layer_; }
  WallLayer& layer() { return layer_; }

  std::vector<double> piece_pressure;  // (n_further_parts) [Pa]

  /// Faces of this rank that were on another side of a wall at the start of the step that led here: what is remembered
  /// of them is that side's.
  struct ChangedFace {
    int component;
    Triple face;
    double closed;  // share of the surface there
  };
  std::vector<ChangedFace> changed_faces;

 private:
  std::vector<BodySurface> surfaces_;
  EdgeCrossings crossings_;
  CutCells cut_;
  PressurePieces pieces_;
  std::vector<SurfaceTree> trees_;  // of each surface
  WallLayer layer_;
};

}  // namespace couplet::flow
