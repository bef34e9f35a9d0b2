#include "flow-server/service/make_flow_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "flow-server/one_dimensional/glottis_model.hpp"
#include "flow-server/service/body_speed.hpp"
#include "flow-server/service/find_material_point.hpp"
#include "flow-server/service/make_navier_stokes.hpp"
#include "proto/report/failure.hpp"
#include "proto/scene/expression.hpp"
#include "proto/scene/make_time_table.hpp"

namespace couplet::flow {

namespace {

GlottalModel glottal_model(v1::Glottis::Model model) {
  switch (model) {
    case v1::Glottis::B1:
      return GlottalModel::b1;
    case v1::Glottis::B2:
      return GlottalModel::b2;
    case v1::Glottis::M1:
      return GlottalModel::m1;
    case v1::Glottis::M2:
      return GlottalModel::m2;
  }
  throw report::SceneError("flow.glottis.model", "it is not B1, B2, M1 or M2");
}

GlottalLaw make_law(const v1::Fluid& fluid, const v1::Glottis& glottis) {
  GlottalLaw law;
  law.model = glottal_model(glottis.model());
  law.density = fluid.density();
  law.viscosity = fluid.viscosity();
  law.unsteady = glottis.unsteady();
  if (glottis.time_derivative() == v1::Glottis::BDF2) law.time_derivative = TimeDerivative::bdf2;
  if (law.model == GlottalModel::m1 || law.model == GlottalModel::m2) {
    law.friction_coefficient = glottis.friction_coefficient();
    law.friction_only_where_converging = glottis.friction_range() == v1::Glottis::CONVERGING_PART;
    law.smallest_recovery = glottis.smallest_recovery();
  }
  if (law.model == GlottalModel::m2) law.entrance_contraction = glottis.entrance_contraction();
  return law;
}

GlottisOptions make_options(const v1::Flow& flow) {
  const v1::Glottis& glottis = flow.glottis();
  GlottisOptions options;
  options.law = make_law(flow.fluid(), glottis);
  options.n_stations = glottis.stations();
  options.exit_pressure = glottis.exit_pressure();
  options.largest_driving_pressure = std::abs(options.exit_pressure);
  for (const auto& row : glottis.subglottal_pressure().row()) {
    options.largest_driving_pressure =
        std::max(options.largest_driving_pressure, std::abs(row.value() - options.exit_pressure));
  }
  options.subglottal_pressure = [table = scene::make_time_table(glottis.subglottal_pressure())](double t) {
    return table.at(t);
  };
  return options;
}

FoldOptions make_fold(const v1::Glottis& glottis, const surface::SurfaceMesh& mesh) {
  if (!glottis.has_midplane()) {
    throw report::SceneError("flow.glottis.midplane", "it is missing",
                             "with a solid it says where the mirror plane between the folds lies");
  }
  if (!glottis.has_exit_line()) {
    throw report::SceneError(
        "flow.glottis.exit_line", "it is missing",
        "with a solid it says where the glottis ends, for example marker: \"superior_fillet_middle\"");
  }
  FoldOptions fold;
  fold.surface = mesh;
  fold.gap = {glottis.midplane(), glottis.smallest_gap(), glottis.half_length(), glottis.strips_per_element()};
  fold.lines.exit_node = find_material_point(glottis.exit_line(), mesh, "flow.glottis.exit_line");
  if (glottis.model() == v1::Glottis::M2) {
    if (!glottis.has_entrance_start()) {
      throw report::SceneError(
          "flow.glottis.entrance_start", "it is missing",
          "M2 needs the line where the contraction begins, for example marker: \"inferior_middle\"");
    }
    fold.lines.contraction_start_node =
        find_material_point(glottis.entrance_start(), mesh, "flow.glottis.entrance_start");
  }
  return fold;
}

PrescribedChannel::Shape make_channel(const v1::Glottis& glottis) {
  const v1::PrescribedChannel& channel = glottis.channel();
  PrescribedChannel::Shape shape;
  shape.length = channel.length();
  shape.width = channel.width();
  auto formula = std::make_shared<scene::Expression>(channel.height());
  shape.height = [formula](double x, double t) { return formula->at(x, 0, 0, t); };
  if (glottis.model() == v1::Glottis::M2) {
    if (!glottis.entrance_start().has_position()) {
      throw report::SceneError("flow.glottis.entrance_start", "M2 in a prescribed channel needs a position",
                               "give position { x: ... }");
    }
    shape.contraction_start = glottis.entrance_start().position().x();
  }
  return shape;
}

std::unique_ptr<FlowModel> make_glottis(const v1::Scene& scene, const std::optional<surface::SurfaceMesh>& mesh) {
  const v1::Glottis& glottis = scene.flow().glottis();
  const GlottisOptions options = make_options(scene.flow());
  if (glottis.has_channel()) {
    if (scene.has_solid()) {
      throw report::SceneError("flow.glottis.channel", "the scene has a prescribed channel and a solid",
                               "leave out one of them");
    }
    return std::make_unique<GlottisModel>(options, make_channel(glottis));
  }
  if (!mesh) {
    throw report::SceneError("flow.glottis", "there is neither a solid nor a channel to flow through",
                             "add a solid, or flow.glottis.channel to compute the flow alone");
  }
  return std::make_unique<GlottisModel>(options, make_fold(glottis, *mesh));
}

void refuse_more_ranks_than_one(MPI_Comm ranks) {
  int n_ranks = 1;
  if (ranks != MPI_COMM_NULL) MPI_Comm_size(ranks, &n_ranks);
  if (n_ranks == 1) return;
  throw report::SceneError("flow.glottis", "one-dimensional flow runs on one rank, not on " + std::to_string(n_ranks),
                           "start flow-server with one rank");
}

std::unique_ptr<FlowModel> make_navier_stokes_model(const v1::Scene& scene, const std::filesystem::path& scene_folder,
                                                    const std::optional<surface::SurfaceMesh>& surface,
                                                    MPI_Comm ranks) {
  NavierStokesOptions options = make_navier_stokes(scene, scene_folder, surface);
  const auto on_speed = note_on_speed(options.bodies, options.setup.grid, scene.time().step(), scene.time().end());
  auto model = std::make_unique<NavierStokesModel>(std::move(options), ranks);
  std::vector<std::string> notes = model->notes();
  if (on_speed) notes.push_back(*on_speed);
  int rank = 0;
  MPI_Comm_rank(ranks, &rank);
  for (const std::string& note : notes)
    if (rank == 0) std::fprintf(stderr, "flow-server: %s\n", note.c_str());
  return model;
}

}  // namespace

std::unique_ptr<FlowModel> make_flow_model(const v1::Scene& scene, const std::filesystem::path& scene_folder,
                                           const std::optional<surface::SurfaceMesh>& surface, MPI_Comm ranks) {
  switch (scene.flow().model_case()) {
    case v1::Flow::kGlottis:
      refuse_more_ranks_than_one(ranks);
      return make_glottis(scene, surface);
    case v1::Flow::kNavierStokes:
      if (ranks == MPI_COMM_NULL)
        throw report::SceneError("flow.navier_stokes", "needs MPI, which this program has not started",
                                 "run it by flow-server");
      return make_navier_stokes_model(scene, scene_folder, surface, ranks);
    case v1::Flow::MODEL_NOT_SET:
      break;
  }
  throw report::SceneError("flow", "it names no model", "add flow.glottis or flow.navier_stokes");
}

}  // namespace couplet::flow
