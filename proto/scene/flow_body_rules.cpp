#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "proto/report/failure.hpp"
#include "proto/scene/expression.hpp"
#include "proto/scene/relation_rules.hpp"
#include "proto/scene/wording.hpp"

namespace couplet::scene {

namespace {

std::string body_path(int index) {
  return entry("flow.navier_stokes.body", index);
}

std::array<double, 3> numbers(const v1::Vector& v) {
  return {v.x(), v.y(), v.z()};
}
bool is_zero_vector(const v1::Vector& v) {
  return v.x() == 0 && v.y() == 0 && v.z() == 0;
}

bool is_thin(const v1::FlowBody& body) {
  return body.has_sheet() || body.has_rectangle() || body.has_ruled_sheet() ||
         (body.has_file() && body.file().kind() == v1::SurfaceFile::THIN) ||
         (body.has_coupled() && body.coupled().kind() == v1::CoupledSurface::THIN);
}

/// A body's name is that of its results, and others name it.
void body_names_differ(const v1::NavierStokes& model, Review& review) {
  std::set<std::string> bodies;
  for (int i = 0; i < model.body_size(); ++i) {
    const std::string& name = model.body(i).name();
    if (name.empty()) continue;
    if (!bodies.insert(name).second)
      review.complain(body_path(i) + ".name", "\"" + name + "\" is the name of another body; give each its own name");
  }
}

/// Every body hangs on another one or on the world, never on itself.
void bodies_hang_on_others(const v1::NavierStokes& model, Review& review) {
  std::map<std::string, std::string> carrier;
  std::vector<std::string> names;
  for (const v1::FlowBody& body : model.body()) {
    carrier.emplace(body.name(), body.moves_with());
    names.push_back(body.name());
  }
  for (int i = 0; i < model.body_size(); ++i) {
    const v1::FlowBody& body = model.body(i);
    if (!body.has_moves_with()) continue;
    if (carrier.count(body.moves_with()) == 0) {
      review.complain(body_path(i) + ".moves_with", "there is no body \"" + body.moves_with() + "\"; " +
                                                        suggestion(body.moves_with(), names, "the bodies are"));
      continue;
    }
    std::string at = body.moves_with();
    for (std::size_t steps = 0; steps < names.size() && !at.empty() && at != body.name(); ++steps)
      at = carrier.count(at) > 0 ? carrier[at] : "";
    if (!at.empty() && at == body.name()) {
      review.complain(body_path(i) + ".moves_with",
                      "\"" + body.moves_with() + "\" hangs on \"" + body.name() +
                          "\" in the end; leave out moves_with of the body that carries the others");
    }
  }
}

void shape_fits_the_dimensions(const v1::FlowBody& body, const std::string& path, Review& review) {
  const char* shape = body.has_ellipsoid()     ? "ellipsoid"
                      : body.has_cuboid()      ? "cuboid"
                      : body.has_rectangle()   ? "rectangle"
                      : body.has_tube()        ? "tube"
                      : body.has_revolved()    ? "revolved"
                      : body.has_ruled_sheet() ? "ruled_sheet"
                                               : nullptr;
  if (shape != nullptr) {
    review.complain(
        path + "." + shape,
        "is a shape in three dimensions, but the grid has no z; give cylinder, polygon or sheet, or grid.z");
  }
}

/// In two dimensions nothing leaves the plane.
void motion_stays_in_the_plane(const v1::FlowBody& body, const std::string& path, Review& review) {
  const auto turns_about_z = [](const v1::Vector& axis) { return axis.x() == 0 && axis.y() == 0; };
  const v1::Placement& placement = body.placement();
  if (placement.rotation_angle() != 0 &&
      (!placement.has_rotation_axis() || !turns_about_z(placement.rotation_axis()))) {
    review.complain(path + ".placement.rotation_axis",
                    "is not z, but the grid has no z to turn into; give rotation_axis { z: 1 }");
  }
  if (placement.translation().z() != 0) {
    review.complain(path + ".placement.translation.z",
                    number_text(placement.translation().z()) + " m leads out of the plane of the flow; delete z");
  }
  for (int j = 0; j < body.joint_size(); ++j) {
    const std::string joint = path + ".joint[" + std::to_string(j) + "]";
    const v1::Joint& given = body.joint(j);
    if (given.translation().has_z())
      review.complain(joint + ".translation.z", "leads out of the plane of the flow; delete it");
    if (given.rotation().has_axis() && !turns_about_z(given.rotation().axis()))
      review.complain(joint + ".rotation.axis", "is not z, but the grid has no z to turn into; delete it");
  }
}

using Points = google::protobuf::RepeatedPtrField<v1::Vector>;

/// Whether sides a-b and c-d of an outline cross or touch.
bool sides_meet(const v1::Vector& a, const v1::Vector& b, const v1::Vector& c, const v1::Vector& d) {
  // Positive where r lies to the left of p-q.
  const auto side = [](const v1::Vector& p, const v1::Vector& q, const v1::Vector& r) {
    return (q.x() - p.x()) * (r.y() - p.y()) - (q.y() - p.y()) * (r.x() - p.x());
  };
  const auto spans_meet = [](double p, double q, double r, double s) {
    return std::max(p, q) >= std::min(r, s) && std::max(r, s) >= std::min(p, q);
  };
  return side(a, b, c) * side(a, b, d) <= 0 && side(c, d, a) * side(c, d, b) <= 0 &&
         spans_meet(a.x(), b.x(), c.x(), d.x()) && spans_meet(a.y(), b.y(), c.y(), d.y());
}

/// Inside and outside are told by the outline.
void outline_does_not_cross_itself(const Points& point, const std::string& path, Review& review) {
  const int n = point.size();
  for (int i = 0; i < n; ++i) {
    for (int j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;  // neighbours share a point
      if (!sides_meet(point[i], point[i + 1], point[j], point[(j + 1) % n])) continue;
      review.complain(path + ".point[" + std::to_string(j) + "]",
                      "the side from here to the next point meets the side that starts at point[" + std::to_string(i) +
                          "]; give the points in order around the body");
      return;
    }
  }
}

void outline_has_sides(const Points& point, bool is_closed, const std::string& path, Review& review) {
  double area = 0, perimeter = 0;
  for (int i = 0; i < point.size(); ++i) {
    const bool is_last = i + 1 == point.size();
    const v1::Vector& next = point[is_last ? 0 : i + 1];
    // From the first point, so that a distant outline loses no digits.
    const double x = point[i].x() - point[0].x(), y = point[i].y() - point[0].y();
    const double along_x = next.x() - point[i].x(), along_y = next.y() - point[i].y();
    area += 0.5 * (x * along_y - y * along_x);
    perimeter += std::hypot(along_x, along_y);
    if ((is_last && !is_closed) || point[i].x() != next.x() || point[i].y() != next.y()) continue;
    review.complain(
        path + ".point[" + std::to_string(is_last ? 0 : i + 1) + "]",
        std::string("lies where the point before lies; ") +
            (is_last ? "the last point is joined to the first by itself: delete one of them" : "delete it"));
    return;
  }
  // Round-off of the digits that a person writes.
  if (is_closed && point.size() >= 3 && std::abs(area) < 1e-12 * perimeter * perimeter) {
    review.complain(path, "its points enclose no area; give an outline around an area, or a sheet");
  } else if (is_closed) {
    outline_does_not_cross_itself(point, path, review);
  }
}

/// A body of revolution is closed by points on its axis, and by these alone.
void revolved_body_is_closed(const Points& point, const std::string& path, Review& review) {
  outline_has_sides(point, false, path, review);
  for (int i = 0; i < point.size(); ++i) {
    const bool is_end = i == 0 || i + 1 == point.size();
    const std::string where = path + ".point[" + std::to_string(i) + "].y";
    if (is_end && point[i].y() != 0)
      review.complain(where, "is " + number_text(point[i].y()) + " m, but the body ends here; give 0, the axis");
    if (!is_end && point[i].y() <= 0)
      review.complain(where, "is " + number_text(point[i].y()) + " m; give a distance from the axis above 0");
  }
}

void ruled_sheet_has_area(const v1::RuledSheet& sheet, const std::string& path, Review& review) {
  const Points &first = sheet.first_edge(), &second = sheet.second_edge();
  if (first.size() != second.size()) {
    review.complain(path + ".second_edge", "has " + std::to_string(second.size()) + " points, first_edge " +
                                               std::to_string(first.size()) + "; give both as many");
    return;
  }
  const auto same = [](const v1::Vector& a, const v1::Vector& b) { return numbers(a) == numbers(b); };
  for (int i = 0; i < first.size(); ++i) {
    if (i == 0) continue;
    const std::string at = "[" + std::to_string(i) + "]";
    for (const auto& [points, edge] : {std::pair{&first, ".first_edge"}, {&second, ".second_edge"}}) {
      if (same((*points)[i], (*points)[i - 1]))
        review.complain(path + edge + at, "lies where the point before lies; delete this pair of points");
    }
    if (same(first[i], second[i]) && same(first[i - 1], second[i - 1]))
      review.complain(path + ".second_edge" + at,
                      "and the point before lie on the first edge, so that nothing is between; move one of them");
    if (i + 1 < first.size() && same(first[i], second[i]))
      review.complain(path + ".second_edge" + at,
                      "lies on the first edge, which parts the sheet in two; only ends may meet, or give two bodies");
  }
}

void shape_makes_sense(const v1::FlowBody& body, const std::string& path, Review& review) {
  outline_has_sides(body.polygon().point(), true, path + ".polygon", review);
  outline_has_sides(body.sheet().point(), false, path + ".sheet", review);
  if (body.has_revolved()) revolved_body_is_closed(body.revolved().point(), path + ".revolved", review);
  if (body.has_ruled_sheet()) ruled_sheet_has_area(body.ruled_sheet(), path + ".ruled_sheet", review);
  if (body.cuboid().has_low() && body.cuboid().has_high()) {
    const auto low = numbers(body.cuboid().low()), high = numbers(body.cuboid().high());
    for (std::size_t d = 0; d < 3; ++d) {
      if (high[d] > low[d]) continue;
      review.complain(
          path + ".cuboid.high." + std::string(1, "xyz"[d]),
          number_text(high[d]) + " m is not above that of low, " + number_text(low[d]) + " m; give a larger one");
    }
  }
  if (body.rectangle().has_first_side() && body.rectangle().has_second_side()) {
    const auto a = numbers(body.rectangle().first_side()), b = numbers(body.rectangle().second_side());
    if (a[1] * b[2] == a[2] * b[1] && a[2] * b[0] == a[0] * b[2] && a[0] * b[1] == a[1] * b[0])
      review.complain(path + ".rectangle",
                      "its sides are parallel or have no length; give two sides that span a plate");
  }
  if (body.tube().has_start() && body.tube().has_end() && numbers(body.tube().start()) == numbers(body.tube().end()))
    review.complain(path + ".tube.end", "lies where start lies; give the other end of the axis");
  if (body.placement().has_rotation_axis() && is_zero_vector(body.placement().rotation_axis()))
    review.complain(path + ".placement.rotation_axis", "has no length; give a direction");
}

/// What holds for thin sheets only.
void edges_are_of_sheets(const v1::FlowBody& body, const std::string& path, Review& review) {
  if (is_thin(body)) {
    for (int i = 0; i < body.edge().attached_size(); ++i) {
      if (!body.edge().all_attached()) break;
      review.complain(path + ".edge.attached[" + std::to_string(i) + "]",
                      "names some edges, but all_attached names all; delete one of them");
      break;
    }
    return;
  }
  for (const auto& [is_given, name] : {std::pair{body.has_edge(), "edge"}, {body.has_thickness(), "thickness"}}) {
    if (is_given) review.complain(path + "." + name, "is for thin sheets, but this surface bounds a body; delete it");
  }
}

/// A formula of motion is tried at some times of the run.
void formula_is_of_time(const std::string& formula, const std::string& path, double end_time, Review& review) {
  try {
    const Expression expression(formula);
    for (const double share : {0.0, 0.1, 0.3, 0.5, 0.7, 1.0}) {
      const double time = share * (end_time > 0 ? end_time : 0);
      const double value = expression.at(0, 0, 0, time);
      if (!std::isfinite(value)) {
        review.complain(path, "is " + number_text(value) + " at t = " + number_text(time) +
                                  " s; write a formula that is a finite number at all times");
        return;
      }
      if (expression.at(1, 0, 0, time) != value || expression.at(0, 1, 0, time) != value ||
          expression.at(0, 0, 1, time) != value) {
        review.complain(path, "depends on the place; a rigid body moves as a whole: use t alone");
        return;
      }
    }
  } catch (const report::SceneError&) {
    // A formula that cannot be read was complained about by the rules of its field.
  }
}

void motion_makes_sense(const v1::FlowBody& body, const std::string& path, double end_time, Review& review) {
  for (int j = 0; j < body.joint_size(); ++j) {
    const v1::Joint& joint = body.joint(j);
    const std::string where = path + ".joint[" + std::to_string(j) + "]";
    const v1::BodyTranslation& move = joint.translation();
    for (const auto& [function, name] : {std::pair{&move.x(), ".translation.x"},
                                         {&move.y(), ".translation.y"},
                                         {&move.z(), ".translation.z"},
                                         {&joint.rotation().angle(), ".rotation.angle"}}) {
      if (function->has_expression())
        formula_is_of_time(function->expression(), where + name + ".expression", end_time, review);
    }
    if (joint.has_translation() && !move.has_x() && !move.has_y() && !move.has_z())
      review.complain(where + ".translation", "moves nothing; give x, y or z, or delete the joint");
    if (joint.rotation().has_axis() && is_zero_vector(joint.rotation().axis()))
      review.complain(where + ".rotation.axis", "has no length; give a direction");
  }
}

/// The solid is in the flow as one body, which nothing else places or moves.
void solid_is_one_body(const v1::Scene& scene, Review& review) {
  const v1::NavierStokes& model = scene.flow().navier_stokes();
  int n_coupled = 0;
  for (int i = 0; i < model.body_size(); ++i) {
    const v1::FlowBody& body = model.body(i);
    if (!body.has_coupled()) continue;
    ++n_coupled;
    if (!scene.has_solid())
      review.complain(body_path(i) + ".coupled",
                      "there is no solid whose surface this could be; give solid or another shape");
    if (scene.has_solid() && n_coupled > 1)
      review.complain(body_path(i) + ".coupled", "the solid is in the flow already; delete this body");
    if (body.has_placement())
      review.complain(body_path(i) + ".placement",
                      "the solid says where its surface lies; delete it, or place solid.body");
    if (body.joint_size() > 0)
      review.complain(body_path(i) + ".joint[0]",
                      "the solid moves its surface; delete it, or give solid.prescribed_motion");
    if (body.has_moves_with()) review.complain(body_path(i) + ".moves_with", "the solid moves its surface; delete it");
    if (body.moment_about().carried())
      review.complain(body_path(i) + ".moment_about.carried",
                      "the solid has no joints that could carry the point; delete it");
  }
  if (scene.has_solid() && n_coupled == 0)
    review.complain_missing("flow.navier_stokes.body",
                            "the solid is not in the flow; give a body { name: \"...\"  coupled { } }");
}

}  // namespace

void check_flow_body_rules(const v1::Scene& scene, Review& review) {
  const v1::NavierStokes& model = scene.flow().navier_stokes();
  body_names_differ(model, review);
  bodies_hang_on_others(model, review);
  solid_is_one_body(scene, review);
  for (int i = 0; i < model.body_size(); ++i) {
    const v1::FlowBody& body = model.body(i);
    if (!model.grid().has_z()) {
      shape_fits_the_dimensions(body, body_path(i), review);
      motion_stays_in_the_plane(body, body_path(i), review);
    }
    shape_makes_sense(body, body_path(i), review);
    edges_are_of_sheets(body, body_path(i), review);
    motion_makes_sense(body, body_path(i), scene.time().end(), review);
  }
}

}  // namespace couplet::scene
