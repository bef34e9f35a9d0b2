#include "flow-server/output/surface_results.hpp"

namespace couplet::flow {

namespace {

surface::NodeArray rows_of(const std::vector<Point>& points) {
  surface::NodeArray rows(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t d = 0; d < 3; ++d) rows(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(d)) = points[i][d];
  return rows;
}

store::ResultWriter open_writer(const std::filesystem::path& folder, const BodySurface& surface, double time) {
  store::ResultMesh mesh{store::CellShape::triangle, rows_of(surface.position), {}};
  for (const auto& corners : surface.triangle)
    mesh.cell_node.insert(mesh.cell_node.end(), corners.begin(), corners.end());
  if (time > 0 && std::filesystem::exists(folder / (surface.name + ".h5")))
    return store::ResultWriter::continue_from(folder, surface.name, mesh, time);
  return {folder, surface.name, mesh};
}

}  // namespace

SurfaceResults::SurfaceResults(const std::filesystem::path& results_folder, const BodySurface& at_rest, double time)
    : at_rest_(at_rest.position), writer_(open_writer(results_folder, at_rest, time)) {}

void SurfaceResults::append(double time, const BodySurface& surface, const std::vector<SurfaceResult>& results) {
  surface::FieldSet of_corners{{"displacement", "m", rows_of(surface.position) - rows_of(at_rest_)},
                               {"velocity", "m/s", rows_of(surface.velocity)}};
  surface::FieldSet of_triangles;
  for (const SurfaceResult& result : results)
    (result.is_of_triangles ? of_triangles : of_corners).push_back({result.name, result.unit, result.values});
  writer_.append(time, of_corners, of_triangles);
}

}  // namespace couplet::flow
