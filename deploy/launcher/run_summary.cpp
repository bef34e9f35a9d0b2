#include "deploy/launcher/run_summary.hpp"

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "proto/report/version.hpp"

namespace couplet::launcher {
namespace {

using Json = nlohmann::ordered_json;

/// An empty object when there is none, or one that was cut off.
Json read_summary(const store::RunFolder& folder) {
  std::ifstream file(folder.summary());
  Json summary = Json::parse(file, nullptr, false);
  return summary.is_object() ? summary : Json::object();
}

std::string number(double value, const char* format = "%.5g") {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string quantity_line(const std::string& name, const Json& quantity) {
  char text[160];
  const Json value = quantity.value("value", Json());
  const std::string unit = quantity.value("unit", "");
  std::snprintf(text, sizeof text, "  %-24s %12s %-8s", name.c_str(),
                value.is_number() ? number(value.get<double>()).c_str() : "-", unit == "1" ? "" : unit.c_str());
  std::string line = text;
  if (quantity.contains("spread") && quantity["spread"].is_number()) {
    line += " spread " + number(quantity["spread"].get<double>(), "%.2g");
  }
  if (quantity.contains("cycles") && quantity["cycles"].is_number()) {
    line += " over " + number(quantity["cycles"].get<double>(), "%.0f") + " cycles";
  }
  return line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
}

/// The status, unless the program that owned time has said the same.
void settle_status(Json& summary, const std::string& scene, const Verdict& verdict, bool stop_requested) {
  const std::string wanted = verdict.exit_code != 0 ? "failed" : stop_requested ? "stopped" : "finished";
  const std::string found = summary.value("status", "");
  const bool is_right = verdict.exit_code == 0 ? !found.empty() && found != "failed"
                                               : found == wanted && summary.value("failure", "") == verdict.sentence;
  if (is_right) return;
  summary["status"] = wanted;
  if (verdict.exit_code != 0) summary["failure"] = verdict.sentence;
  if (!summary.contains("scene")) summary["scene"] = scene;
  if (!summary.contains("version")) summary["version"] = report::version();
  if (!summary.contains("commit")) summary["commit"] = report::commit();
}

}  // namespace

void settle_summary(const store::RunFolder& folder, const std::string& scene, const Verdict& verdict,
                    bool stop_requested, int n_restarts, const std::map<std::string, std::string>& own_programs) {
  Json summary = read_summary(folder);
  const Json before = summary;
  if (!own_programs.empty()) summary["own_programs"] = own_programs;
  if (n_restarts > 0) summary["restarts"] = n_restarts;
  settle_status(summary, scene, verdict, stop_requested);
  if (summary != before) store::write_file(folder.summary(), summary.dump(2) + "\n");
}

std::string summary_table(const store::RunFolder& folder) {
  const Json summary = read_summary(folder);
  std::string text = summary.value("status", std::string("no summary"));
  if (summary.contains("steps")) text += ": " + std::to_string(summary["steps"].get<std::int64_t>()) + " steps";
  if (summary.contains("end_time")) text += " to t = " + number(summary["end_time"].get<double>()) + " s";
  if (summary.contains("wall_seconds")) text += " in " + number(summary["wall_seconds"].get<double>(), "%.3g") + " s";
  text += "\n";
  const Json own_programs = summary.value("own_programs", Json::object());
  for (const auto& [name, command] : own_programs.items())
    text += "  " + name + " is " + command.get<std::string>() + "\n";
  const Json quantities = summary.value("quantities", Json::object());
  for (const auto& [name, quantity] : quantities.items()) text += quantity_line(name, quantity);
  return text;
}

}  // namespace couplet::launcher
