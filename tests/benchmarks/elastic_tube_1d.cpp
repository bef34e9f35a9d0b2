// Coupling iterations on the one-dimensional elastic tube, beside published ones.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "proto/report/failure.hpp"
#include "proto/report/version.hpp"
#include "tests/oracle/coupled_march.hpp"
#include "tests/oracle/elastic_tube_participants.hpp"

namespace {

using couplet::v1::Coupling;

constexpr const char* about = "coupling iterations per step on the 1D elastic tube, beside those of preCICE 3.4.1";

struct Case {
  double young_modulus, step;
  std::string scheme;
  std::string published;  // preCICE 3.4.1, mean iterations (max)
  std::function<void(Coupling&)> choose;
};

struct Row {
  Case tube;
  double iterations_mean = 0;
  int iterations_max = 0;
  int steps_failed = 0;  // attempts that were thrown away
};

Coupling make_coupling(const Case& tube) {
  Coupling coupling;
  for (const char* field : {"area", "pressure"}) {
    auto* criterion = coupling.add_convergence();
    criterion->set_field(field);
    criterion->set_relative(1e-5);
  }
  if (tube.choose) tube.choose(coupling);
  return coupling;
}

Row measure(const Case& tube) {
  couplet::oracle::ElasticTube numbers;
  numbers.young_modulus = tube.young_modulus;
  couplet::oracle::ElasticTubeFlow flow(numbers);
  couplet::oracle::ElasticTubeWall wall(numbers);
  Row row{tube};
  try {
    const auto march = couplet::oracle::march(flow, wall, make_coupling(tube), 1, tube.step);
    row.iterations_mean = march.iterations_mean();
    row.iterations_max = march.iterations_max();
    row.steps_failed = march.n_discarded;
  } catch (const couplet::report::NumericsError&) {
    row.iterations_mean = NAN;
    row.steps_failed = 1;
  }
  return row;
}

std::string published_default(double young_modulus, double step) {
  if (step == 0.01) {
    if (young_modulus == 1e5) return "5.62";
    if (young_modulus == 3e4) return "6.80";
    if (young_modulus == 1e4) return "8.50 (20)";
    return "fails; 13.5 by hand-tuned first relaxation";
  }
  if (young_modulus != 1e4) return "";
  if (step == 0.02) return "8.56";
  return step == 0.005 ? "9.58" : "fails; 33 by hand-tuned first relaxation";
}

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (const double young_modulus : {1e5, 3e4, 1e4, 5e3}) {
    for (const double step : {0.02, 0.01, 0.005, 0.002}) {
      cases.push_back({young_modulus, step, "default", published_default(young_modulus, step), {}});
    }
  }
  const auto add = [&](const std::string& scheme, const std::string& published, std::function<void(Coupling&)> choose) {
    cases.push_back({1e4, 0.01, scheme, published, [choose = std::move(choose)](Coupling& coupling) {
                       coupling.set_iterations_max(2000);
                       coupling.set_halvings_max(0);
                       choose(coupling);
                     }});
  };
  add("quadratic predictor", "", [](Coupling& c) { c.set_predictor(Coupling::QUADRATIC); });
  add("iqn_ils, 8 steps, constant predictor", "8.50 (20)", [](Coupling& c) {
    c.set_predictor(Coupling::CONSTANT);
    c.mutable_iqn_ils()->set_steps_reused(8);
  });
  add("iqn_ils without reuse", "fails in step 4", [](Coupling& c) { c.mutable_iqn_ils()->set_steps_reused(0); });
  add("iqn_imvj", "9.33", [](Coupling& c) { c.mutable_iqn_imvj(); });
  add("aitken", "60.3 (93)", [](Coupling& c) { c.mutable_aitken(); });
  add("constant 0.01", "370 (first step)", [](Coupling& c) {
    c.mutable_constant()->set_displacement(0.01);
    c.mutable_constant()->set_force(1);
  });
  add("parallel, default", "", [](Coupling& c) { c.set_scheme(Coupling::PARALLEL_IMPLICIT); });
  return cases;
}

void print(const Row& row) {
  std::printf("%8g %7g  %-38s %8.2f %6d %7d   %s\n", row.tube.young_modulus, row.tube.step, row.tube.scheme.c_str(),
              row.iterations_mean, row.iterations_max, row.steps_failed, row.tube.published.c_str());
  std::fflush(stdout);
}

nlohmann::ordered_json as_json(const Row& row) {
  nlohmann::ordered_json object;
  object["E"] = row.tube.young_modulus;
  object["dt"] = row.tube.step;
  object["scheme"] = row.tube.scheme;
  object["iterations_mean"] = row.iterations_mean;
  object["iterations_max"] = row.iterations_max;
  object["steps_failed"] = row.steps_failed;
  object["published"] = row.tube.published;
  object["commit"] = couplet::report::commit();
  return object;
}

int run(int argc, char** argv) {
  CLI::App app(about, "bench-elastic-tube-1d");
  std::string json;
  app.add_option("--json", json, "write the rows there");
  bool wants_about = false;
  app.add_flag("--about", wants_about, "say in one line what is measured");
  CLI11_PARSE(app, argc, argv);
  if (wants_about) return std::printf("%s\n", about), 0;

  std::printf("tolerance 1e-5 on area and pressure, t = 0 ... 1, serial-implicit; published: preCICE 3.4.1\n");
  std::printf("%8s %7s  %-38s %8s %6s %7s   %s\n", "E", "dt", "scheme", "mean", "max", "failed",
              "published mean (max)");
  auto rows = nlohmann::ordered_json::array();
  for (const Case& tube : all_cases()) {
    const Row row = measure(tube);
    print(row);
    rows.push_back(as_json(row));
  }
  if (!json.empty()) std::ofstream(json) << rows.dump(1) << "\n";
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return couplet::report::run_program("bench-elastic-tube-1d", run, argc, argv);
}
