#pragma once
// The channel between a moving fold and its mirror image.

#include <cstdint>

#include "flow-server/one_dimensional/fold_surface.hpp"
#include "flow-server/one_dimensional/glottal_section.hpp"
#include "flow-server/one_dimensional/pressure_force.hpp"
#include "flow-server/one_dimensional/section_profile.hpp"

namespace couplet::flow {

/// The two material lines, by the nodes that mark them, preferably at mid length.
struct MaterialLines {
  std::int64_t exit_node = 0;                // x_b
  std::int64_t contraction_start_node = -1;  // x_a; negative: none
};

/// Motion of the fold in, shape of the channel and force on the fold out. `axis` must outlive this.
class FoldChannel {
 public:
  FoldChannel(const surface::SurfaceMesh& mesh, const StationAxis& axis, const GapRule& rule,
              const MaterialLines& lines);
  FoldChannel(const FoldChannel&) = delete;
  FoldChannel& operator=(const FoldChannel&) = delete;

  /// The channel when the nodes are displaced by (n_nodes, 3) [m].
  const SectionProfile& at(const surface::NodeArray& displacement);

  /// Force (n_nodes, 3) [N] of the flow through the channel of the last at().
  void find_force(const GlottalSolution& flow, const EndPressures& pressures, surface::NodeArray& force) {
    pressure_force_.find(moved_, flow, pressures, force);
  }

 private:
  FoldSurface surface_;
  MaterialLines lines_;
  GlottalSection section_;
  PressureForce pressure_force_;
  NodePositions moved_;
  SectionProfile profile_;
};

}  // namespace couplet::flow
