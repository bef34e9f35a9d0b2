#include "coupler/scheme/interface_layout.hpp"

#include <algorithm>

#include "proto/report/failure.hpp"

namespace couplet::coupling {

namespace {

std::vector<std::string> names_of(const std::vector<Segment>& segments) {
  std::vector<std::string> names;
  for (const Segment& segment : segments) names.push_back(segment.name);
  return names;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "nothing" : text;
}

// The fields that `taker` needs, as `giver` offers them, on the solid's nodes.
std::vector<Segment> plan(const participant::Opened& giver, const std::string& giver_name,
                          const participant::Opened& taker, const std::string& taker_name, Eigen::Index n_nodes) {
  std::vector<Segment> segments;
  for (const std::string& need : taker.needs) {
    if (std::find(giver.offers.begin(), giver.offers.end(), need) == giver.offers.end()) {
      throw report::SceneError("",
                               "the " + taker_name + " needs the field '" + need + "', but the " + giver_name +
                                   " offers " + listed(giver.offers),
                               "choose models of flow and solid that exchange the same fields");
    }
    const surface::Field& field = surface::find_field(giver.fields, need);
    segments.push_back({need, field.unit, static_cast<int>(field.values.cols()), 0, n_nodes * field.values.cols()});
  }
  if (segments.empty()) {
    throw report::SceneError("", "the " + taker_name + " needs nothing from the " + giver_name,
                             "run it on its own: there is nothing to couple");
  }
  return segments;
}

void place(std::vector<Segment>& segments) {
  Eigen::Index offset = 0;
  for (Segment& segment : segments) {
    segment.offset = offset;
    offset += segment.size;
  }
}

}  // namespace

InterfaceLayout make_interface_layout(const participant::Opened& flow, const participant::Opened& solid) {
  InterfaceLayout layout;
  const Eigen::Index n_nodes = solid.surface.n_nodes();
  layout.motion = plan(solid, "solid", flow, "flow", n_nodes);
  layout.load = plan(flow, "flow", solid, "solid", n_nodes);

  // A velocity follows its displacement: it goes last and does not determine the coefficients of an acceleration.
  const auto names = names_of(layout.motion);
  const bool has_displacement = std::find(names.begin(), names.end(), "displacement") != names.end();
  const auto determines = [&](const Segment& segment) { return !has_displacement || segment.name == "displacement"; };
  std::stable_partition(layout.motion.begin(), layout.motion.end(), determines);
  place(layout.motion);
  place(layout.load);
  for (const Segment& segment : layout.motion) layout.n_primary_motion += determines(segment) ? segment.size : 0;
  return layout;
}

}  // namespace couplet::coupling
