#include "flow-server/output/station_results.hpp"

#include <utility>

namespace couplet::flow {

namespace {

store::ResultWriter open_writer(const std::filesystem::path& folder, const Eigen::ArrayXd& position, double time) {
  store::ResultMesh mesh{store::CellShape::polyline, surface::NodeArray::Zero(position.size(), 3), {}};
  mesh.node_position.col(0) = position.matrix();
  for (Eigen::Index k = 0; k < position.size(); ++k) mesh.cell_node.push_back(k);
  if (time > 0 && std::filesystem::exists(folder / "flow.h5")) {
    return store::ResultWriter::continue_from(folder, "flow", mesh, time);
  }
  return {folder, "flow", mesh};
}

}  // namespace

StationResults::StationResults(const std::filesystem::path& results_folder, Eigen::ArrayXd position, double time)
    : first_position_(std::move(position)), writer_(open_writer(results_folder, first_position_, time)) {}

void StationResults::append(double time, const Eigen::ArrayXd& position, const std::vector<StationField>& fields) {
  surface::NodeArray displacement = surface::NodeArray::Zero(position.size(), 3);
  displacement.col(0) = (position - first_position_).matrix();
  surface::FieldSet stored{{"displacement", "m", displacement}};
  for (const StationField& field : fields) stored.push_back({field.name, field.unit, field.values.matrix()});
  writer_.append(time, stored);
}

}  // namespace couplet::flow
