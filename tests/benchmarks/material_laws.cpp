// bench material-laws: what energy, stress and tangent of each law cost at a point, eight points at once, and how far
// they are from the answers for single points.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "proto/report/failure.hpp"
#include "solid-server/material/material.hpp"

namespace {

using namespace couplet::solid;

constexpr int n_packs = 64;           // the numbers of all stay in the second-level cache
constexpr double seconds_each = 0.2;  // of measuring a number

/// Deformations of up to a tenth or two, and axes, of eight points; their answers.
struct Points {
  StoredPack F[n_packs][9], axes[n_packs][6], answer[n_packs][81];

  Points() {
    for (int p = 0; p < n_packs; ++p)
      for (int lane = 0; lane < n_lanes; ++lane) {
        for (int n = 0; n < 9; ++n)
          F[p][n].lane[lane] = (n % 4 == 0 ? 1 : 0) + 0.1 * std::sin(1 + 3.7 * n + 0.9 * p + 2.3 * lane);
        const double angle = 0.2 * lane + p;
        const double directions[6] = {std::cos(angle), std::sin(angle), 0, -std::sin(angle), std::cos(angle), 0};
        for (int n = 0; n < 6; ++n) axes[p][n].lane[lane] = directions[n];
      }
  }
};

/// The numbers of the upper half, as kernels that know the symmetry read it.
template <class Real>
[[gnu::always_inline]] inline void put(const BasicTangent<Real>& tangent, const auto& keep) {
#pragma GCC unroll 81
  for (int n = 0; n < 81; ++n)
    if (n % 9 >= n / 9) keep(n, tangent.at[n / 9][n % 9]);
}
template <class Real>
[[gnu::always_inline]] inline void put(const Tensor<Real>& stress, const auto& keep) {
#pragma GCC unroll 9
  for (int n = 0; n < 9; ++n) keep(n, stress.at[n / 3][n % 3]);
}
template <class Real>
[[gnu::always_inline]] inline void put(const Real& energy, const auto& keep) {
  keep(0, energy);
}

/// What is asked for.
struct Energy {
  [[gnu::always_inline]] inline auto operator()(const auto& law, const auto& F, const auto& axes) const {
    return energy_of(law, F, axes);
  }
};
struct Stress {
  [[gnu::always_inline]] inline auto operator()(const auto& law, const auto& F, const auto& axes) const {
    return stress_of(law, F, axes);
  }
};
struct TangentOf {
  [[gnu::always_inline]] inline auto operator()(const auto& law, const auto& F, const auto& axes) const {
    return tangent_of(law, F, axes);
  }
};

/// All points; `answer` is one of the three above.
template <class Law>
[[gnu::noinline]] void evaluate(const Law& law, const auto& answer, Points& points) {
  for (int p = 0; p < n_packs; ++p) {
    Tensor<Pack> F;
    LocalAxes<Pack> axes;
    for (int n = 0; n < 9; ++n) F.at[n / 3][n % 3] = load(points.F[p][n]);
    for (int n = 0; n < 6; ++n) axes.at[n / 3][n % 3] = load(points.axes[p][n]);
    put(answer(law, F, axes), [&](int n, const Pack& value) { store(value, points.answer[p][n]); });
  }
}

/// Largest difference to the answers for single points, over the largest answer.
template <class Law>
double relative_error(const Law& law, const auto& answer, const Points& points) {
  double difference = 0, largest = 0;
  for (int p = 0; p < n_packs; ++p)
    for (int lane = 0; lane < n_lanes; ++lane) {
      Tensor<double> F;
      LocalAxes<double> axes;
      for (int n = 0; n < 9; ++n) F.at[n / 3][n % 3] = points.F[p][n].lane[lane];
      for (int n = 0; n < 6; ++n) axes.at[n / 3][n % 3] = points.axes[p][n].lane[lane];
      put(answer(law, F, axes), [&](int n, double value) {
        difference = std::max(difference, std::abs(value - points.answer[p][n].lane[lane]));
        largest = std::max(largest, std::abs(value));
      });
    }
  return difference / largest;
}

struct Row {
  std::string material, answer;
  double ns_per_point = 0, relative_error = 0;
};

/// The fastest of many evaluations: other programs on the machine can only slow one down.
template <class Law>
Row measure(const std::string& material, const Law& law, const std::string& name, const auto& answer) {
  using Clock = std::chrono::steady_clock;
  static Points points;
  double fastest = 1e9;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds_each);
  while (Clock::now() < end) {
    const auto started = Clock::now();
    evaluate(law, answer, points);
    fastest = std::min(fastest, std::chrono::duration<double>(Clock::now() - started).count());
  }
  return {material, name, fastest / (n_packs * n_lanes) * 1e9, relative_error(law, answer, points)};
}

int run(int argc, char** argv) {
  const std::string about =
      "energy, stress and tangent of each law, eight points at once: time per point, and difference to single points";
  CLI::App app(about);
  std::string json;
  bool says_about = false;
  app.add_option("--json", json, "write the rows there");
  app.add_flag("--about", says_about, "say in one line what is measured");
  CLI11_PARSE(app, argc, argv);
  if (says_about) {
    std::printf("%s\n", about.c_str());
    return 0;
  }
  const std::vector<std::pair<std::string, Material>> materials = {
      {"saint_venant_kirchhoff", SaintVenantKirchhoff::from_young(15e3, 0.475)},
      {"neo_hookean", NeoHookean{5080, 100e3}},
      {"mooney_rivlin", MooneyRivlin{2290, 250, 100e3}},
      {"holzapfel_gasser_ogden", HolzapfelGasserOgden{3000, 100e3, 2363, 0.84, 0.1}.with_fibres_at(0.5)},
      {"may_newman", MayNewman{399, 4.325, 1446.5, 500, 100e3}}};
  std::vector<Row> rows;
  for (const auto& [name, material] : materials)
    std::visit(
        [&, &material_name = name](const auto& law) {
          rows.push_back(measure(material_name, law, "energy", Energy{}));
          rows.push_back(measure(material_name, law, "stress", Stress{}));
          rows.push_back(measure(material_name, law, "tangent", TangentOf{}));
        },
        material);
  std::printf("%-24s %-8s %14s %14s\n", "material", "answer", "ns_per_point", "relative_error");
  auto list = nlohmann::ordered_json::array();
  for (const Row& row : rows) {
    std::printf("%-24s %-8s %14.2f %14.1e\n", row.material.c_str(), row.answer.c_str(), row.ns_per_point,
                row.relative_error);
    list.push_back({{"material", row.material},
                    {"answer", row.answer},
                    {"ns_per_point", row.ns_per_point},
                    {"relative_error", row.relative_error}});
  }
  if (json.empty()) return 0;
  std::ofstream file(json);
  file << list.dump(2) << '\n';
  if (!file) throw couplet::report::FileError(json, "cannot be written");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return couplet::report::run_program("bench material-laws", run, argc, argv);
}
