#include <array>
#include <cmath>
#include <optional>
#include <set>

#include "proto/report/failure.hpp"
#include "proto/scene/expression.hpp"
#include "proto/scene/relation_rules.hpp"
#include "proto/scene/wording.hpp"

namespace couplet::scene {

namespace {

const std::string model_path = "flow.navier_stokes";
constexpr int smallest_block = 4;  // cells in a direction that is cut

/// Where a grid lies, as far as the scene says it.
struct Extent {
  double start = 0, end = 0;  // [m]
  bool is_periodic = false;
  int n_cells = 0;  // 0: only the server knows

  bool is_known() const { return end > start; }
  double length() const { return end - start; }
};

struct Space {
  std::array<Extent, 3> axis;
  int n_dimensions = 3;
};

Extent extent_of(const v1::GridAxis& axis) {
  Extent extent;
  extent.is_periodic = axis.periodic();
  if (axis.has_uniform()) {
    extent.start = axis.uniform().start(), extent.end = axis.uniform().end();
    extent.n_cells = axis.uniform().cells();
  } else if (axis.has_stretched()) {
    extent.start = axis.stretched().start(), extent.end = axis.stretched().end();
  } else if (axis.faces().face_size() > 1) {
    extent.start = axis.faces().face(0), extent.end = axis.faces().face(axis.faces().face_size() - 1);
    extent.n_cells = axis.faces().face_size() - 1;
  }
  return extent;
}

Space space_of(const v1::Grid& grid) {
  Space space{{extent_of(grid.x()), extent_of(grid.y()), extent_of(grid.z())}, grid.has_z() ? 3 : 2};
  if (!grid.has_z()) space.axis[2] = {0, grid.depth(), false, 1};
  return space;
}

template <class Cells>
void end_is_behind_start(const Cells& cells, const std::string& path, Review& review) {
  if (!cells.has_start() || !cells.has_end() || cells.end() > cells.start()) return;
  review.complain(path + ".end", number_text(cells.end()) + " m is not above start, " + number_text(cells.start()) +
                                     " m; give an end above it");
}

void regions_are_in_order(const v1::StretchedCells& cells, const std::string& path, Review& review) {
  double reached = cells.start();
  for (int i = 0; i < cells.region_size(); ++i) {
    const v1::FineRegion& region = cells.region(i);
    const std::string where = path + ".region[" + std::to_string(i) + "]";
    end_is_behind_start(region, where, review);
    if (region.has_start() && region.start() < reached) {
      const std::string what = i == 0 ? "the start of the axis, " : "the end of the region before, ";
      review.complain(where + ".start", number_text(region.start()) + " m is below " + what + number_text(reached) +
                                            " m; give regions in rising order, without overlap");
    }
    if (region.has_end() && cells.has_end() && region.end() > cells.end()) {
      review.complain(where + ".end", number_text(region.end()) + " m is above the end of the axis, " +
                                          number_text(cells.end()) + " m; give regions inside the axis");
    }
    reached = region.end();
  }
}

void axis_rises(const v1::GridAxis& axis, const std::string& path, Review& review) {
  if (axis.has_uniform()) end_is_behind_start(axis.uniform(), path + ".uniform", review);
  if (axis.has_stretched()) {
    end_is_behind_start(axis.stretched(), path + ".stretched", review);
    if (axis.stretched().end() > axis.stretched().start())
      regions_are_in_order(axis.stretched(), path + ".stretched", review);
  }
  for (int i = 1; i < axis.faces().face_size(); ++i) {
    if (axis.faces().face(i) > axis.faces().face(i - 1)) continue;
    review.complain(path + ".faces.face[" + std::to_string(i) + "]",
                    number_text(axis.faces().face(i)) + " m is not above the face before, " +
                        number_text(axis.faces().face(i - 1)) + " m; give faces in rising order");
    return;
  }
}

/// Formulas are tried at places inside and at times of the run: what is no number there would end the run later.
class FormulaTrial {
 public:
  FormulaTrial(const Space& space, double end_time, Review& review)
      : space_(space), end_time_(end_time > 0 ? end_time : 0), review_(review) {}

