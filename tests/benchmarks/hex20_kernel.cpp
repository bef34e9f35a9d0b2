// bench hex20-kernel: what one evaluation of all internal forces costs per element, and how far it is from the energy's
// derivative.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "proto/report/failure.hpp"
#include "solid-server/dynamics/nodal_force.hpp"
#include "solid-server/dynamics/work_team.hpp"
#include "solid-server/element/tangent.hpp"
#include "solid-server/mesh/box_mesh.hpp"

namespace {

using namespace couplet::solid;

constexpr int n_edge = 17;          // elements along an edge of the cube: 4913 of them
constexpr double seconds_each = 1;  // of measuring a row

struct Row {
  std::string material;
  int points = 0, elements = 0, threads = 0;
  double us_per_element = 0, relative_error = 0;
};

/// A cube, its forces and a state that is anything but homogeneous.
struct Body {
  SolidMesh mesh = make_box_mesh({Eigen::Vector3d::Ones(), {n_edge, n_edge, n_edge}});
  Material material;
  int n_points;
  NodalForce forces;
  NodeVectors displacement, force;

  Body(const Material& law, int points, int n_threads)
      : material(law),
        n_points(points),
        forces(mesh, {{law, 1000, points}}, ExternalForce(mesh, {}, {}, {}), n_threads) {
    force = displacement = NodeVectors::Zero(mesh.n_nodes(), 4);
    for (Index n = 0; n < mesh.n_nodes(); ++n) {
      const Eigen::Vector3d X = mesh.node_position.row(n);
      displacement.row(n) << 0.05 * std::sin(3 * X.y()), 0.04 * X.x() * X.z(), 0.03 * std::cos(2 * X.x() + X.y()), 0;
    }
  }

  /// Displacements in, one force per node out.
  void evaluate(WorkTeam& team) {
    const auto keep = [&](Index node, const NodeQuad& sum) { std::memcpy(&force(node, 0), &sum, sizeof sum); };
    team.run([&](int member) {
      forces.sweep(member, displacement.data(), {}, keep);
      team.barrier();
      forces.visit_shared(member, keep);
    });
  }

  /// Largest difference to the force found point by point, over the largest force.
  double relative_error() const {
    Eigen::Matrix<double, Eigen::Dynamic, 3> plain = Eigen::Matrix<double, Eigen::Dynamic, 3>::Zero(mesh.n_nodes(), 3);
    for (Index element = 0; element < mesh.n_elements(); ++element) {
      const auto nodes = mesh.nodes_of(element);
      const ElementVectors f =
          element_force({material, ElementShape::hexahedron20, n_points, at_element(mesh.node_position, nodes)},
                        at_element(displacement, nodes));
      for (int a = 0; a < f.rows(); ++a) plain.row(nodes[static_cast<std::size_t>(a)]) += f.row(a);
    }
    return (plain - force.leftCols<3>()).cwiseAbs().maxCoeff() / plain.cwiseAbs().maxCoeff();
  }
};

/// The fastest of many evaluations: other programs on the machine can only slow one down.
Row measure(const std::string& name, const Material& material, int n_points, int n_threads) {
  using Clock = std::chrono::steady_clock;
  Body body(material, n_points, n_threads);
  WorkTeam team(n_threads);
  double fastest = 1e9;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds_each);
  while (Clock::now() < end) {
    const auto started = Clock::now();
    body.evaluate(team);
    fastest = std::min(fastest, std::chrono::duration<double>(Clock::now() - started).count());
  }
  const int n_elements = body.mesh.n_elements();
  return {name, n_points, n_elements, n_threads, fastest / n_elements * 1e6, body.relative_error()};
}

void write_json(const std::vector<Row>& rows, const std::string& path) {
  auto list = nlohmann::ordered_json::array();
  for (const Row& row : rows)
    list.push_back({{"material", row.material},
                    {"points", row.points},
                    {"elements", row.elements},
                    {"threads", row.threads},
                    {"us_per_element", row.us_per_element},
                    {"relative_error", row.relative_error}});
  std::ofstream file(path);
  file << list.dump(2) << '\n';
  if (!file) throw couplet::report::FileError(path, "cannot be written");
}

int run(int argc, char** argv) {
  const std::string about =
      "one evaluation of the internal forces of 4913 hex20, positions to nodal forces: time per element, and "
      "difference to "
      "the plain form";
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
      {"mooney_rivlin", MooneyRivlin{2290, 250, 1e5}}};
  std::vector<Row> rows;
  std::printf("%-24s %6s %8s %7s %14s %14s\n", "material", "points", "elements", "threads", "us_per_element",
              "relative_error");
  for (const int threads : {1, static_cast<int>(std::thread::hardware_concurrency())})
    for (const auto& [name, material] : materials)
      for (const int points : {8, 14, 27}) {
        if (threads == 1 && !rows.empty() && rows.back().threads > 1) continue;
        const Row& row = rows.emplace_back(measure(name, material, points, threads));
        std::printf("%-24s %6d %8d %7d %14.4f %14.1e\n", row.material.c_str(), row.points, row.elements, row.threads,
                    row.us_per_element, row.relative_error);
        std::fflush(stdout);
      }
  if (!json.empty()) write_json(rows, json);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return couplet::report::run_program("bench hex20-kernel", run, argc, argv);
}
