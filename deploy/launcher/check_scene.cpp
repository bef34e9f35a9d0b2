#include "deploy/launcher/check_scene.hpp"

#include <cmath>
#include <cstdio>

#include "deploy/launcher/checked_scene.hpp"
#include "deploy/launcher/flow_ranks.hpp"
#include "deploy/launcher/installation.hpp"
#include "deploy/launcher/server_estimate.hpp"

namespace couplet::launcher {
namespace {

std::string quantity_text(const std::string& name, double value, const std::string& unit) {
  char text[48];
  if (name.ends_with("bytes")) {
    std::snprintf(text, sizeof text, "%.1f MiB", value / (1024 * 1024));
  } else if (unit == "1") {
    std::snprintf(text, sizeof text, std::floor(value) == value ? "%.0f" : "%.4g", value);
  } else {
    std::snprintf(text, sizeof text, "%.4g %s", value, unit.c_str());
  }
  return text;
}

std::string launch_sentence(const v1::Scene& scene, int n_flow_ranks) {
  const std::string ranks = n_flow_ranks > 1 ? " on " + std::to_string(n_flow_ranks) + " ranks" : "";
  if (!scene.has_solid()) return "flow-server alone" + ranks;
  if (!scene.has_flow()) return "solid-server alone";
  return "flow-server" + ranks + ", solid-server and coupler";
}

void print(const std::vector<Estimate>& estimates) {
  for (const Estimate& estimate : estimates) {
    std::printf("  %-14s %-28s %s\n", estimate.program.c_str(), estimate.name.c_str(),
                estimate.text.empty() ? quantity_text(estimate.name, estimate.value, estimate.unit).c_str()
                                      : estimate.text.c_str());
  }
}

}  // namespace

void check_scene(const std::filesystem::path& scene, const std::vector<std::string>& settings) {
  const v1::Scene checked = read_checked_scene(scene, settings).scene;
  const Installation installation = find_installation();
  std::printf("%s\n", checked.title().c_str());
  RunOptions options;
  options.scene = scene;
  options.settings = settings;
  const int n_flow_ranks = choose_flow_ranks(checked, options, installation);
  std::printf("  %-14s %s\n", "launches", launch_sentence(checked, n_flow_ranks).c_str());
  const double n_steps = std::ceil(checked.time().end() / checked.time().step() - 1e-9);
  std::printf("  %-14s %.0f of %g s to t = %g s\n", "time steps", n_steps, checked.time().step(), checked.time().end());
  std::fflush(stdout);
  if (checked.has_flow()) print(ask_for_estimate("flow-server", scene, settings, installation));
  if (checked.has_solid()) print(ask_for_estimate("solid-server", scene, settings, installation));
}

}  // namespace couplet::launcher
