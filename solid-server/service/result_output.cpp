#include "solid-server/service/result_output.hpp"

#include <cmath>
#include <iterator>

#include "proto/store/run_folder.hpp"

namespace couplet::solid {

namespace {

// Times add up over many steps: a state this share of an interval before its turn counts as on time.
constexpr double early = 1e-6;

store::CellShape cell_shape(ElementShape shape) {
  switch (shape) {
    case ElementShape::hexahedron20:
      return store::CellShape::hexahedron20;
    case ElementShape::hexahedron8:
      return store::CellShape::hexahedron8;
    case ElementShape::tetrahedron10:
      return store::CellShape::tetrahedron10;
  }
  return store::CellShape::mixed;
}

/// The fields that are computed from the motion; numbers of bodies and regions are not among them.
std::vector<TissueField> tissue_fields(const v1::Solid& solid) {
  std::vector<TissueField> wanted;
  for (const int field : solid.field()) switch (static_cast<v1::Solid::Field>(field)) {
      case v1::Solid::CAUCHY_STRESS:
        wanted.push_back(TissueField::cauchy_stress);
        break;
      case v1::Solid::LARGEST_PRINCIPAL_STRESS:
        wanted.push_back(TissueField::largest_principal_stress);
        break;
      case v1::Solid::VON_MISES_STRESS:
        wanted.push_back(TissueField::von_mises_stress);
        break;
      case v1::Solid::VOLUME_RATIO:
        wanted.push_back(TissueField::volume_ratio);
        break;
      case v1::Solid::FIBRE_STRETCH:
        wanted.push_back(TissueField::fibre_stretch);
        break;
      case v1::Solid::FIBRE_DIRECTION:
        wanted.push_back(TissueField::fibre_direction);
        break;
      case v1::Solid::BODY_NUMBER:
      case v1::Solid::REGION_NUMBER:
        break;
    }
  return wanted;
}

/// One number a block, for each of its elements.
store::ResultMesh::CellNumber number_of_elements(const std::string& name, const SolidMesh& mesh,
                                                 const std::vector<int>& of_block) {
  store::ResultMesh::CellNumber number{name, {}};
  for (std::size_t b = 0; b < mesh.block.size(); ++b)
    number.value.insert(number.value.end(), static_cast<std::size_t>(mesh.block[b].n_elements()), of_block[b]);
  return number;
}

std::vector<store::ResultMesh::CellNumber> cell_numbers(const v1::Solid& solid, const SolidMesh& mesh) {
  std::vector<store::ResultMesh::CellNumber> numbers;
  std::vector<int> body;
  for (const ElementBlock& block : mesh.block) body.push_back(block.body);
  for (const int field : solid.field()) {
    if (field == v1::Solid::BODY_NUMBER) numbers.push_back(number_of_elements("body_number", mesh, body));
    if (field == v1::Solid::REGION_NUMBER)
      numbers.push_back(number_of_elements("region_number", mesh, region_numbers(mesh)));
  }
  return numbers;
}

}  // namespace

store::ResultMesh result_mesh(const SolidMesh& mesh) {
  return result_mesh(mesh, shared_nodes(mesh));
}

store::ResultMesh result_mesh(const SolidMesh& mesh, const RegionNodes& nodes) {
  store::ResultMesh out;
  out.shape = cell_shape(mesh.block.front().shape);
  for (const ElementBlock& block : mesh.block)
    if (block.shape != mesh.block.front().shape) out.shape = store::CellShape::mixed;
  out.node_position = mesh.node_position(nodes.origin, Eigen::all);
  for (std::size_t b = 0; b < mesh.block.size(); ++b) {
    const ElementShape shape = mesh.block[b].shape;
    const auto n_nodes = static_cast<std::size_t>(topology(shape).n_nodes);
    const std::vector<Index>& node = nodes.block[b];
    for (std::size_t first = 0; first < node.size(); first += n_nodes) {
      if (out.shape == store::CellShape::mixed) out.cell_node.push_back(store::cell_code(cell_shape(shape)));
      out.cell_node.insert(out.cell_node.end(), &node[first], &node[first] + n_nodes);
    }
  }
  return out;
}

ResultOutput::ResultOutput(const v1::Scene& scene, const std::string& run_folder, const SolidModel& model)
    : start_(scene.output().results_start()), interval_(scene.output().results_interval()) {
  if (run_folder.empty() || !scene.output().has_results_interval()) return;
  tissue_.emplace(model.mesh(), model.properties(), tissue_fields(scene.solid()));
  store::ResultMesh mesh = result_mesh(model.mesh(), tissue_->nodes());
  mesh.cell_number = cell_numbers(scene.solid(), model.mesh());
  const auto folder = store::RunFolder{run_folder}.results();
  const std::string& name = scene.solid().body(0).name();
  const double time = model.accepted().motion.time;
  if (time > 0) {
    writer_.emplace(store::ResultWriter::continue_from(folder, name, mesh, time));
    next_ = std::max<std::int64_t>(0, static_cast<std::int64_t>(std::floor((time - start_) / interval_ + early)) + 1);
  } else {
    writer_.emplace(folder, name, mesh);
  }
}

surface::NodeArray ResultOutput::at_result_nodes(const NodeVectors& values) const {
  const std::vector<Index>& origin = tissue_->nodes().origin;
  surface::NodeArray out(static_cast<Eigen::Index>(origin.size()), 3);
  for (std::size_t n = 0; n < origin.size(); ++n)
    out.row(static_cast<Eigen::Index>(n)) = values.row(origin[n]).head<3>();
  return out;
}

void ResultOutput::accept(const Motion& motion) {
  const double turn = (motion.time - start_) / interval_ + early;
  if (!writer_ || turn < static_cast<double>(next_)) return;
  TissueState tissue = tissue_->at(motion.displacement);
  surface::FieldSet at_nodes = {{"displacement", "m", at_result_nodes(motion.displacement)},
                                {"velocity", "m/s", at_result_nodes(motion.velocity)}};
  std::move(tissue.at_nodes.begin(), tissue.at_nodes.end(), std::back_inserter(at_nodes));
  writer_->append(motion.time, at_nodes, tissue.of_elements);
  next_ = static_cast<std::int64_t>(std::floor(turn)) + 1;
}

}  // namespace couplet::solid
