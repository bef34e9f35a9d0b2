#include "flow-server/service/make_navier_stokes.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "flow-server/service/make_bodies.hpp"
#include "proto/report/failure.hpp"
#include "proto/scene/expression.hpp"
#include "proto/scene/make_time_table.hpp"
#include "proto/scene/wording.hpp"

namespace couplet::flow {

namespace {

const std::string model_path = "flow.navier_stokes";

StretchedAxis make_axis(const v1::GridAxis& axis, const std::string& path) {
  switch (axis.cells_case()) {
    case v1::GridAxis::kUniform:
      return {uniform_faces(axis.uniform().start(), axis.uniform().end(), axis.uniform().cells()), axis.periodic()};
    case v1::GridAxis::kStretched: {
      const v1::StretchedCells& cells = axis.stretched();
      std::vector<FineRegion> regions;
      for (const v1::FineRegion& region : cells.region())
        regions.push_back({region.start(), region.end(), region.width()});
      const double largest_width = cells.has_largest_width() ? cells.largest_width() : cells.end() - cells.start();
      return {stretched_faces(cells.start(), cells.end(), regions, cells.largest_growth(), largest_width),
              axis.periodic()};
    }
    case v1::GridAxis::kFaces:
      return {{axis.faces().face().begin(), axis.faces().face().end()}, axis.periodic()};
    case v1::GridAxis::CELLS_NOT_SET:
      break;
  }
  throw report::SceneError(path, "has no cells", "give uniform, stretched or faces");
}

StretchedGrid make_grid(const v1::Grid& grid) {
  const bool is_flat = !grid.has_z();
  return {{make_axis(grid.x(), model_path + ".grid.x"), make_axis(grid.y(), model_path + ".grid.y"),
           is_flat ? StretchedAxis({0, grid.depth()}, false) : make_axis(grid.z(), model_path + ".grid.z")},
          is_flat ? 2 : 3};
}

/// Copies share the translated formula. Where it is no number the flow finds out, on all ranks alike.
SpaceTimeValue make_value(const std::string& formula) {
  if (formula == "0") return SpaceTimeValue(0);
  const auto expression = std::make_shared<const scene::Expression>(formula);
  return SpaceTimeValue([expression](const Point& at, double t) { return expression->at(at[0], at[1], at[2], t); });
}

VectorValue make_vector(const v1::Vector& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

VectorValue make_vector(const v1::VectorExpression& formulas) {
  return {make_value(formulas.x()), make_value(formulas.y()), make_value(formulas.z())};
}

/// The table times the components of the direction.
VectorValue make_vector(const v1::VectorInTime& in_time) {
  const std::array direction{in_time.direction().x(), in_time.direction().y(), in_time.direction().z()};
  VectorValue value;
  for (std::size_t d = 0; d < 3; ++d) {
    if (direction[d] == 0) continue;
    scene::TimeTable table = scene::make_time_table(in_time.table());
    for (double& entry : table.value) entry *= direction[d];
    value[d] = std::move(table);
  }
  return value;
}

ExactFlow make_exact(const v1::ExactFlow& flow, const NavierStokesSetup& setup, const std::string& path) {
  switch (flow.solution_case()) {
    case v1::ExactFlow::kTaylorGreen:
      return {
          TaylorGreenVortices{flow.taylor_green().velocity(), flow.taylor_green().length(), setup.grid.n_dimensions},
          setup.density, setup.viscosity};
    case v1::ExactFlow::kEthierSteinman:
      return {EthierSteinmanFlow{flow.ethier_steinman().a(), flow.ethier_steinman().d()}, setup.density,
              setup.viscosity};
    case v1::ExactFlow::SOLUTION_NOT_SET:
      break;
  }
  throw report::SceneError(path, "names no solution", "give taylor_green or ethier_steinman");
}

VectorValue make_velocity(const v1::VelocityCondition& condition, const NavierStokesSetup& setup,
                          const std::string& path) {
  switch (condition.velocity_case()) {
    case v1::VelocityCondition::kConstant:
      return make_vector(condition.constant());
    case v1::VelocityCondition::kInTime:
      return make_vector(condition.in_time());
    case v1::VelocityCondition::kExpression:
      return make_vector(condition.expression());
    case v1::VelocityCondition::kExact:
      return make_exact(condition.exact(), setup, path + ".exact").velocity_value();
    case v1::VelocityCondition::VELOCITY_NOT_SET:
      break;
  }
  throw report::SceneError(path, "has no velocity", "give constant, in_time, expression or exact");
}

SpaceTimeValue make_pressure(const v1::PressureCondition& condition, const std::string& path) {
  switch (condition.pressure_case()) {
    case v1::PressureCondition::kConstant:
      return SpaceTimeValue(condition.constant());
    case v1::PressureCondition::kInTime:
      return SpaceTimeValue(scene::make_time_table(condition.in_time()));
    case v1::PressureCondition::kExpression:
      return make_value(condition.expression());
    case v1::PressureCondition::PRESSURE_NOT_SET:
      break;
  }
  throw report::SceneError(path, "has no pressure", "give constant, in_time or expression");
}

/// The condition of a border or of a patch, which have the same choice.
template <class Place>
FaceCondition make_condition(const Place& place, const NavierStokesSetup& setup, const std::string& path) {
  switch (place.condition_case()) {
    case Place::kVelocity:
      return PrescribedVelocity{make_velocity(place.velocity(), setup, path + ".velocity")};
    case Place::kPressure:
      return PressureOpening{make_pressure(place.pressure(), path + ".pressure")};
    case Place::kConvectiveOutflow:
      return ConvectiveOutflow{};
    case Place::kNoSlipWall:
      return PrescribedVelocity{make_vector(place.no_slip_wall().velocity())};
    case Place::kSlipWall:
      return SlipWall{};
    case Place::CONDITION_NOT_SET:
      break;
  }
  return PrescribedVelocity{make_vector(v1::Vector())};  // a wall at rest
}

struct Corners {
  Point from, to;
};

Corners make_corners(const v1::Box& box) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {{box.has_x_from() ? box.x_from() : -infinity, box.has_y_from() ? box.y_from() : -infinity,
           box.has_z_from() ? box.z_from() : -infinity},
          {box.has_x_to() ? box.x_to() : infinity, box.has_y_to() ? box.y_to() : infinity,
           box.has_z_to() ? box.z_to() : infinity}};
}

std::vector<FacePatch> make_border(const v1::Border& border, const NavierStokesSetup& setup, const std::string& path) {
  FacePatch whole;
  whole.condition = make_condition(border, setup, path);
  std::vector<FacePatch> patches{whole};
  for (int i = 0; i < border.patch_size(); ++i) {
    const v1::Patch& patch = border.patch(i);
    const Corners corners = make_corners(patch.box());
    patches.push_back({patch.name(), corners.from, corners.to,
                       make_condition(patch, setup, path + ".patch[" + std::to_string(i) + "]")});
  }
  return patches;
}

BorderConditions make_borders(const v1::Borders& borders, const NavierStokesSetup& setup) {
  const std::string path = model_path + ".border.";
  BorderConditions conditions;
  conditions[0][0] = make_border(borders.x_start(), setup, path + "x_start");
  conditions[0][1] = make_border(borders.x_end(), setup, path + "x_end");
  conditions[1][0] = make_border(borders.y_start(), setup, path + "y_start");
  conditions[1][1] = make_border(borders.y_end(), setup, path + "y_end");
  conditions[2][0] = make_border(borders.z_start(), setup, path + "z_start");
  conditions[2][1] = make_border(borders.z_end(), setup, path + "z_end");
  for (std::size_t d = 0; d < 3; ++d)
    if (setup.grid.is_periodic()[d]) conditions[d] = {};
  return conditions;
}

VectorValue make_body_force(const v1::BodyForce& force) {
  switch (force.force_case()) {
    case v1::BodyForce::kConstant:
      return make_vector(force.constant());
    case v1::BodyForce::kInTime:
      return make_vector(force.in_time());
    case v1::BodyForce::kExpression:
      return make_vector(force.expression());
    case v1::BodyForce::FORCE_NOT_SET:
      break;
  }
  return make_vector(v1::Vector());
}

TimeScheme make_scheme(v1::NavierStokes::TimeScheme scheme) {
  switch (scheme) {
    case v1::NavierStokes::AUTO:
      return TimeScheme::automatic;
    case v1::NavierStokes::ADAMS_BASHFORTH:
      return TimeScheme::adams_bashforth;
    case v1::NavierStokes::RUNGE_KUTTA:
      return TimeScheme::runge_kutta;
    case v1::NavierStokes::CRANK_NICOLSON:
      return TimeScheme::crank_nicolson;
  }
  throw report::SceneError(model_path + ".time_scheme", "is not one of the schemes there are");
}

PressureSettings make_pressure_settings(const v1::PressureSolve& solve) {
  PressureSettings settings;
  if (solve.method() == v1::PressureSolve::MULTIGRID) settings.method = PressureMethod::multigrid;
  if (solve.method() == v1::PressureSolve::FAST_DIAGONALISATION) settings.method = PressureMethod::fast_diagonalisation;
  settings.relative_tolerance = solve.relative_tolerance();
  settings.divergence_tolerance = solve.divergence_tolerance();
  settings.largest_iterations = solve.largest_iterations();
  return settings;
}

NavierStokesSetup make_setup(const v1::Flow& flow) {
  const v1::NavierStokes& model = flow.navier_stokes();
  NavierStokesSetup setup{make_grid(model.grid()),
                          flow.fluid().density(),
                          flow.fluid().viscosity(),
                          {},
                          make_body_force(model.body_force()),
                          make_vector(v1::Vector()),
                          {},
                          {},
                          make_scheme(model.time_scheme()),
                          {},
                          make_pressure_settings(model.pressure()),
                          model.balances_inflow()};
  setup.border = make_borders(model.border(), setup);
  if (model.initial().has_velocity()) {
    setup.initial_velocity = make_vector(model.initial().velocity());
  } else if (model.initial().has_exact()) {
    const ExactFlow exact = make_exact(model.initial().exact(), setup, model_path + ".initial.exact");
    setup.initial_velocity = exact.velocity_value();
    setup.initial_pressure = exact.pressure_value();
  }
  if (model.has_fluid_where()) {
    setup.is_fluid = [value = make_value(model.fluid_where())](const Point& centre) { return value.at(centre, 0) > 0; };
  }
  if (model.has_courant_number()) setup.step.courant = model.courant_number();
  setup.step.smallest = model.smallest_step();
  if (model.has_largest_step()) setup.step.largest = model.largest_step();
  return setup;
}

/// Cells whose centres lie in a box.
Box cells_inside(const v1::Box& box, const StretchedGrid& grid, const std::string& path) {
  const Corners corners = make_corners(box);
  Box cells;
  for (int d = 0; d < 3; ++d) {
    const StretchedAxis& axis = grid.axis[d];
    const auto at = static_cast<std::size_t>(d);
    int begin = 0, end = axis.n_cells();
    while (begin < end && axis.centre(begin) < corners.from[at]) ++begin;
    while (end > begin && axis.centre(end - 1) > corners.to[at]) --end;
    if (begin == end) {
      throw report::SceneError(path, "holds no centre of a cell along " + std::string(1, "xyz"[d]),
                               "give a larger box, or one elsewhere");
    }
    cells.begin[at] = begin;
    cells.end[at] = end;
  }
  return cells;
}

FieldQuantity make_quantity(int quantity) {
  switch (static_cast<v1::FieldOutput::Quantity>(quantity)) {
    case v1::FieldOutput::VELOCITY:
      return FieldQuantity::velocity;
    case v1::FieldOutput::PRESSURE:
      return FieldQuantity::pressure;
    case v1::FieldOutput::VORTICITY:
      return FieldQuantity::vorticity;
    case v1::FieldOutput::Q_CRITERION:
      return FieldQuantity::q_criterion;
    case v1::FieldOutput::SWIRLING_STRENGTH:
      return FieldQuantity::swirling_strength;
  }
  throw report::SceneError(model_path + ".field", "stores something that is not known");
}

FieldRegion make_region(const v1::FieldOutput& field, const StretchedGrid& grid, const std::string& path) {
  FieldRegion region;
  region.name = field.name();
  region.cells = cells_inside(field.box(), grid, path + ".box");
  region.stride = field.stride();
  for (const int quantity : field.quantity()) region.quantities.push_back(make_quantity(quantity));
  if (region.quantities.empty()) region.quantities = {FieldQuantity::velocity, FieldQuantity::pressure};
  region.precision = field.precision() == v1::FieldOutput::DOUBLE ? Precision::full : Precision::single;
  return region;
}

FlowObservation make_observation(const v1::NavierStokes& model, const NavierStokesSetup& setup) {
  FlowObservation observed;
  for (int i = 0; i < model.field_size(); ++i) {
    observed.regions.push_back(
        make_region(model.field(i), setup.grid, model_path + ".field[" + std::to_string(i) + "]"));
  }
  if (model.field_size() == 0) observed.regions.push_back(make_region({}, setup.grid, model_path + ".field"));
  for (const v1::Plane& plane : model.plane()) {
    const Corners corners = make_corners(plane.box());
    observed.planes.push_back(
        {plane.name(), plane.normal() - v1::Plane::X, plane.position(), corners.from, corners.to});
  }
  for (const v1::FlowProbe& probe : model.probe())
    observed.probes.push_back({probe.name(), {probe.at().x(), probe.at().y(), probe.at().z()}});
  for (const v1::MomentumBalance& balance : model.momentum_balance()) {
    const Corners corners = make_corners(balance.box());
    observed.balances.push_back({balance.name(), corners.from, corners.to});
    cells_of(setup.grid, observed.balances.back());  // throws at once
  }
  for (int b = 0; b < model.body_size(); ++b) {
    const v1::MomentPoint& point = model.body(b).moment_about();
    if (model.body(b).has_moment_about())
      observed.moments.push_back(
          {static_cast<std::size_t>(b), {point.at().x(), point.at().y(), point.at().z()}, point.carried()});
  }
  // Pictures must know where no fluid is.
  if (model.body_size() > 0 || model.has_fluid_where())
    for (FieldRegion& region : observed.regions) region.quantities.push_back(FieldQuantity::fluid_share);
  observed.has_integrals = model.integral_quantities();
  if (model.has_compare_with()) observed.exact = make_exact(model.compare_with(), setup, model_path + ".compare_with");
  return observed;
}

}  // namespace

NavierStokesOptions make_navier_stokes(const v1::Scene& scene, const std::filesystem::path& scene_folder,
                                       const std::optional<surface::SurfaceMesh>& solid) {
  const v1::NavierStokes& model = scene.flow().navier_stokes();
  NavierStokesOptions options{make_setup(scene.flow())};
  options.bodies = make_bodies(model, options.setup.grid, scene.time().step(), scene_folder, solid);
  options.coupled = coupled_body(model);
  if (model.has_decomposition())
    options.shape = {model.decomposition().x(), model.decomposition().y(), model.decomposition().z()};
  if (model.initial().has_file()) options.initial_file = scene_folder / model.initial().file();
  options.observed = make_observation(model, options.setup);
  return options;
}

}  // namespace couplet::flow
