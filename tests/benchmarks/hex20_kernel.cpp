// bench hex20-kernel: what one evaluation of all internal forces costs per element, and how far it is from the energy's
// derivative.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "proto/report/failure.hpp"
#include "solid-server/dynamics/nodal_force.hpp"
#include "solid-server/dynamics/work_team.hpp"
#include "solid-server/element/tangent.hpp"
#include "tests/unit/solid-server/element/meshes_of_shapes.hpp"

namespace {

using namespace couplet::solid;

constexpr int n_edge = 17;            // hexahedra along an edge of the cube: 4913 of them
constexpr int n_edge_cut = 9;         // where each is cut into six tetrahedra: 4374 of them
constexpr double seconds_each = 0.7;  // of measuring a row

struct Kind {
  const char* name;
  ElementShape shape;
  ElementFormulation formulation;
  int n_points;
};

constexpr Kind kinds[] = {
    {"hexahedron20", ElementShape::hexahedron20, ElementFormulation::standard, 8},
    {"hexahedron20", ElementShape::hexahedron20, ElementFormulation::standard, 14},
    {"hexahedron20", ElementShape::hexahedron20, ElementFormulation::standard, 27},
    {"hexahedron20_near_incompressible", ElementShape::hexahedron20, ElementFormulation::near_incompressible, 8},
    {"hexahedron20_near_incompressible", ElementShape::hexahedron20, ElementFormulation::near_incompressible, 14},
    {"hexahedron20_near_incompressible", ElementShape::hexahedron20, ElementFormulation::near_incompressible, 27},
    {"tetrahedron10", ElementShape::tetrahedron10, ElementFormulation::standard, 4},
    {"tetrahedron10_near_incompressible", ElementShape::tetrahedron10, ElementFormulation::near_incompressible, 4},
    {"hexahedron8_stabilised", ElementShape::hexahedron8, ElementFormulation::stabilised, 1},
    {"hexahedron8", ElementShape::hexahedron8, ElementFormulation::standard, 8},
};

struct Row {
  std::string element, material;
  int points = 0, elements = 0, threads = 0;
  double us_per_element = 0, relative_error = 0;
};

/// A cube, its forces and a state that is anything but homogeneous.
struct Body {
  SolidMesh mesh;
  Material material;
  Kind kind;
  NodalForce forces;
  NodeVectors displacement, force;

  Body(const Material& law, const Kind& of_element, int n_threads)
      : mesh(cube(of_element.shape)),
        material(law),
        kind(of_element),
        forces(mesh, {{law, 1000, kind.n_points, kind.formulation}}, ExternalForce(mesh, {}, {}, {}), n_threads) {
    force = displacement = NodeVectors::Zero(mesh.n_nodes(), 4);
    for (Index n = 0; n < mesh.n_nodes(); ++n) {
      const Eigen::Vector3d X = mesh.node_position.row(n);
      displacement.row(n) << 0.05 * std::sin(3 * X.y()), 0.04 * X.x() * X.z(), 0.03 * std::cos(2 * X.x() + X.y()), 0;
    }
  }

  static SolidMesh cube(ElementShape shape) {
    const int n = shape == ElementShape::tetrahedron10 ? n_edge_cut : n_edge;
    return in_shape(make_box_mesh({Eigen::Vector3d::Ones(), {n, n, n}}), shape);
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

  /// Standard formulation: largest difference to the force found point by point, over the largest force. The others
  /// have no such form: work of the forces along a direction against the change of the energy, over their norms, where
  /// the difference of energies has an error of its own of some 1e-9.
  double relative_error() {
    return kind.formulation == ElementFormulation::standard ? error_of_plain_form() : error_of_energy();
  }

  double error_of_plain_form() const {
    Eigen::Matrix<double, Eigen::Dynamic, 3> plain = Eigen::Matrix<double, Eigen::Dynamic, 3>::Zero(mesh.n_nodes(), 3);
    for (Index element = 0; element < mesh.n_elements(); ++element) {
      const auto nodes = mesh.nodes_of(element);
      const ElementVectors f =
          element_force({material, kind.shape, kind.n_points, at_element(mesh.node_position, nodes)},
                        at_element(displacement, nodes));
      for (int a = 0; a < f.rows(); ++a) plain.row(nodes[static_cast<std::size_t>(a)]) += f.row(a);
    }
    return (plain - force.leftCols<3>()).cwiseAbs().maxCoeff() / plain.cwiseAbs().maxCoeff();
  }

  double error_of_energy() {
    constexpr double h = 1e-5;
    NodeVectors direction = displacement;
    for (Index n = 0; n < mesh.n_nodes(); ++n)
      direction.row(n) << std::sin(5 * n), std::cos(7 * n), std::sin(11 * n), 0;
    direction /= n_edge;  // of the size of an element
    const auto energy_at = [&](double step) {
      forces.all(displacement + step * direction, {0, 0, true});
      return forces.strain_energy();
    };
    const double slope = (energy_at(h) - energy_at(-h)) / (2 * h);
    return std::abs(slope + force.cwiseProduct(direction).sum()) / (force.norm() * direction.norm());
  }
};

/// The fastest of many evaluations: other programs on the machine can only slow one down.
Row measure(const std::string& name, const Material& material, const Kind& kind, int n_threads) {
  using Clock = std::chrono::steady_clock;
  Body body(material, kind, n_threads);
  WorkTeam team(n_threads);
  double fastest = 1e9;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds_each);
  while (Clock::now() < end) {
    const auto started = Clock::now();
    body.evaluate(team);
    fastest = std::min(fastest, std::chrono::duration<double>(Clock::now() - started).count());
  }
  const int n_elements = body.mesh.n_elements();
  return {kind.name, name, kind.n_points, n_elements, n_threads, fastest / n_elements * 1e6, body.relative_error()};
}

void write_json(const std::vector<Row>& rows, const std::string& path) {
  auto list = nlohmann::ordered_json::array();
  for (const Row& row : rows)
    list.push_back({{"element", row.element},
                    {"material", row.material},
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
      "difference "
      "to the plain form; --all-elements: other elements and formulations too";
  CLI::App app(about);
  std::string json;
  bool says_about = false, has_all = false;
  app.add_option("--json", json, "write the rows there");
  app.add_flag("--all-elements", has_all, "the other elements and formulations too");
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
  std::printf("%-33s %-24s %6s %8s %7s %14s %14s\n", "element", "material", "points", "elements", "threads",
              "us_per_element", "relative_error");
  for (const int threads : std::set<int>{1, static_cast<int>(std::thread::hardware_concurrency())})
    for (const auto& [name, material] : materials)
      for (const Kind& kind : kinds) {
        const bool has_volumetric_part = std::visit([](const auto& law) { return law.has_volumetric_part; }, material);
        if (kind.formulation == ElementFormulation::near_incompressible && !has_volumetric_part) continue;
        const bool is_plain_hex20 =
            kind.shape == ElementShape::hexahedron20 && kind.formulation == ElementFormulation::standard;
        if (!is_plain_hex20 && !has_all) continue;
        const Row& row = rows.emplace_back(measure(name, material, kind, threads));
        std::printf("%-33s %-24s %6d %8d %7d %14.4f %14.1e\n", row.element.c_str(), row.material.c_str(), row.points,
                    row.elements, row.threads, row.us_per_element, row.relative_error);
        std::fflush(stdout);
      }
  if (!json.empty()) write_json(rows, json);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return couplet::report::run_program("bench hex20-kernel", run, argc, argv);
}
