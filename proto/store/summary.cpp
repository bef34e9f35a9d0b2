#include "proto/store/summary.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "proto/report/version.hpp"
#include "proto/store/run_folder.hpp"

namespace couplet::store {

namespace {

using Json = nlohmann::ordered_json;

/// JSON knows neither infinity nor not-a-number.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json programs(const std::vector<ProgramCost>& costs) {
  Json object = Json::object();
  for (const ProgramCost& cost : costs) {
    Json& entry = object[cost.program];
    entry["seconds"] = number(cost.seconds);
    entry["peak_memory_bytes"] = number(cost.peak_memory_bytes);
    for (const SummaryQuantity& more : cost.more)
      entry[more.name] = more.text.empty() ? number(more.value) : Json(more.text);
  }
  return object;
}

Json quantities(const std::vector<SummaryQuantity>& all) {
  Json object = Json::object();
  for (const SummaryQuantity& quantity : all) {
    Json& entry = object[quantity.name];
    entry["value"] = number(quantity.value);
    entry["unit"] = quantity.unit;
    if (!(quantity.spread < 0)) entry["spread"] = number(quantity.spread);
    if (!(quantity.n_cycles < 0)) entry["cycles"] = number(quantity.n_cycles);
  }
  return object;
}

}  // namespace

void write_summary(const std::filesystem::path& path, const Summary& summary) {
  Json object;
  object["status"] = summary.status;
  if (!summary.failure.empty()) object["failure"] = summary.failure;
  object["scene"] = summary.scene;
  object["version"] = report::version();
  object["commit"] = report::commit();
  object["steps"] = summary.steps;
  object["end_time"] = number(summary.end_time);
  object["wall_seconds"] = number(summary.wall_seconds);
  object["core_seconds"] = number(summary.core_seconds);
  if (summary.coupled) {
    object["coupling"] = {{"iterations_mean", number(summary.iterations_mean)},
                          {"iterations_max", summary.iterations_max},
                          {"residual_at_acceptance_max", number(summary.residual_at_acceptance_max)}};
    object["conservation"] = {{"force_error_max", number(summary.force_error_max)},
                              {"moment_error_max", number(summary.moment_error_max)},
                              {"work_error_max", number(summary.work_error_max)}};
  }
  if (summary.n_checkpoints > 0)
    object["checkpoints"] = {{"written", summary.n_checkpoints}, {"seconds", number(summary.checkpoint_seconds)}};
  if (!summary.programs.empty()) object["programs"] = programs(summary.programs);
  if (!summary.quantities.empty()) object["quantities"] = quantities(summary.quantities);
  // Text that is not UTF-8 (a path, say) is mended and not refused.
  write_file(path, object.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace couplet::store