  /// `fixed`: direction and position of the border on which the formula is used; none: in the whole fluid.
  void check(const std::string& formula, const std::string& path,
             const std::optional<std::pair<int, double>>& fixed) const {
    if (formula.empty()) return;
    try {
      const Expression expression(formula);
      constexpr std::array shares{0.1, 0.3, 0.5, 0.7, 0.9};
      for (const double t : {0.0, 0.5 * end_time_, end_time_}) {
        for (const double a : shares) {
          for (const double b : shares) {
            for (const double c : shares) {
              std::array<double, 3> at{place(0, a), place(1, b), place(2, c)};
              if (fixed) at[static_cast<std::size_t>(fixed->first)] = fixed->second;
              if (complains(expression, at, t, path)) return;
            }
          }
        }
      }
    } catch (const report::SceneError&) {
      // A formula that cannot be read was complained about by the rules of its field.
    }
  }

  void check(const v1::VectorExpression& formulas, const std::string& path,
             const std::optional<std::pair<int, double>>& fixed) const {
    check(formulas.x(), path + ".x", fixed);
    check(formulas.y(), path + ".y", fixed);
    check(formulas.z(), path + ".z", fixed);
  }

 private:
  double place(std::size_t d, double share) const { return space_.axis[d].start + share * space_.axis[d].length(); }

  bool complains(const Expression& expression, const std::array<double, 3>& at, double t,
                 const std::string& path) const {
    const double value = expression.at(at[0], at[1], at[2], t);
    if (std::isfinite(value)) return false;
    review_.complain(path, "is " + number_text(value) + " at x = " + number_text(at[0]) +
                               ", y = " + number_text(at[1]) + ", z = " + number_text(at[2]) +
                               " m, t = " + number_text(t) + " s; write a formula that is a finite number everywhere");
    return true;
  }

