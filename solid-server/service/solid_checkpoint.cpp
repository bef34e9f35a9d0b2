#include "solid-server/service/solid_checkpoint.hpp"

#include "proto/report/failure.hpp"
#include "proto/store/hdf5_file.hpp"

namespace couplet::solid {

namespace {

constexpr const char* layout = "couplet solid 1";

NodeVectors read_nodes(const store::Hdf5File& file, const std::string& name, Eigen::Index n_nodes) {
  const surface::NodeArray values = file.read(name);
  if (values.rows() != n_nodes || values.cols() != 3)
    throw report::FileError(
        file.path().string() + ": " + name,
        "holds " + std::to_string(values.rows()) + " nodes, but the body has " + std::to_string(n_nodes),
        "resume with the scene that the checkpoint was written with");
  NodeVectors nodes = NodeVectors::Zero(n_nodes, 4);
  nodes.leftCols<3>() = values;
  return nodes;
}

}  // namespace

void write_checkpoint(const std::string& path, const SolidState& state) {
  const Motion& motion = state.motion;
  auto file = store::Hdf5File::create(path);
  file.write_text("layout", layout);
  file.write_number("time", motion.time);
  file.write("displacement", motion.displacement.leftCols<3>());
  file.write("velocity", motion.velocity.leftCols<3>());
  file.write("force", motion.force.leftCols<3>());
  file.write("interface_force", motion.interface_force);
  file.write_integer("has_interface_force", motion.has_interface_force);
  file.write_integer("kicks_done", motion.n_kicks_done);
  file.write_number("stable_step", state.stable_step);
  file.write_integer("accepted_since_estimate", state.n_accepted_since_estimate);
  file.close();
}

SolidState read_checkpoint(const std::string& path, const SolidState& like) {
  const auto file = store::Hdf5File::open_for_reading(path);
  if (!file.contains("layout") || file.read_text("layout") != layout)
    throw report::FileError(path, "is not a checkpoint of this version of solid-server",
                            "resume with the version that wrote it");
  const Eigen::Index n_nodes = like.motion.displacement.rows();
  SolidState state;
  Motion& motion = state.motion;
  motion.time = file.read_number("time");
  motion.displacement = read_nodes(file, "displacement", n_nodes);
  motion.velocity = read_nodes(file, "velocity", n_nodes);
  motion.force = read_nodes(file, "force", n_nodes);
  motion.interface_force = read_nodes(file, "interface_force", like.motion.interface_force.rows()).leftCols<3>();
  motion.has_interface_force = file.read_integer("has_interface_force") != 0;
  motion.n_kicks_done = static_cast<int>(file.read_integer("kicks_done"));
  state.stable_step = file.read_number("stable_step");
  state.n_accepted_since_estimate = static_cast<int>(file.read_integer("accepted_since_estimate"));
  return state;
}

}  // namespace couplet::solid
