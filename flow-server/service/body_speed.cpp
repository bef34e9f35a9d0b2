#include "flow-server/service/body_speed.hpp"

#include <algorithm>
#include <cmath>

#include "flow-server/immersed/moving_surface.hpp"
#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {

constexpr int n_times = 200;
constexpr Eigen::Index n_nodes_looked_at = 2000;

}  // namespace

std::optional<BodySpeed> fastest_body(const std::vector<BodySetup>& bodies, const StretchedGrid& grid,
                                      double end_time) {
  std::optional<BodySpeed> fastest;
  for (const BodySetup& body : bodies) {
    if (body.motion.is_fixed()) continue;
    const Eigen::Index n_nodes = body.mesh.n_nodes(), stride = 1 + n_nodes / n_nodes_looked_at;
    for (int n = 0; n < n_times; ++n) {
      const RigidPose pose = body.motion.pose(end_time * n / (n_times - 1));
      for (Eigen::Index node = 0; node < n_nodes; node += stride) {
        const Eigen::Vector3d at_rest = body.mesh.node_position.row(node);
        const Eigen::Vector3d at = pose.rotation * at_rest + pose.shift;
        const Eigen::Vector3d velocity = pose.rotation_rate * at_rest + pose.shift_rate;
        double cells = 0;
        for (int d = 0; d < grid.n_dimensions; ++d) cells += std::abs(velocity[d]);
        cells /= cell_width_at(grid, {at[0], at[1], at[2]});
        if (!fastest) fastest = BodySpeed{body.name, 0, 0};
        if (cells > fastest->cells) fastest->name = body.name;
        fastest->cells = std::max(fastest->cells, cells);
        fastest->speed = std::max(fastest->speed, velocity.norm());
      }
    }
  }
  return fastest;
}

std::optional<std::string> note_on_speed(const std::vector<BodySetup>& bodies, const StretchedGrid& grid, double step,
                                         double end_time) {
  const auto fastest = fastest_body(bodies, grid, end_time);
  if (!fastest || !(fastest->cells * step > 1)) return std::nullopt;
  return "body '" + fastest->name + "' passes up to " + report::text(fastest->cells * step) +
         " cells in time.step = " + report::text(step) +
         " s; the flow takes shorter steps inside it (column flow.substeps)";
}

}  // namespace couplet::flow
