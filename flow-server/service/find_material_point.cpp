#include "flow-server/service/find_material_point.hpp"

#include "proto/report/failure.hpp"

namespace couplet::flow {

std::int64_t find_material_point(const v1::MaterialPoint& point, const surface::SurfaceMesh& mesh,
                                 const std::string& field) {
  if (point.has_position()) {
    const Eigen::RowVector3d place(point.position().x(), point.position().y(), point.position().z());
    Eigen::Index nearest = 0;
    (mesh.node_position.rowwise() - place).rowwise().squaredNorm().minCoeff(&nearest);
    return nearest;
  }
  const auto found = mesh.marker.find(point.marker());
  if (found != mesh.marker.end()) return found->second;
  std::string names;
  for (const auto& [name, node] : mesh.marker) names += (names.empty() ? "" : ", ") + name;
  throw report::SceneError(field + ".marker", "the surface has no marker '" + point.marker() + "'",
                           names.empty() ? "give a position instead" : "choose one of: " + names);
}

}  // namespace couplet::flow
