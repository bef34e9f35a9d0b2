#include "proto/store/interface_probe.hpp"

#include "proto/report/failure.hpp"

namespace couplet::store {

namespace {

[[noreturn]] void refuse_marker(const std::string& marker, const surface::SurfaceMesh& surface,
                                const std::string& where) {
  std::string names;
  for (const auto& [name, node] : surface.marker) names += (names.empty() ? "" : ", ") + name;
  throw report::SceneError(where, "the surface has no marker '" + marker + "'",
                           names.empty() ? "it has none; give a position" : "its markers are: " + names);
}

}  // namespace

std::int64_t find_node(const v1::MaterialPoint& point, const surface::SurfaceMesh& surface, const std::string& where) {
  if (point.has_marker()) {
    const auto found = surface.marker.find(point.marker());
    if (found == surface.marker.end()) refuse_marker(point.marker(), surface, where);
    return found->second;
  }
  if (surface.n_nodes() == 0) throw report::SceneError(where, "the surface has no nodes to follow");
  const Eigen::RowVector3d position(point.position().x(), point.position().y(), point.position().z());
  Eigen::Index nearest = 0;
  (surface.node_position.rowwise() - position).rowwise().squaredNorm().minCoeff(&nearest);
  return nearest;
}

std::vector<InterfaceProbe> make_probes(const v1::Output& output, const surface::SurfaceMesh& surface) {
  std::vector<InterfaceProbe> probes;
  for (int index = 0; index < output.probe_size(); ++index) {
    const v1::Probe& probe = output.probe(index);
    const std::string where = "output.probe[" + std::to_string(index) + "].at";
    probes.push_back({probe.name(), find_node(probe.at(), surface, where)});
  }
  return probes;
}

std::vector<Column> probe_columns(const std::vector<InterfaceProbe>& probes) {
  std::vector<Column> columns;
  for (const InterfaceProbe& probe : probes) {
    for (const char* axis : {".x", ".y", ".z"}) columns.push_back({probe.name + axis, "m"});
  }
  return columns;
}

void append_probe_values(const std::vector<InterfaceProbe>& probes, const surface::NodeArray& displacement,
                         std::vector<double>& row) {
  for (const InterfaceProbe& probe : probes) {
    for (int axis = 0; axis < 3; ++axis) row.push_back(displacement(probe.node, axis));
  }
}

}  // namespace couplet::store