  const Space& space_;
  double end_time_;
  Review& review_;
};

void exact_flow_fits(const v1::ExactFlow& flow, const std::string& path, int n_dimensions, Review& review) {
  if (flow.has_ethier_steinman() && n_dimensions == 2) {
    review.complain(path + ".ethier_steinman",
                    "is a flow in three dimensions, but the grid has no z; give grid.z or another flow");
  }
}

/// The condition of a border or of a patch on it.
template <class Place>
void condition_makes_sense(const Place& place, const std::string& path, int direction, double position,
                           const Space& space, const FormulaTrial& trial, Review& review) {
  const std::pair<int, double> border{direction, position};
  if (place.velocity().has_expression())
    trial.check(place.velocity().expression(), path + ".velocity.expression", border);
  if (place.pressure().has_expression())
    trial.check(place.pressure().expression(), path + ".pressure.expression", border);
  exact_flow_fits(place.velocity().exact(), path + ".velocity.exact", space.n_dimensions, review);
  const v1::Vector& wall = place.no_slip_wall().velocity();
  const double normal = std::array{wall.x(), wall.y(), wall.z()}[static_cast<std::size_t>(direction)];
  if (normal != 0) {
    const std::string name(1, "xyz"[direction]);
    review.complain(path + ".no_slip_wall.velocity." + name,
                    number_text(normal) + " m/s leads through the wall; a wall moves in its own plane: delete " + name);
  }
}

struct Limit {
  const char* name;
  bool is_given;
  double value;
};

std::array<std::array<Limit, 2>, 3> limits_of(const v1::Box& box) {
  return {{{{{"x_from", box.has_x_from(), box.x_from()}, {"x_to", box.has_x_to(), box.x_to()}}},
           {{{"y_from", box.has_y_from(), box.y_from()}, {"y_to", box.has_y_to(), box.y_to()}}},
           {{{"z_from", box.has_z_from(), box.z_from()}, {"z_to", box.has_z_to(), box.z_to()}}}}};
}

/// A box must share something with the grid; `ignored` is a direction that does not count, or -1.
void box_meets_the_grid(const v1::Box& box, const std::string& path, int ignored, const Space& space, Review& review) {
  const auto limits = limits_of(box);
  for (int d = 0; d < 3; ++d) {
    const Extent& extent = space.axis[static_cast<std::size_t>(d)];
    const auto& [from, to] = limits[static_cast<std::size_t>(d)];
    if (d == ignored || !extent.is_known()) continue;
    if (from.is_given && to.is_given && !(to.value > from.value)) {
      review.complain(path + "." + to.name, number_text(to.value) + " m is not above " + from.name + ", " +
                                                number_text(from.value) + " m; give a larger one");
    } else if (from.is_given && from.value >= extent.end) {
      review.complain(path + "." + from.name, number_text(from.value) + " m is beyond the end of the grid, " +
                                                  number_text(extent.end) + " m; give a smaller one");
    } else if (to.is_given && to.value <= extent.start) {
      review.complain(path + "." + to.name, number_text(to.value) + " m is before the start of the grid, " +
                                                number_text(extent.start) + " m; give a larger one");
    }
  }
}

struct NamedBorder {
  const char* name;
  bool is_given;
  const v1::Border& border;
};

void borders_make_sense(const v1::Borders& borders, const Space& space, const FormulaTrial& trial, Review& review) {
  const std::array<NamedBorder, 6> all{{{"x_start", borders.has_x_start(), borders.x_start()},
                                        {"x_end", borders.has_x_end(), borders.x_end()},
                                        {"y_start", borders.has_y_start(), borders.y_start()},
                                        {"y_end", borders.has_y_end(), borders.y_end()},
                                        {"z_start", borders.has_z_start(), borders.z_start()},
                                        {"z_end", borders.has_z_end(), borders.z_end()}}};
  std::set<std::string> names;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const int direction = static_cast<int>(i / 2);
    const Extent& extent = space.axis[i / 2];
    const std::string path = model_path + ".border." + all[i].name;
    if (!all[i].is_given) continue;
    if (direction == 2 && space.n_dimensions == 2) {
      review.complain(path, "is a border along z, but the grid has no z; delete it or give grid.z");
      continue;
    }
    if (extent.is_periodic) {
      const std::string name(1, "xyz"[direction]);
      review.complain(path, "has a condition, but " + name + " is periodic; delete it or grid." + name + ".periodic");
      continue;
    }
    const double position = i % 2 == 0 ? extent.start : extent.end;
    condition_makes_sense(all[i].border, path, direction, position, space, trial, review);
    for (int p = 0; p < all[i].border.patch_size(); ++p) {
      const v1::Patch& patch = all[i].border.patch(p);
      const std::string where = path + ".patch[" + std::to_string(p) + "]";
      condition_makes_sense(patch, where, direction, position, space, trial, review);
      box_meets_the_grid(patch.box(), where + ".box", direction, space, review);
      if (patch.has_name() && !names.insert(patch.name()).second) {
        review.complain(where + ".name",
                        "\"" + patch.name() + "\" is the name of another patch; give each its own name");
      }
    }
  }
}

void blocks_have_cells(const v1::NavierStokes& model, const Space& space, Review& review) {
  if (!model.has_decomposition()) return;
  const v1::Decomposition& blocks = model.decomposition();
  const std::array n_blocks{blocks.x(), blocks.y(), blocks.z()};
  for (std::size_t d = 0; d < 3; ++d) {
    const std::string name(1, "xyz"[d]);
    const int n_cells = space.axis[d].n_cells;
    if (n_blocks[d] <= 1 || n_cells == 0 || n_cells / n_blocks[d] >= smallest_block) continue;
    review.complain(model_path + ".decomposition." + name,
                    std::to_string(n_blocks[d]) + " blocks share " + std::to_string(n_cells) + " cells along " + name +
                        "; a block needs at least " + std::to_string(smallest_block) + " of them");
  }
}

void steps_make_sense(const v1::NavierStokes& model, double time_step, Review& review) {
  if (time_step > 0 && model.smallest_step() > time_step)
    review.complain(model_path + ".smallest_step", number_text(model.smallest_step()) + " s is above time.step, " +
                                                       number_text(time_step) + " s; give a smaller one");
  if (!model.has_largest_step() || model.smallest_step() <= model.largest_step()) return;
  review.complain(model_path + ".smallest_step", number_text(model.smallest_step()) + " s is above largest_step, " +
                                                     number_text(model.largest_step()) + " s; give a smaller one");
}

void start_makes_sense(const v1::NavierStokes& model, const Space& space, const FormulaTrial& trial, Review& review) {
  if (model.initial().has_velocity()) trial.check(model.initial().velocity(), model_path + ".initial.velocity", {});
  exact_flow_fits(model.initial().exact(), model_path + ".initial.exact", space.n_dimensions, review);
  exact_flow_fits(model.compare_with(), model_path + ".compare_with", space.n_dimensions, review);
  if (model.compare_with().has_taylor_green() && space.n_dimensions == 3) {
    review.complain(model_path + ".compare_with.taylor_green",
                    "is exact in two dimensions only, but the grid has a z; delete it");
  }
}

/// Planes, points and balances become columns of one table.
void measurements_differ(const v1::NavierStokes& model, Review& review) {
  std::set<std::string> names;
  const auto check = [&](const std::string& name, const std::string& path) {
    if (name.empty() || names.insert(name).second) return;
    review.complain(path + ".name",
                    "\"" + name + "\" is the name of another plane, probe or balance; give each its own name");
  };
  for (int i = 0; i < model.plane_size(); ++i) check(model.plane(i).name(), entry(model_path + ".plane", i));
  for (int i = 0; i < model.probe_size(); ++i) check(model.probe(i).name(), entry(model_path + ".probe", i));
  for (int i = 0; i < model.momentum_balance_size(); ++i)
    check(model.momentum_balance(i).name(), entry(model_path + ".momentum_balance", i));
}

void place_is_on_the_axis(double position, int direction, const std::string& path, const Space& space, Review& review) {
  const Extent& extent = space.axis[static_cast<std::size_t>(direction)];
  if (!extent.is_known() || (position >= extent.start && position <= extent.end)) return;
  review.complain(path, number_text(position) + " m is outside the grid, which reaches from " +
                            number_text(extent.start) + " to " + number_text(extent.end) + " m; give a place inside");
}

void places_are_inside(const v1::NavierStokes& model, const Space& space, Review& review) {
  for (int i = 0; i < model.plane_size(); ++i) {
    const v1::Plane& plane = model.plane(i);
    if (!plane.has_normal()) continue;
    const int direction = plane.normal() - v1::Plane::X;
    if (direction == 2 && space.n_dimensions == 2) {
      review.complain(entry(model_path + ".plane", i) + ".normal",
                      "Z is no direction of a grid without z; choose X or Y");
      continue;
    }
    if (plane.has_position()) {
      place_is_on_the_axis(plane.position(), direction, entry(model_path + ".plane", i) + ".position", space, review);
    }
    box_meets_the_grid(plane.box(), entry(model_path + ".plane", i) + ".box", direction, space, review);
  }
  for (int i = 0; i < model.probe_size(); ++i) {
    const v1::Vector& at = model.probe(i).at();
    const std::array position{at.x(), at.y(), at.z()};
    for (int d = 0; d < space.n_dimensions; ++d) {
      place_is_on_the_axis(position[static_cast<std::size_t>(d)], d,
                           entry(model_path + ".probe", i) + ".at." + std::string(1, "xyz"[d]), space, review);
    }
  }
  for (int i = 0; i < model.momentum_balance_size(); ++i)
    box_meets_the_grid(model.momentum_balance(i).box(), entry(model_path + ".momentum_balance", i) + ".box", -1, space,
                       review);
}

void stored_fields_make_sense(const v1::Scene& scene, const Space& space, Review& review) {
  const v1::NavierStokes& model = scene.flow().navier_stokes();
  std::set<std::string> names;
  for (int i = 0; i < model.field_size(); ++i) {
    const v1::FieldOutput& field = model.field(i);
    if (!names.insert(field.name()).second) {
      review.complain(entry(model_path + ".field", i) + ".name",
                      "\"" + field.name() + "\" is the name of another field; give each its own name");
    }
    box_meets_the_grid(field.box(), entry(model_path + ".field", i) + ".box", -1, space, review);
    std::set<int> quantities;
    for (int q = 0; q < field.quantity_size(); ++q) {
      if (quantities.insert(field.quantity(q)).second) continue;
      review.complain(entry(model_path + ".field", i) + ".quantity[" + std::to_string(q) + "]",
                      v1::FieldOutput::Quantity_Name(field.quantity(q)) + " stands there already; name each once");
    }
  }
  if (model.field_size() > 0 && !scene.output().has_results_interval()) {
    review.complain(entry(model_path + ".field", 0),
                    "is never stored; give output.results_interval, the time between two stored states");
  }
}

}  // namespace

void check_navier_stokes_rules(const v1::Scene& scene, Review& review) {
  const v1::NavierStokes& model = scene.flow().navier_stokes();
  const Space space = space_of(model.grid());
  const FormulaTrial trial(space, scene.time().end(), review);
  axis_rises(model.grid().x(), model_path + ".grid.x", review);
  axis_rises(model.grid().y(), model_path + ".grid.y", review);
  axis_rises(model.grid().z(), model_path + ".grid.z", review);
  if (model.grid().has_z() && model.grid().has_depth()) {
    review.complain(model_path + ".grid.depth", "is for a grid without z; delete depth or z");
  }
  borders_make_sense(model.border(), space, trial, review);
  if (model.body_force().has_expression())
    trial.check(model.body_force().expression(), model_path + ".body_force.expression", {});
  trial.check(model.fluid_where(), model_path + ".fluid_where", {});
  start_makes_sense(model, space, trial, review);
  steps_make_sense(model, scene.time().step(), review);
  blocks_have_cells(model, space, review);
  measurements_differ(model, review);
  places_are_inside(model, space, review);
  stored_fields_make_sense(scene, space, review);
}

}  // namespace couplet::scene
