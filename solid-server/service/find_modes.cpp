#include "solid-server/service/find_modes.hpp"

#include <cstdio>

#include "proto/report/failure.hpp"
#include "proto/store/run_folder.hpp"
#include "proto/store/table_file.hpp"
#include "solid-server/dynamics/work_team.hpp"
#include "solid-server/element/mass.hpp"
#include "solid-server/modal/mirror_symmetry.hpp"
#include "solid-server/service/make_setup.hpp"
#include "solid-server/service/result_output.hpp"

namespace couplet::solid {

namespace {

/// The mirror images that modes are compared with.
struct Mirror {
  std::string axis;
  MirrorPlane plane;
  std::vector<Index> mirrored;
};

std::vector<Mirror> find_mirrors(const v1::Modes& modes, const SolidMesh& mesh) {
  std::vector<Mirror> mirrors;
  for (int m = 0; m < modes.mirror_size(); ++m) {
    const int axis = modes.mirror(m) - v1::Symmetry::X;
    const MirrorPlane plane = middle_plane(mesh, axis);
    auto mirrored = mirrored_nodes(mesh, plane);
    if (!mirrored)
      throw report::SceneError("solid.modes.mirror[" + std::to_string(m) + "]",
                               "the mesh is not its own mirror image across its middle plane, " +
                                   std::string(1, "xyz"[axis]) + " = " + report::text(plane.place) + " m",
                               "leave this axis out");
    mirrors.push_back({std::string(1, "xyz"[axis]), plane, std::move(*mirrored)});
  }
  return mirrors;
}

const char* word_for(Symmetry symmetry) {
  return symmetry == Symmetry::symmetric ? "symmetric" : symmetry == Symmetry::antisymmetric ? "antisymmetric" : "-";
}

/// In the table of numbers: 1, -1 or 0.
double number_for(Symmetry symmetry) {
  return symmetry == Symmetry::symmetric ? 1 : symmetry == Symmetry::antisymmetric ? -1 : 0;
}

void print(const std::vector<Mode>& modes, const std::vector<Mirror>& mirrors,
           const std::vector<std::vector<Symmetry>>& symmetries) {
  std::printf("%4s  %12s  %6s %6s %6s", "mode", "frequency Hz", "x", "y", "z");
  for (const Mirror& mirror : mirrors) std::printf("  %13s", ("mirror " + mirror.axis).c_str());
  std::printf("  %9s\n", "residual");
  for (std::size_t m = 0; m < modes.size(); ++m) {
    const Mode& mode = modes[m];
    std::printf("%4zu  %12.6g  %5.1f%% %5.1f%% %5.1f%%", m + 1, mode.frequency, 100 * mode.direction_share[0],
                100 * mode.direction_share[1], 100 * mode.direction_share[2]);
    for (const Symmetry symmetry : symmetries[m]) std::printf("  %13s", word_for(symmetry));
    std::printf("  %9.1e\n", mode.residual);
  }
  constexpr double doubtful = 1e-6;
  for (std::size_t m = 0; m < modes.size(); ++m)
    if (modes[m].residual > doubtful)
      std::fprintf(stderr,
                   "solid-server: warning: mode %zu is known to a residual of %s only; the body is so soft in some "
                   "motions that its stiffness is lost in round-off: look at materials without shear stiffness\n",
                   m + 1, report::text(modes[m].residual).c_str());
}

/// Modes are those of the body at rest: what a user may have thought to be in them.
void say_what_is_left_out(const v1::Solid& solid) {
  if (solid.pressure_size() + solid.traction_size() + solid.node_force_size() + solid.prescribed_motion_size() +
          solid.contact_size() + solid.rigid_plane_size() >
      0)
    std::fprintf(stderr,
                 "solid-server: modes are those of the bodies at rest, without loads and contact; nodes of prescribed "
                 "motions are held\n");
}

void store(const std::string& run_folder, const SolidMesh& mesh, const std::vector<Mode>& modes,
           const std::vector<Mirror>& mirrors, const std::vector<std::vector<Symmetry>>& symmetries) {
  const store::RunFolder folder = store::make_run_folder(run_folder);
  std::vector<store::Column> columns = {{"mode", "1"},    {"frequency", "Hz"}, {"share.x", "1"},
                                        {"share.y", "1"}, {"share.z", "1"},    {"residual", "1"}};
  for (const Mirror& mirror : mirrors) columns.push_back({"mirror." + mirror.axis, "1"});
  store::TableWriter table(folder.path / "modes.csv", columns);
  store::ResultWriter shapes(folder.results(), "modes", result_mesh(mesh));
  const double extent = (mesh.node_position.colwise().maxCoeff() - mesh.node_position.colwise().minCoeff()).maxCoeff();
  for (std::size_t m = 0; m < modes.size(); ++m) {
    const Mode& mode = modes[m];
    std::vector<double> row = {static_cast<double>(m + 1), mode.frequency,          mode.direction_share[0],
                               mode.direction_share[1],    mode.direction_share[2], mode.residual};
    for (const Symmetry symmetry : symmetries[m]) row.push_back(number_for(symmetry));
    table.append(row);
    const surface::NodeArray shape = mode.shape.leftCols<3>();
    shapes.append(static_cast<double>(m + 1),
                  {{"displacement", "m", shape * (0.1 * extent / shape.rowwise().norm().maxCoeff())},
                   {"shape", "1/sqrt(kg)", shape}});
  }
}

}  // namespace

void find_modes(const participant::OpenRequest& request, const participant::ServerOptions& options) {
  if (!request.scene.has_solid())
    throw report::SceneError("solid", "the scene has no solid whose modes could be found", "give solid { ... }");
  const v1::Modes& wanted = request.scene.solid().modes();
  say_what_is_left_out(request.scene.solid());
  SolidSetup setup = make_setup(request.scene.solid(), request.scene_folder);
  const std::vector<Mirror> mirrors = find_mirrors(wanted, setup.mesh);

  WorkTeam team(worthwhile_threads(options.threads, setup));
  std::vector<double> density;
  for (const BlockProperties& block : setup.properties) density.push_back(block.density);
  const NodeVectors inverse = inverse_mass(setup.mesh, lumped_mass(setup.mesh, density), setup.supports);
  TangentSolver solver(setup.mesh, setup.properties, free_components(inverse), team);
  const std::vector<Mode> modes = modal_analysis(solver, NodeVectors::Zero(setup.mesh.n_nodes(), 4), wanted.count());

  std::vector<std::vector<Symmetry>> symmetries(modes.size());
  for (std::size_t m = 0; m < modes.size(); ++m)
    for (const Mirror& mirror : mirrors)
      symmetries[m].push_back(symmetry_of(solver, modes[m], mirror.plane, mirror.mirrored));
  print(modes, mirrors, symmetries);
  if (!request.run_folder.empty()) store(request.run_folder, setup.mesh, modes, mirrors, symmetries);
}

}  // namespace couplet::solid
