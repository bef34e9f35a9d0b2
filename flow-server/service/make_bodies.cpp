#include "flow-server/service/make_bodies.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include "flow-server/immersed/body_shape.hpp"
#include "flow-server/immersed/surface_file.hpp"
#include "proto/report/failure.hpp"
#include "proto/scene/expression.hpp"
#include "proto/scene/make_time_table.hpp"

namespace couplet::flow {

namespace {

constexpr double degree = std::numbers::pi / 180;

Point point_of(const v1::Vector& v) {
  return {v.x(), v.y(), v.z()};
}
PlanePoint plane_point_of(const v1::Vector& v) {
  return {v.x(), v.y()};
}

std::vector<PlanePoint> points_of(const google::protobuf::RepeatedPtrField<v1::Vector>& points) {
  std::vector<PlanePoint> chain;
  for (const v1::Vector& point : points) chain.push_back(plane_point_of(point));
  return chain;
}

std::vector<Point> space_points_of(const google::protobuf::RepeatedPtrField<v1::Vector>& points) {
  std::vector<Point> chain;
  for (const v1::Vector& point : points) chain.push_back(point_of(point));
  return chain;
}

double smallest_cell(const StretchedGrid& grid) {
  double width = std::numeric_limits<double>::infinity();
  for (int d = 0; d < grid.n_dimensions; ++d)
    width = std::min(width, grid.axis[static_cast<std::size_t>(d)].smallest_width());
  return width;
}

bool is_thin(const v1::FlowBody& body) {
  return body.has_sheet() || body.has_rectangle() || body.has_ruled_sheet() ||
         (body.has_file() && body.file().kind() == v1::SurfaceFile::THIN) ||
         (body.has_coupled() && body.coupled().kind() == v1::CoupledSurface::THIN);
}

/// A solid in a flow in two dimensions is a slab of its depth.
const surface::SurfaceMesh& slab_of_depth(const surface::SurfaceMesh& solid, const StretchedAxis& z,
                                          const std::string& name) {
  const auto depth = solid.node_position.col(2);
  const double low = depth.minCoeff(), high = depth.maxCoeff();
  const double near = 1e-6 * z.length();  // digits that a person writes
  if (std::abs(low - z.start()) <= near && std::abs(high - z.end()) <= near) return solid;
  throw report::SceneError(
      "flow.navier_stokes.body '" + name + "'.coupled",
      "the solid reaches from z = " + report::text(low) + " to " + report::text(high) +
          " m, the flow in two dimensions from " + report::text(z.start()) + " to " + report::text(z.end()) + " m",
      std::abs(low - z.start()) <= near ? "set flow.navier_stokes.grid.depth to " + report::text(high - low)
                                        : "let the solid begin at z = " + report::text(z.start()) +
                                              " and set flow.navier_stokes.grid.depth to " + report::text(high - low));
}

/// An end of a tube on a border of the grid, or beyond, is carried on along the axis until its lid lies beyond.
Point carried_on(const Point& end, const Point& other, double radius, double cell, const StretchedGrid& grid) {
  const Eigen::Vector3d at(end.data());
  const Eigen::Vector3d axis = (at - Eigen::Vector3d(other.data())).normalized();
  double length = std::numeric_limits<double>::infinity();
  for (int d = 0; d < 3; ++d) {
    const StretchedAxis& along = grid.axis[static_cast<std::size_t>(d)];
    const double inside = axis[d] < 0 ? at[d] - along.start() : along.end() - at[d];  // of the border
    if (axis[d] == 0 || along.is_periodic() || inside > 1e-6 * along.length()) continue;
    // The lid reaches back by radius * sin of the angle between axis and border's normal.
    const double lid = radius * std::sqrt(std::max(0.0, 1 - axis[d] * axis[d]));
    length = std::min(length, std::max(0.0, inside + lid + 2 * cell) / std::abs(axis[d]));
  }
  if (std::isinf(length)) return end;
  const Eigen::Vector3d beyond = at + length * axis;
  return {beyond[0], beyond[1], beyond[2]};
}

surface::SurfaceMesh make_carried_tube(const v1::Tube& tube, const StretchedGrid& grid, double side) {
  const Point start = point_of(tube.start()), end = point_of(tube.end());
  const double radius = tube.radius(), cell = grid.axis[0].largest_width();
  return make_tube(carried_on(start, end, radius, cell, grid), carried_on(end, start, radius, cell, grid), radius,
                   side);
}

/// Where the body lies before its placement. Triangles of shapes are as small as they must be from the start.
surface::SurfaceMesh make_shape(const v1::FlowBody& body, const StretchedGrid& grid, double side,
                                const std::filesystem::path& scene_folder,
                                const std::optional<surface::SurfaceMesh>& solid) {
  const StretchedAxis& z = grid.axis[2];
  const DepthSpan depth{z.start(), z.end(), grid.n_dimensions == 2};
  switch (body.shape_case()) {
    case v1::FlowBody::kFile:
      return read_surface_file(scene_folder / body.file().file(), body.file().length_unit());
    case v1::FlowBody::kCoupled:
      if (!solid)
        throw report::SceneError("flow.navier_stokes.body '" + body.name() + "'.coupled",
                                 "there is no solid whose surface this could be",
                                 "run the scene by couplet run, or give the body another shape");
      return grid.n_dimensions == 2 ? slab_of_depth(*solid, z, body.name()) : *solid;
    case v1::FlowBody::kCylinder: {
      const v1::EllipticCylinder& cylinder = body.cylinder();
      const double radius_y = cylinder.has_radius_y() ? cylinder.radius_y() : cylinder.radius();
      return make_elliptic_cylinder(plane_point_of(cylinder.centre()), {cylinder.radius(), radius_y}, depth, side);
    }
    case v1::FlowBody::kPolygon:
      return make_polygon_prism(points_of(body.polygon().point()), depth, side);
    case v1::FlowBody::kSheet:
      return make_sheet_prism(points_of(body.sheet().point()), depth, side);
    case v1::FlowBody::kEllipsoid: {
      const v1::Ellipsoid& ball = body.ellipsoid();
      return make_ellipsoid(point_of(ball.centre()),
                            {ball.radius(), ball.has_radius_y() ? ball.radius_y() : ball.radius(),
                             ball.has_radius_z() ? ball.radius_z() : ball.radius()},
                            side);
    }
    case v1::FlowBody::kCuboid:
      return make_box(point_of(body.cuboid().low()), point_of(body.cuboid().high()), side);
    case v1::FlowBody::kRectangle:
      return make_rectangle(point_of(body.rectangle().corner()), point_of(body.rectangle().first_side()),
                            point_of(body.rectangle().second_side()), side);
    case v1::FlowBody::kTube:
      return make_carried_tube(body.tube(), grid, side);
    case v1::FlowBody::kRevolved:
      return make_revolved_body(points_of(body.revolved().point()), side);
    case v1::FlowBody::kRuledSheet:
      return make_ruled_sheet(space_points_of(body.ruled_sheet().first_edge()),
                              space_points_of(body.ruled_sheet().second_edge()), side);
    case v1::FlowBody::SHAPE_NOT_SET:
      break;
  }
  throw report::SceneError("flow.navier_stokes.body '" + body.name() + "'", "has no shape", "give one");
}

void place(const v1::Placement& placement, surface::SurfaceMesh& mesh) {
  const v1::Vector& given = placement.rotation_axis();
  const Eigen::Vector3d axis =
      placement.has_rotation_axis() ? Eigen::Vector3d(given.x(), given.y(), given.z()) : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d move(placement.translation().x(), placement.translation().y(), placement.translation().z());
  if (placement.rotation_angle() != 0) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(placement.rotation_angle() * degree, axis.normalized()).toRotationMatrix();
    mesh.node_position = (mesh.node_position * turn.transpose()).eval();
  }
  mesh.node_position.rowwise() += move.transpose();
}

/// `unit`: that of the scene in SI.
TimeFunction make_function(const v1::MotionFunction& function, double unit, double time_step) {
  switch (function.function_case()) {
    case v1::MotionFunction::kConstant:
      return unit * function.constant();
    case v1::MotionFunction::kInTime: {
      scene::TimeTable table = scene::make_time_table(function.in_time());
      for (double& value : table.value) value *= unit;
      return table;
    }
    case v1::MotionFunction::kFourier: {
      const v1::FourierSeries& given = function.fourier();
      FourierSeries series{.frequency = given.frequency(), .mean = unit * given.mean(), .cosine = {}, .sine = {}};
      for (const double a : given.cosine()) series.cosine.push_back(unit * a);
      for (const double b : given.sine()) series.sine.push_back(unit * b);
      return series;
    }
    case v1::MotionFunction::kExpression: {
      // Copies share the translated formula.
      const auto expression = std::make_shared<const scene::Expression>(function.expression());
      return TimeFormula{[expression, unit](double t) { return unit * expression->at(0, 0, 0, t); }, 0.02 * time_step};
    }
    case v1::MotionFunction::FUNCTION_NOT_SET:
      break;
  }
  return 0.0;
}

Joint make_joint(const v1::Joint& joint, double time_step) {
  if (joint.has_rotation()) {
    const v1::BodyRotation& rotation = joint.rotation();
    return Rotation{point_of(rotation.through()), rotation.has_axis() ? point_of(rotation.axis()) : Point{0, 0, 1},
                    make_function(rotation.angle(), degree, time_step)};
  }
  const v1::BodyTranslation& move = joint.translation();
  return Translation{{make_function(move.x(), 1, time_step), make_function(move.y(), 1, time_step),
                      make_function(move.z(), 1, time_step)}};
}

/// The joints of the bodies that carry this one come first.
std::vector<Joint> make_joints(const v1::NavierStokes& model, const v1::FlowBody& body, double time_step) {
  std::vector<const v1::FlowBody*> carriers{&body};
  while (carriers.back()->has_moves_with()) {
    const auto carrier = std::find_if(model.body().begin(), model.body().end(), [&](const v1::FlowBody& other) {
      return other.name() == carriers.back()->moves_with();
    });
    if (carrier == model.body().end() || static_cast<int>(carriers.size()) > model.body_size()) {
      throw report::SceneError("flow.navier_stokes.body '" + body.name() + "'.moves_with",
                               "the bodies that carry it do not end in one that is named",
                               "name bodies that there are, and no circle of them");
    }
    carriers.push_back(&*carrier);
  }
  std::vector<Joint> joints;
  for (auto carrier = carriers.rbegin(); carrier != carriers.rend(); ++carrier)
    for (const v1::Joint& joint : (*carrier)->joint()) joints.push_back(make_joint(joint, time_step));
  return joints;
}

AttachedEdges make_attached(const v1::Box& box) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const auto low = [](bool is_given, double value) { return is_given ? value : -infinite; };
  const auto high = [](bool is_given, double value) { return is_given ? value : infinite; };
  return {
      {low(box.has_x_from(), box.x_from()), low(box.has_y_from(), box.y_from()), low(box.has_z_from(), box.z_from())},
      {high(box.has_x_to(), box.x_to()), high(box.has_y_to(), box.y_to()), high(box.has_z_to(), box.z_to())}};
}

