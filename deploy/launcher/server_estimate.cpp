#include "deploy/launcher/server_estimate.hpp"

#include <nlohmann/json.hpp>

#include "deploy/launcher/external_program.hpp"
#include "proto/report/failure.hpp"

namespace couplet::launcher {

std::vector<Estimate> ask_for_estimate(const std::string& program, const std::filesystem::path& scene,
                                       const std::vector<std::string>& settings, const Installation& installation) {
  std::vector<std::string> command{installation.program(program), "check", scene.string(), "--json"};
  for (const std::string& setting : settings) command.insert(command.end(), {"--set", setting});
  const ProgramResult result = run_and_catch(command);
  if (result.exit_code != 0) {
    // The last line that the program said, without its name.
    std::string reason = result.errors.substr(0, result.errors.find_last_not_of(" \n") + 1);
    reason = reason.substr(reason.rfind('\n') + 1);
    if (reason.starts_with(program + ": ")) reason = reason.substr(program.size() + 2);
    throw report::SceneError(scene.string(), reason);
  }
  std::vector<Estimate> estimates;
  const auto numbers = nlohmann::ordered_json::parse(result.output);
  for (const auto& [name, number] : numbers.items()) {
    if (number.contains("text"))
      estimates.push_back({program, name, "", 0, number.at("text")});
    else if (number.at("value").is_number())
      estimates.push_back({program, name, number.at("unit"), number.at("value")});
  }
  return estimates;
}

}  // namespace couplet::launcher
