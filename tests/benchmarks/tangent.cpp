// bench tangent: what the tangent of a body costs, from elements to a solution.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <thread>

#include "proto/report/failure.hpp"
#include "solid-server/assembly/dense_kernels.hpp"
#include "solid-server/assembly/sparse_cholesky.hpp"
#include "solid-server/assembly/tangent_solver.hpp"
#include "solid-server/dynamics/work_team.hpp"
#include "solid-server/element/packed_tangent.hpp"
#include "solid-server/mesh/parametric/box_mesh.hpp"
#include "solid-server/mesh/parametric/valve_mesh.hpp"
#include "solid-server/mesh/parametric/vocal_fold_mesh.hpp"
#include "solid-server/modal/modal_analysis.hpp"

namespace {

using namespace couplet::solid;

/// The fastest of some repetitions [s]: other programs on the machine can only slow one down.
template <class Work>
double fastest(int n_repetitions, const Work& work) {
  using Clock = std::chrono::steady_clock;
  double best = 1e9;
  for (int n = 0; n < n_repetitions; ++n) {
    const auto started = Clock::now();
    work();
    best = std::min(best, std::chrono::duration<double>(Clock::now() - started).count());
  }
  return best;
}

/// Multiplications and additions of large dense matrices in a second, in units of 1e9: what a factorisation can reach.
double product_rate() {
  const Eigen::MatrixXd a = Eigen::MatrixXd::Random(768, 768), b = a.transpose();
  Eigen::MatrixXd c(768, 768);
  return 2 * std::pow(768, 3) / fastest(10, [&] { c.noalias() = a * b; }) * 1e-9;
}

struct Body {
  const char* name;
  SolidMesh mesh;
  std::vector<std::string> held;  // surfaces
};

std::vector<Body> bodies() {
  ValveShape valve;
  valve.n_elements = {40, 20, 1};
  VocalFoldShape fold;
  fold.section.medial_thickness = 1.75e-3;
  fold.n_elements = {6, 9, 12};
  return {{"cube", make_box_mesh({Eigen::Vector3d::Ones(), {17, 17, 17}}), {"x_min"}},
          {"leaflets", make_valve_mesh(valve), {"base"}},
          {"fold", make_vocal_fold_mesh(fold), {"lateral", "anterior", "posterior"}}};
}

FreeComponents free_of(const Body& body) {
  FreeComponents free = FreeComponents::Constant(body.mesh.n_nodes(), 3, true);
  for (const std::string& name : body.held)
    for (const Index node : nodes_of_faces(body.mesh, body.mesh.find_surface(name, "held")))
      free.row(node).setConstant(false);
  return free;
}

/// A thousandth of the size of the body.
NodeVectors wavy(const SolidMesh& mesh) {
  const double size = (mesh.node_position.colwise().maxCoeff() - mesh.node_position.colwise().minCoeff()).norm();
  NodeVectors displacement = NodeVectors::Zero(mesh.n_nodes(), 4);
  for (Index n = 0; n < mesh.n_nodes(); ++n) {
    const Eigen::Vector3d X = mesh.node_position.row(n) / size;
    displacement.row(n) << std::sin(3 * X.y()), X.x() * X.z(), std::cos(2 * X.x() + X.y()), 0;
  }
  return 1e-3 * size * displacement;
}

/// One thread, tangents of some packs again and again, in microseconds per element.
double element_time(const Body& body, int n_points) {
  const Material material = SaintVenantKirchhoff::from_young(15e3, 0.475);
  const ElementPacks packs = make_element_packs(body.mesh, body.mesh.block[0], n_points);
  const NodeVectors displacement = wavy(body.mesh);
  const Index n_packs = std::min<Index>(16, packs.n_packs);
  std::vector<StoredPack> blocks(static_cast<std::size_t>(n_packs * 9 * n_local_pairs(packs.n_nodes)));
  return fastest(50, [&] { packed_tangent(packs, material, 0, n_packs, displacement.data(), blocks.data()); }) /
         (n_packs * n_lanes) * 1e6;
}

struct Row {
  std::string body;
  int threads = 0, elements = 0, unknowns = 0;
  double element_us[3] = {0, 0, 0};  // tangents with 8, 14, 27 points
  double set_up = 0, assembly = 0, factorisation = 0, solution = 0, indefinite = 0, modes = 0;  // [s]
  double giga_operations = 0, factor_million = 0, residual = 0, first_frequency = 0;
};

Row measure(const Body& body, int n_threads) {
  Row row{body.name, n_threads, body.mesh.n_elements()};
  for (int n = 0; n < 3; ++n) row.element_us[n] = element_time(body, n == 0 ? 8 : n == 1 ? 14 : 27);
  const FreeComponents free = free_of(body);
  WorkTeam team(n_threads);
  std::vector<BlockProperties> properties;
  for (const ElementBlock& block : body.mesh.block)  // leaflets are single rows: singular with 8 points
    properties.push_back({SaintVenantKirchhoff::from_young(15e3, 0.475), 1040,
                          default_n_points(body.mesh, block, ElementFormulation::standard)});
  std::unique_ptr<TangentSolver> solver;
  row.set_up = fastest(1, [&] { solver = std::make_unique<TangentSolver>(body.mesh, properties, free, team); });
  row.unknowns = solver->n_free();
  const NodeVectors displacement = wavy(body.mesh), at_rest = NodeVectors::Zero(body.mesh.n_nodes(), 4);
  row.assembly = fastest(5, [&] { solver->assemble(displacement, {1, 1e6}); });
  row.factorisation = fastest(3, [&] { solver->factorise(); });
  NodeVectors b = wavy(body.mesh), x;
  b.leftCols<3>().array() *= free.cast<double>();
  row.solution = fastest(5, [&] { x = solver->solve(b); });
  row.residual = (solver->multiply(x) - b).norm() / b.norm();
  {
    const SparseCholesky cholesky(element_pairs(body.mesh), free);
    row.giga_operations = cholesky.n_operations() * 1e-9;
    row.factor_million = static_cast<double>(cholesky.n_factor_entries()) * 1e-6;
  }
  std::vector<Mode> modes;
  row.modes = fastest(1, [&] { modes = modal_analysis(*solver, at_rest, 4); });
  row.first_frequency = modes[0].frequency;
  constexpr double dear = 50;  // minutes
  row.indefinite = std::numeric_limits<double>::quiet_NaN();
  if (row.giga_operations < dear) {
    solver->assemble(at_rest, {1, -0.5 * (modes[0].eigenvalue + modes[1].eigenvalue)});
    row.indefinite = fastest(1, [&] { solver->factorise(); });
  }
  return row;
}

void write_json(const std::vector<Row>& rows, double rate, const std::string& path) {
  auto list = nlohmann::ordered_json::array();
  for (const Row& row : rows)
    list.push_back({{"body", row.body},
                    {"threads", row.threads},
                    {"elements", row.elements},
                    {"unknowns", row.unknowns},
                    {"element_us_8_points", row.element_us[0]},
                    {"element_us_14_points", row.element_us[1]},
                    {"element_us_27_points", row.element_us[2]},
                    {"set_up_s", row.set_up},
                    {"assembly_s", row.assembly},
                    {"factorisation_s", row.factorisation},
                    {"solution_s", row.solution},
                    {"indefinite_factorisation_s", row.indefinite},
                    {"four_modes_s", row.modes},
                    {"giga_operations", row.giga_operations},
                    {"factor_million_entries", row.factor_million},
                    {"dense_product_giga_operations_per_s", rate},
                    {"residual", row.residual},
                    {"first_frequency_hz", row.first_frequency}});
  std::ofstream file(path);
  file << list.dump(2) << '\n';
  if (!file) throw couplet::report::FileError(path, "cannot be written");
}

int run(int argc, char** argv) {
  const std::string about =
      "the tangent of a cube, three leaflets and the vocal fold of hex20: elements, assembly, factorisation, solution, "
      "modes; residual";
  CLI::App app(about);
  std::string json, only;
  bool says_about = false;
  app.add_option("--json", json, "write the rows there");
  app.add_option("--body", only, "only this one: cube, leaflets, fold");
  app.add_flag("--about", says_about, "say in one line what is measured");
  CLI11_PARSE(app, argc, argv);
  if (says_about) {
    std::printf("%s\n", about.c_str());
    return 0;
  }
  const double rate = product_rate();
  std::printf("dense products: %.1f GFlop/s; times in s unless said otherwise\n", rate);
  std::printf("%-9s %7s %8s %8s %17s %7s %8s %9s %7s %8s %10s %7s %9s %9s\n", "body", "threads", "elements", "unknowns",
              "us_element_8/14/27", "set_up", "assembly", "factorise", "GFlop/s", "solve", "indefinite", "modes",
              "residual", "f1_Hz");
  std::vector<Row> rows;
  for (const Body& body : bodies()) {
    if (!only.empty() && only != body.name) continue;
    for (const int threads : {1, 2}) {
      const Row& row = rows.emplace_back(measure(body, threads));
      std::printf("%-9s %7d %8d %8d   %4.2f/%5.2f/%5.2f %7.3f %8.4f %9.4f %7.1f %8.4f %10.4f %7.3f %9.1e %9.4g\n",
                  row.body.c_str(), row.threads, row.elements, row.unknowns, row.element_us[0], row.element_us[1],
                  row.element_us[2], row.set_up, row.assembly, row.factorisation,
                  row.giga_operations / row.factorisation, row.solution, row.indefinite, row.modes, row.residual,
                  row.first_frequency);
      std::fflush(stdout);
    }
  }
  if (!json.empty()) write_json(rows, rate, json);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  couplet::solid::use_better_kernels(argv);
  return couplet::report::run_program("bench tangent", run, argc, argv);
}
