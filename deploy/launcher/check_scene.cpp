#include "deploy/launcher/check_scene.hpp"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "deploy/launcher/checked_scene.hpp"
#include "deploy/launcher/external_program.hpp"
#include "deploy/launcher/launch_plan.hpp"
#include "proto/report/failure.hpp"

namespace couplet::launcher {
namespace {

struct Estimate {
  std::string program, name, unit;
  double value = 0;
};

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

/// What a server says that a run of this scene would need.
std::vector<Estimate> ask(const std::string& program, const std::filesystem::path& scene,
                          const std::vector<std::string>& settings, const Installation& installation) {
  std::vector<std::string> command{installation.program(program), "check", scene.string(), "--json"};
  for (const std::string& setting : settings) command.insert(command.end(), {"--set", setting});
  const ProgramResult result = run_and_catch(command);
  if (result.exit_code != 0) {
    throw report::SceneError(scene.string(), program + " cannot estimate this scene: " + result.errors);
  }
  std::vector<Estimate> estimates;
  const auto numbers = nlohmann::ordered_json::parse(result.output);
  for (const auto& [name, number] : numbers.items()) {
    if (number.at("value").is_number()) estimates.push_back({program, name, number.at("unit"), number.at("value")});
  }
  return estimates;
}

std::string launch_sentence(const v1::Scene& scene) {
  if (!scene.has_solid()) return "flow-server alone";
  if (!scene.has_flow()) return "solid-server alone";
  return "flow-server, solid-server and coupler";
}

void print(const std::vector<Estimate>& estimates) {
  for (const Estimate& estimate : estimates) {
    std::printf("  %-14s %-28s %s\n", estimate.program.c_str(), estimate.name.c_str(),
                quantity_text(estimate.name, estimate.value, estimate.unit).c_str());
  }
}

}  // namespace

void check_scene(const std::filesystem::path& scene, const std::vector<std::string>& settings) {
  const v1::Scene checked = read_checked_scene(scene, settings).scene;
  const Installation installation = find_installation();
  std::printf("%s\n", checked.title().c_str());
  std::printf("  %-14s %s\n", "launches", launch_sentence(checked).c_str());
  const double n_steps = std::ceil(checked.time().end() / checked.time().step() - 1e-9);
  std::printf("  %-14s %.0f of %g s to t = %g s\n", "time steps", n_steps, checked.time().step(), checked.time().end());
  std::fflush(stdout);
  if (checked.has_flow()) print(ask("flow-server", scene, settings, installation));
  if (checked.has_solid()) print(ask("solid-server", scene, settings, installation));
}

}  // namespace couplet::launcher
