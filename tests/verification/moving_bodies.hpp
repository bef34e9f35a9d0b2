#pragma once
// Bodies that move as formulas say, and how rough the force on them is over time.

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "flow-server/immersed/edge_strip.hpp"
#include "flow-server/immersed/surface_topology.hpp"
#include "tests/verification/flow_cases.hpp"

namespace couplet::flow {

/// A chain of places with velocities in the plane, drawn out along z.
struct PlanePath {
  std::vector<std::array<double, 2>> place, velocity;
};

inline BodySurface prism_over(const PlanePath& path, double depth, bool is_closed) {
  BodySurface surface;
  surface.name = "body";
  surface.is_closed = is_closed;
  const int n = static_cast<int>(path.place.size());
  for (int layer = 0; layer < 2; ++layer)
    for (int i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      surface.position.push_back({path.place[at][0], path.place[at][1], layer * depth});
      surface.velocity.push_back({path.velocity[at][0], path.velocity[at][1], 0});
    }
  for (int i = 0; i < (is_closed ? n : n - 1); ++i) {
    const int next = (i + 1) % n;
    surface.triangle.push_back({i, next, next + n});
    surface.triangle.push_back({i, next + n, i + n});
  }
  return surface;
}

/// A circle in a flow in two dimensions; `velocity` of the wall at a place.
inline BodySurface circle(const std::array<double, 2>& centre, double radius, int n_sides, double depth,
                          const std::function<std::array<double, 2>(double x, double y)>& velocity) {
  PlanePath path;
  for (int i = 0; i < n_sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / n_sides;
    path.place.push_back({centre[0] + radius * std::cos(angle), centre[1] + radius * std::sin(angle)});
    path.velocity.push_back(velocity(path.place.back()[0], path.place.back()[1]));
  }
  return prism_over(path, depth, true);
}

/// Sheets with smooth free edges; keeps what belongs to their strips from call to call.
class EdgedSheets {
 public:
  EdgedSheets(double cell_width, double depth) : cell_width_(cell_width), depth_(depth) {}

  /// Number `sheet` in its present place. Edges for which is_attached holds meet a wall there and go on beyond it.
  /// `clearance`: before what free edges shut.
  BodySurface prolonged(std::size_t sheet, const BodySurface& surface,
                        const std::function<bool(const Point&)>& is_attached = {},
                        const EdgeStrip::Clearance& clearance = {}) {
    const auto width = [this](const Point&) { return cell_width_; };
    if (sheet >= strips_.size()) {
      BodySurface turned = surface;
      const std::vector<BorderPlane> planes{{2, 0.0}, {2, depth_}};
      const SurfaceTopology topology = orient_surface(turned, FluidSide::outside, planes);
      std::vector<bool> attached;
      for (const FreeEdge& edge : topology.free_edge)
        attached.push_back(is_attached && is_attached(surface.position[static_cast<std::size_t>(edge.from)]) &&
                           is_attached(surface.position[static_cast<std::size_t>(edge.to)]));
      strips_.push_back(
          std::make_unique<EdgeStrip>(surface, topology.free_edge, attached, EdgeRamp{}, 3 * cell_width_, width));
    }
    strips_[sheet]->update(surface, width, clearance);
    return strips_[sheet]->surface();
  }

 private:
  double cell_width_, depth_;
  std::vector<std::unique_ptr<EdgeStrip>> strips_;
};

/// Root mean square of (F_{n+1} - 2 F_n + F_{n-1}) / 4 over the largest |F|: what changes from step to step. The first
/// entries, in which the flow starts at once, do not count.
inline double roughness(const std::vector<double>& force, std::size_t first) {
  double largest = 0, sum = 0;
  for (std::size_t n = first; n < force.size(); ++n) largest = std::max(largest, std::abs(force[n]));
  for (std::size_t n = first + 2; n < force.size(); ++n)
    sum += std::pow((force[n] - 2 * force[n - 1] + force[n - 2]) / 4, 2);
  return std::sqrt(sum / static_cast<double>(force.size() - first - 2)) / largest;
}

/// The force of the pressure on the first body along x, step by step.
inline std::vector<double> pressure_forces(FractionalStep& flow, double step, int n_steps, FlowState* last = nullptr) {
  FlowState state = flow.initial_state(), next;
  std::vector<double> force;
  for (int n = 0; n < n_steps; ++n) {
    flow.advance(state, step, next);
    std::swap(state, next);
    force.push_back(flow.body_loads(state).front().pressure_force[0]);
  }
  if (last) *last = std::move(state);
  return force;
}

inline FacePatch whole_border(FaceCondition condition) {
  FacePatch patch;
  patch.name = "all";
  patch.condition = std::move(condition);
  return patch;
}

/// Largest speed after 20 steps in a channel of 3 x 1, n cells across, of which a sheet at rest stands across the way
/// of a difference of pressures of 10 kPa: over dt p / (rho h), that of a wall that the pressure does not see.
/// `sheet_on(h)`: for cells of the width h.
template <class SheetOn>
double leak_through(int n, const SheetOn& sheet_on) {
  constexpr double h = 0.5e-3, step = 1e-4, pressure = 1e4, density = 1000;
  NavierStokesSetup setup =
      setup_on(box_grid({uniform_faces(0, 3 * n * h, 3 * n), uniform_faces(0, n * h, n), {0, h}}, {}, 2),
               TimeScheme::adams_bashforth);
  setup.density = density, setup.viscosity = 1e-3;
  setup.pressure.relative_tolerance = 1e-12;
  setup.border[0][0] = {whole_border(PressureOpening{SpaceTimeValue(pressure)})};
  setup.border[0][1] = {whole_border(PressureOpening{SpaceTimeValue(0.0)})};
  setup.border[1][0] = setup.border[1][1] = {whole_border(SlipWall{})};
  const BodySurface sheet = sheet_on(h);
  setup.bodies = [sheet](double) { return std::vector<BodySurface>{sheet}; };
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  FlowState state;
  pressure_forces(flow, step, 20, &state);
  return state.largest_speed / (step * pressure / (density * h));
}

}  // namespace couplet::flow
