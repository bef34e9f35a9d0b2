#include "solid-server/service/result_output.hpp"

#include <cmath>

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

}  // namespace

store::ResultMesh result_mesh(const SolidMesh& mesh) {
  store::ResultMesh out;
  out.shape = cell_shape(mesh.block.front().shape);
  for (const ElementBlock& block : mesh.block)
    if (block.shape != mesh.block.front().shape) out.shape = store::CellShape::mixed;
  out.node_position = mesh.node_position;
  for (const ElementBlock& block : mesh.block)
    for (Index element = 0; element < block.n_elements(); ++element) {
      if (out.shape == store::CellShape::mixed) out.cell_node.push_back(store::cell_code(cell_shape(block.shape)));
      const auto nodes = block.nodes_of(element);
      out.cell_node.insert(out.cell_node.end(), nodes.begin(), nodes.end());
    }
  return out;
}

ResultOutput::ResultOutput(const v1::Output& output, const std::string& run_folder, const std::string& name,
                           const SolidMesh& mesh, double time)
    : start_(output.results_start()), interval_(output.results_interval()) {
  if (run_folder.empty() || !output.has_results_interval()) return;
  const auto folder = store::RunFolder{run_folder}.results();
  if (time > 0) {
    writer_.emplace(store::ResultWriter::continue_from(folder, name, result_mesh(mesh), time));
    next_ = std::max<std::int64_t>(0, static_cast<std::int64_t>(std::floor((time - start_) / interval_ + early)) + 1);
  } else {
    writer_.emplace(folder, name, result_mesh(mesh));
  }
}

void ResultOutput::accept(const Motion& motion) {
  const double turn = (motion.time - start_) / interval_ + early;
  if (!writer_ || turn < static_cast<double>(next_)) return;
  writer_->append(motion.time, {{"displacement", "m", motion.displacement.leftCols<3>()},
                                {"velocity", "m/s", motion.velocity.leftCols<3>()}});
  next_ = static_cast<std::int64_t>(std::floor(turn)) + 1;
}

}  // namespace couplet::solid
