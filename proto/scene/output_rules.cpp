#include <algorithm>
#include <set>

#include "proto/scene/marker_rules.hpp"
#include "proto/scene/relation_rules.hpp"
#include "proto/scene/wording.hpp"

namespace couplet::scene {

namespace {

// Probes and quantities are found by their names.
template <class Entries>
void names_differ(const Entries& entries, const std::string& list, const std::string& what, Review& review) {
  for (int i = 0; i < entries.size(); ++i) {
    for (int j = 0; j < i && entries[i].has_name(); ++j) {
      if (entries[i].name() != entries[j].name()) continue;
      review.complain(entry("output." + list, i) + ".name",
                      "\"" + entries[i].name() + "\" is the name of another " + what + "; give each its own name");
      break;
    }
  }
}

// Columns of history.csv are found by their names: those of probes, of orifices and the clock must differ.
void columns_differ(const v1::Scene& scene, Review& review) {
  std::set<std::string> taken = {"time", "dt", "iterations", "inner_iterations"};
  for (const v1::Probe& probe : scene.output().probe())
    for (const char axis : {'x', 'y', 'z'}) taken.insert(probe.name() + "." + axis);
  for (int i = 0; i < scene.solid().orifice_size(); ++i) {
    const v1::Orifice& orifice = scene.solid().orifice(i);
    if (orifice.has_name() && !taken.insert(orifice.name()).second)
      review.complain("solid.orifice[" + std::to_string(i) + "].name",
                      "\"" + orifice.name() + "\" is another column of history.csv; give the orifice its own name");
  }
}

void probes_are_on_the_solid(const v1::Scene& scene, Review& review) {
  for (int i = 0; i < scene.output().probe_size(); ++i) {
    const std::string path = entry("output.probe", i);
    if (!scene.has_solid()) review.complain(path, "is a point of the solid, but the scene has none; delete it");
    check_marker(scene.output().probe(i).at(), path + ".at", scene.solid(), review);
  }
}

// NAME.x, NAME.y and NAME.z are the columns of a probe; other columns are known to the servers only, solid.reaction...
// too.
void column_has_its_probe(const std::string& column, const v1::Output& output, const std::string& path,
                          Review& review) {
  if (column.starts_with("solid.")) return;
  const std::size_t dot = column.rfind('.');
  if (dot == std::string::npos || dot + 2 != column.size() || column[dot + 1] < 'x' || column[dot + 1] > 'z') return;
  const std::string name = column.substr(0, dot);
  if (name.starts_with("solid.") || name.starts_with("flow.")) return;  // reactions, forces: a server's own
  std::vector<std::string> known;
  for (const v1::Probe& probe : output.probe()) known.push_back(probe.name());
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  review.complain(path, "\"" + column + "\" is the column of a probe, but there is no probe \"" + name + "\"; " +
                            (known.empty() ? "add probe { name: \"" + name + "\" ... }"
                                           : suggestion(name, known, "the probes are")));
}

// A window may be longer than the run, so that a scene can be tried for a short time: all of the run is used then.
void window_ends_in_the_run(const v1::Quantity& quantity, const std::string& path, double end, Review& review) {
  if (!(end > 0) || quantity.until() <= end) return;
  review.complain(path + ".until", number_text(quantity.until()) + " s is after the end of the run, " +
                                       number_text(end) + " s; give an earlier time");
}

void quantity_can_be_computed(const v1::Quantity& quantity, const std::string& path, const v1::Scene& scene,
                              Review& review) {
  column_has_its_probe(quantity.column(), scene.output(), path + ".column", review);
  column_has_its_probe(quantity.reference(), scene.output(), path + ".reference", review);
  if (quantity.kind() == v1::Quantity::PHASE_DELAY && !quantity.has_reference()) {
    review.complain_missing(path + ".reference",
                            "is missing, but PHASE_DELAY needs it; name the column that the phase is measured against");
  }
  if (quantity.frequency_to() <= quantity.frequency_from()) {
    const std::string which = quantity.has_frequency_to() ? ".frequency_to" : ".frequency_from";
    review.complain(path + which, "the range of frequencies ends at " + number_text(quantity.frequency_to()) +
                                      " Hz but starts at " + number_text(quantity.frequency_from()) +
                                      " Hz; give a frequency_to above frequency_from");
  }
  window_ends_in_the_run(quantity, path, scene.time().end(), review);
}

void fields_of_the_solid_are_stored(const v1::Scene& scene, Review& review) {
  const auto& fields = scene.solid().field();
  for (int i = 0; i < fields.size(); ++i)
    if (std::find(fields.begin(), fields.begin() + i, fields[i]) != fields.begin() + i)
      review.complain("solid.field[" + std::to_string(i) + "]",
                      v1::Solid::Field_Name(fields[i]) + " stands there already; name each once");
  if (!fields.empty() && !scene.output().has_results_interval())
    review.complain("solid.field[0]",
                    "is never stored; give output.results_interval, the time between two stored states");
}

}  // namespace

void check_output_rules(const v1::Scene& scene, Review& review) {
  const v1::Output& output = scene.output();
  names_differ(output.probe(), "probe", "probe", review);
  names_differ(output.quantity(), "quantity", "quantity", review);
  columns_differ(scene, review);
  probes_are_on_the_solid(scene, review);
  fields_of_the_solid_are_stored(scene, review);
  for (int i = 0; i < output.quantity_size(); ++i) {
    quantity_can_be_computed(output.quantity(i), entry("output.quantity", i), scene, review);
  }
}

}  // namespace couplet::scene
