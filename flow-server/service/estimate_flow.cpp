#include "flow-server/service/estimate_flow.hpp"

#include <algorithm>
#include <cmath>

#include "flow-server/immersed/body_surfaces.hpp"
#include "flow-server/service/body_speed.hpp"
#include "flow-server/service/make_navier_stokes.hpp"
#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {

using participant::NamedNumber;

// Measured on one core of about 3 GHz with 140 stations and 96 faces.
constexpr double seconds_per_station = 2e-8;
constexpr double seconds_per_face = 1e-7, seconds_per_strip = 5e-8;
// Arrays of stations of the three states and their work space, of faces with their share of nodes.
constexpr double bytes_per_station = 40 * sizeof(double);
constexpr double bytes_per_face = 100 * sizeof(double);
// The program and its libraries before any of this.
constexpr double bytes_of_program = 30e6;
// Of the Navier-Stokes flow: two states, what a step needs, the pressure solver; on one core, by the explicit schemes.
constexpr double bytes_per_cell = 200;
constexpr double seconds_per_cell = 1.5e-7;

std::vector<NamedNumber> estimate_glottis(const participant::OpenRequest& request) {
  const v1::Glottis& glottis = request.scene.flow().glottis();
  const double n_stations = glottis.stations();
  std::vector<NamedNumber> numbers{{"stations", n_stations, "1"}};
  if (!request.peer_surface && !glottis.has_channel()) return numbers;  // faces, which cost most, are not known yet

  const double n_faces = request.peer_surface ? static_cast<double>(request.peer_surface->n_faces()) : 0;
  if (request.peer_surface) numbers.push_back({"faces", n_faces, "1"});
  const double seconds_per_face_now = seconds_per_face + seconds_per_strip * glottis.strips_per_element();
  numbers.push_back({"seconds_per_solve", seconds_per_station * n_stations + seconds_per_face_now * n_faces, "s"});
  numbers.push_back(
      {"memory_bytes", bytes_of_program + bytes_per_station * n_stations + bytes_per_face * n_faces, "1"});
  return numbers;
}

Point centre_of(const StretchedGrid& grid, const Triple& cell) {
  return {grid.axis[0].centre(cell[0]), grid.axis[1].centre(cell[1]), grid.axis[2].centre(cell[2])};
}

/// Share of the cells that hold fluid, from at most some hundred thousand of them.
double share_of_fluid(const NavierStokesSetup& setup) {
  if (!setup.is_fluid) return 1;
  const Triple n = setup.grid.n_cells();
  Triple stride;
  for (std::size_t d = 0; d < 3; ++d) stride[d] = std::max(1, n[d] / 64);
  double n_asked = 0, n_fluid = 0;
  for (int k = 0; k < n[2]; k += stride[2])
    for (int j = 0; j < n[1]; j += stride[1])
      for (int i = 0; i < n[0]; i += stride[0]) {
        ++n_asked;
        if (setup.is_fluid(centre_of(setup.grid, {i, j, k}))) ++n_fluid;
      }
  return n_fluid / n_asked;
}

double largest_entry(const VectorValue& value, const Point& at, double t) {
  return std::max({std::abs(value[0].at(at, t)), std::abs(value[1].at(at, t)), std::abs(value[2].at(at, t))});
}

/// Largest component of the velocity at t = 0 and of what the borders prescribe during the run, at some places.
double known_speed(const NavierStokesSetup& setup, double end_time) {
  const Triple n = setup.grid.n_cells();
  double speed = 0;
  for (int s = 0; s < 1000; ++s) {
    const Triple cell{s % 10 * n[0] / 10, s / 10 % 10 * n[1] / 10, s / 100 * n[2] / 10};
    const Point at = centre_of(setup.grid, cell);
    speed = std::max(speed, largest_entry(setup.initial_velocity, at, 0));
    for (int d = 0; d < setup.grid.n_dimensions; ++d) {
      for (int side = 0; side < 2; ++side) {
        Point on_border = at;
        on_border[static_cast<std::size_t>(d)] = side == 0 ? setup.grid.axis[d].start() : setup.grid.axis[d].end();
        for (const FacePatch& patch : setup.border[static_cast<std::size_t>(d)][static_cast<std::size_t>(side)]) {
          if (const auto* prescribed = std::get_if<PrescribedVelocity>(&patch.condition)) {
            for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0})
              speed = std::max(speed, largest_entry(prescribed->velocity, on_border, share * end_time));
          }
        }
      }
    }
  }
  return speed;
}

std::vector<NamedNumber> estimate_navier_stokes(const participant::OpenRequest& request) {
  v1::Scene scene = request.scene;
  auto& bodies = *scene.mutable_flow()->mutable_navier_stokes()->mutable_body();
  const auto coupled =
      std::find_if(bodies.begin(), bodies.end(), [](const v1::FlowBody& body) { return body.has_coupled(); });
  // Before the solid has told its surface.
  if (!request.peer_surface && coupled != bodies.end()) bodies.erase(coupled);
  const NavierStokesOptions options = make_navier_stokes(scene, request.scene_folder, request.peer_surface);
  const NavierStokesSetup& setup = options.setup;
  const BodySurfaces surfaces(options.bodies, setup.grid);  // refuses what a run would: holes, for example
  const double n_cells = static_cast<double>(box_of(setup.grid.n_cells()).n_cells());
  const double n_active = std::round(share_of_fluid(setup) * n_cells);
  double narrowest = setup.grid.axis[0].smallest_width(), inverse_squares = 0;
  for (int d = 0; d < setup.grid.n_dimensions; ++d) {
    const double width = setup.grid.axis[d].smallest_width();
    narrowest = std::min(narrowest, width);
    inverse_squares += 1 / (width * width);
  }
  std::vector<NamedNumber> numbers{
      {"cells", n_cells, "1"}, {"cells_active", n_active, "1"}, {"smallest_cell", narrowest, "m"}};
  double step = request.scene.time().step();
  // A full cell a step is about what explicit schemes bear.
  const auto body = fastest_body(options.bodies, setup.grid, request.scene.time().end());
  const double speed = std::max(known_speed(setup, request.scene.time().end()), body ? body->speed : 0);
  if (speed > 0) {
    numbers.push_back({"convective_step_limit", narrowest / speed, "s"});
    step = std::min(step, narrowest / speed);
  }
  // Explicit diffusion: nu dt sum of 1/h^2 <= 1/2.
  if (setup.viscosity > 0) {
    const double limit = 0.5 * setup.density / (setup.viscosity * inverse_squares);
    numbers.push_back({"explicit_diffusion_step_limit", limit, "s"});
  }
  const double n_substeps = std::ceil(request.scene.time().step() / std::min(step, setup.step.largest));
  numbers.push_back({"seconds_per_solve", n_substeps * seconds_per_cell * n_active, "s"});
  numbers.push_back({"memory_bytes", bytes_of_program + bytes_per_cell * n_cells, "1"});
  return numbers;
}

}  // namespace

std::vector<NamedNumber> estimate_flow(const participant::OpenRequest& request) {
  switch (request.scene.flow().model_case()) {
    case v1::Flow::kGlottis:
      return estimate_glottis(request);
    case v1::Flow::kNavierStokes:
      return estimate_navier_stokes(request);
    case v1::Flow::MODEL_NOT_SET:
      break;
  }
  throw report::SceneError("flow", "it names no model", "add flow.glottis or flow.navier_stokes");
}

}  // namespace couplet::flow
