#include "flow-server/one_dimensional/fold_channel.hpp"

namespace couplet::flow {

FoldChannel::FoldChannel(const surface::SurfaceMesh& mesh, const StationAxis& axis, const GapRule& rule,
                         const MaterialLines& lines)
    : surface_(mesh),
      lines_(lines),
      section_(surface_, axis, rule, mesh.node_position(lines.exit_node, 0)),
      pressure_force_(surface_, axis),
      moved_(surface_.reference()) {
  profile_.inlet = section_.inlet();
  profile_.area.setZero(axis.n_stations());
  profile_.perimeter.setZero(axis.n_stations());
}

const SectionProfile& FoldChannel::at(const surface::NodeArray& displacement) {
  surface_.move(displacement, moved_);
  profile_.exit = moved_.x[lines_.exit_node];
  if (lines_.contraction_start_node >= 0) profile_.contraction_start = moved_.x[lines_.contraction_start_node];
  // Without a channel in front of the exit line there is nothing to measure; GlottalFlow says so.
  if (profile_.exit > profile_.inlet) section_.measure(moved_, profile_.exit, profile_.area, profile_.perimeter);
  return profile_;
}

}  // namespace couplet::flow
