#pragma once
// The points of the interface that the scene follows, as columns of history.csv.

#include <cstdint>
#include <string>
#include <vector>

#include "couplet/v1/output.pb.h"
#include "proto/store/table_file.hpp"
#include "proto/surface/surface_field.hpp"

namespace couplet::store {

struct InterfaceProbe {
  std::string name;
  std::int64_t node = 0;  // of the surface
};

/// The node of a point: that of the marker, or the one nearest to the position. Throws SceneError listing the markers.
std::int64_t find_node(const v1::MaterialPoint& point, const surface::SurfaceMesh& surface, const std::string& where);

std::vector<InterfaceProbe> make_probes(const v1::Output& output, const surface::SurfaceMesh& surface);

/// NAME.x, NAME.y, NAME.z [m] of each.
std::vector<Column> probe_columns(const std::vector<InterfaceProbe>& probes);

/// Appends the numbers under these columns; displacement (n_nodes, 3).
void append_probe_values(const std::vector<InterfaceProbe>& probes, const surface::NodeArray& displacement,
                         std::vector<double>& row);

}  // namespace couplet::store
