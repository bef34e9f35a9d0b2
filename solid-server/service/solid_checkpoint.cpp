#include "solid-server/service/solid_checkpoint.hpp"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include "proto/checksum/crc32c.hpp"
#include "proto/report/failure.hpp"
#include "proto/store/hdf5_file.hpp"

namespace couplet::solid {

namespace {

constexpr const char* layout = "couplet solid 5";

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

void write_estimate(store::Hdf5File& file, const StepEstimate& estimate) {
  file.write_number("stable_step", estimate.stable_step);
  file.write("estimate_displacement", estimate.displacement->leftCols<3>());
  file.write_integer("estimate_accepted", estimate.n_accepted);
  file.write_integer("estimate_substeps", estimate.n_substeps);
  file.write_integer("estimate_unseen", estimate.n_unseen);
  file.write_number("estimate_change", estimate.change);
}

StepEstimate read_estimate(const store::Hdf5File& file, Eigen::Index n_nodes) {
  StepEstimate estimate;
  estimate.stable_step = file.read_number("stable_step");
  estimate.displacement = std::make_shared<const NodeVectors>(read_nodes(file, "estimate_displacement", n_nodes));
  estimate.n_accepted = static_cast<int>(file.read_integer("estimate_accepted"));
  estimate.n_substeps = static_cast<int>(file.read_integer("estimate_substeps"));
  estimate.n_unseen = static_cast<int>(file.read_integer("estimate_unseen"));
  estimate.change = file.read_number("estimate_change");
  return estimate;
}

/// What the factors were made from: the same numbers give the same factors.
void write_factors(store::Hdf5File& file, const KeptFactors& factors) {
  const FactorOrigin& origin = *factors.origin;
  file.write("factor_strained", origin.strained.leftCols<3>());
  file.write("factor_displacement", origin.displacement.leftCols<3>());
  if (origin.increment.rows() > 0) file.write("factor_increment", origin.increment.leftCols<3>());
  file.write_number("factor_time", origin.time);
  file.write_number("factor_stiffness", origin.weights.stiffness);
  file.write_number("factor_mass", origin.weights.mass);
  file.write_number("factor_external_stiffness", origin.external_stiffness);
  file.write_integer("factor_steps", factors.n_steps);
  file.write_integer("factor_iterations", factors.n_iterations);
  file.write_integer("factors_are_worn", factors.are_worn);
}

KeptFactors read_factors(const store::Hdf5File& file, Eigen::Index n_nodes) {
  FactorOrigin origin;
  origin.strained = read_nodes(file, "factor_strained", n_nodes);
  origin.displacement = read_nodes(file, "factor_displacement", n_nodes);
  if (file.contains("factor_increment")) origin.increment = read_nodes(file, "factor_increment", n_nodes);
  origin.time = file.read_number("factor_time");
  origin.weights = {file.read_number("factor_stiffness"), file.read_number("factor_mass")};
  origin.external_stiffness = file.read_number("factor_external_stiffness");
  KeptFactors factors;
  factors.origin = std::make_shared<const FactorOrigin>(std::move(origin));
  factors.n_steps = static_cast<int>(file.read_integer("factor_steps"));
  factors.n_iterations = static_cast<int>(file.read_integer("factor_iterations"));
  factors.are_worn = file.read_integer("factors_are_worn") != 0;
  return factors;
}

}  // namespace

SolidIdentity identity_of(const SolidMesh& mesh, const v1::Solid& solid) {
  SolidIdentity identity;
  const auto add = [&](const auto& values) {
    identity.mesh =
        checksum::crc32c(values.data(), static_cast<std::size_t>(values.size()) * sizeof *values.data(), identity.mesh);
  };
  add(mesh.node_position);
  for (const ElementBlock& block : mesh.block) add(block.node);

  std::string text;
  {
    google::protobuf::io::StringOutputStream stream(&text);
    google::protobuf::io::CodedOutputStream coded(&stream);
    coded.SetSerializationDeterministic(true);
    solid.SerializeToCodedStream(&coded);
  }
  identity.scene = checksum::crc32c(text.data(), text.size());
  return identity;
}

void write_checkpoint(const std::string& path, const SolidState& state, const SolidIdentity& identity) {
  const Motion& motion = state.motion;
  auto file = store::Hdf5File::create(path);
  file.write_text("layout", layout);
  file.write_integer("mesh_checksum", identity.mesh);
  file.write_integer("scene_checksum", identity.scene);
  file.write_number("time", motion.time);
  file.write("displacement", motion.displacement.leftCols<3>());
  file.write("velocity", motion.velocity.leftCols<3>());
  file.write("force", motion.force.leftCols<3>());
  file.write("interface_force", motion.interface_force);
  file.write_integer("has_interface_force", motion.has_interface_force);
  file.write_integer("kicks_done", motion.n_kicks_done);
  file.write_number("external_work", motion.external_work);
  file.write_number("damping_work", motion.damping_work);
  file.write_integer("method", static_cast<int>(state.method));
  file.write_text("why_method", state.why_method);
  file.write_integer("halvings", motion.n_halvings);
  if (motion.estimate.displacement) write_estimate(file, motion.estimate);
  if (motion.acceleration.rows() > 0) file.write("acceleration", motion.acceleration.leftCols<3>());
  if (motion.factors.origin) write_factors(file, motion.factors);
  file.close();
}

StoredState read_checkpoint(const std::string& path, const SolidState& like, const SolidIdentity& identity) {
  const auto file = store::Hdf5File::open_for_reading(path);
  if (!file.contains("layout") || file.read_text("layout") != layout)
    throw report::FileError(path, "is not a checkpoint of this version of solid-server",
                            "resume with the version that wrote it");
  const Eigen::Index n_nodes = like.motion.displacement.rows();
  StoredState stored;
  stored.is_of_this_scene = file.read_integer("scene_checksum") == identity.scene;
  SolidState& state = stored.state;
  Motion& motion = state.motion;
  motion.time = file.read_number("time");
  motion.displacement = read_nodes(file, "displacement", n_nodes);
  if (file.read_integer("mesh_checksum") != identity.mesh)
    throw report::FileError(
        path, "was written for another mesh: it has as many nodes, but at other places, or other elements between them",
        "resume with the mesh that the checkpoint was written with");
  motion.velocity = read_nodes(file, "velocity", n_nodes);
  motion.force = read_nodes(file, "force", n_nodes);
  motion.interface_force = read_nodes(file, "interface_force", like.motion.interface_force.rows()).leftCols<3>();
  motion.has_interface_force = file.read_integer("has_interface_force") != 0;
  motion.n_kicks_done = static_cast<int>(file.read_integer("kicks_done"));
  motion.external_work = file.read_number("external_work");
  motion.damping_work = file.read_number("damping_work");
  state.method = static_cast<TimeMethod>(file.read_integer("method"));
  state.why_method = file.read_text("why_method");
  motion.n_halvings = static_cast<int>(file.read_integer("halvings"));
  if (file.contains("acceleration")) motion.acceleration = read_nodes(file, "acceleration", n_nodes);
  if (!stored.is_of_this_scene) return stored;
  if (file.contains("stable_step")) motion.estimate = read_estimate(file, n_nodes);
  if (file.contains("factor_time")) motion.factors = read_factors(file, n_nodes);
  return stored;
}

}  // namespace couplet::solid