BodySetup make_body(const v1::NavierStokes& model, const v1::FlowBody& body, const StretchedGrid& grid,
                    double time_step, const std::filesystem::path& scene_folder,
                    const std::optional<surface::SurfaceMesh>& solid) {
  const bool thin = is_thin(body);
  const double cell = smallest_cell(grid);
  // A sheet's opening is linear in each triangle, over about a cell at its edge.
  const double side = body.has_largest_triangle() ? body.largest_triangle() : thin ? 0.5 * cell : cell;
  BodySetup setup;
  setup.name = body.name();
  setup.mesh = make_shape(body, grid, side, scene_folder, solid);
  place(body.placement(), setup.mesh);
  setup.is_closed = !thin;
  setup.closes_covered_holes = body.has_coupled() && !thin;
  const bool is_vessel =
      body.has_tube() || body.cylinder().fluid_inside() || body.file().kind() == v1::SurfaceFile::VESSEL;
  setup.fluid = is_vessel ? FluidSide::inside : FluidSide::outside;
  // Flat faces bound a body as well as small ones do.
  setup.largest_side = body.has_file() && !thin && !body.has_largest_triangle() ? 0 : side;
  setup.motion = PrescribedMotion(make_joints(model, body, time_step));
  if (body.has_blend_width()) setup.blend_width = body.blend_width();
  setup.edge = {body.edge().ramp_length(), body.edge().ramp_shift()};
  setup.edge_conductance = body.edge().conductance();
  for (const v1::Box& box : body.edge().attached()) setup.attached.push_back(make_attached(box));
  if (body.edge().all_attached()) setup.attached.push_back(make_attached({}));
  setup.attached_length = body.edge().has_attached_length() ? body.edge().attached_length() : 2 * cell;
  setup.thickness = body.thickness();
  return setup;
}

}  // namespace

std::vector<BodySetup> make_bodies(const v1::NavierStokes& model, const StretchedGrid& grid, double time_step,
                                   const std::filesystem::path& scene_folder,
                                   const std::optional<surface::SurfaceMesh>& solid) {
  std::vector<BodySetup> bodies;
  for (const v1::FlowBody& body : model.body())
    bodies.push_back(make_body(model, body, grid, time_step, scene_folder, solid));
  return bodies;
}

std::optional<int> coupled_body(const v1::NavierStokes& model) {
  for (int b = 0; b < model.body_size(); ++b)
    if (model.body(b).has_coupled()) return b;
  return std::nullopt;
}

}  // namespace couplet::flow
