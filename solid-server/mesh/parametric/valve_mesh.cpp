#include "solid-server/mesh/parametric/valve_mesh.hpp"

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "proto/report/failure.hpp"
#include "solid-server/mesh/parametric/leaflet_grid.hpp"
#include "solid-server/mesh/parametric/merge_patches.hpp"
#include "solid-server/mesh/parametric/structured_block.hpp"
#include "solid-server/mesh/place_mesh.hpp"

namespace couplet::solid {

namespace {

/// From the leaflet's own axes (radial, circumferential, downstream) to those of the valve: along x, leaflet 1 towards
/// y.
Eigen::Isometry3d leaflet_turn(int number) {
  const double angle = 2 * std::numbers::pi / 3 * (number - 1), c = std::cos(angle), s = std::sin(angle);
  Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
  turn.linear().col(0) = Eigen::Vector3d(0, c, s);
  turn.linear().col(1) = Eigen::Vector3d(0, -s, c);
  turn.linear().col(2) = Eigen::Vector3d::UnitX();
  return turn;
}

/// One of a leaflet's two patches in its own axes; the surfaces that are not inside the leaflet are named by the
/// caller.
class LeafletPatch {
 public:
  using Parameters = std::function<Eigen::Vector2d(int i, int j)>;

  LeafletPatch(const ValveShape& shape, const LeafletSurface& surface, int n_x, int n_y, const Parameters& parameters)
      : block(n_x, n_y, shape.n_elements[2]) {
    const int n_z = shape.n_elements[2];
    mesh = block.mesh([&](const HalfIndex& place) {
      const Eigen::Vector2d uv = parameters(place.i, place.j);
      const double s = shape.thickness * (place.k / (2.0 * n_z) - 0.5);
      return surface.offset_position(uv[0], uv[1], s, shape.thickness);
    });
    for (int k = 0; k < n_z; ++k)
      for (int j = 0; j < n_y; ++j)
        for (int i = 0; i < n_x; ++i) {
          const Eigen::Vector2d uv = parameters(2 * i + 1, 2 * j + 1);
          const Eigen::Vector3d along = surface.circumferential(uv[0], uv[1]);
          mesh.block.front().axes.push_back({along, surface.normal(uv[0], uv[1]).cross(along)});
        }
    mesh.surface["ventricular"] = block.side(hex20::zeta_min);
    mesh.surface["aortic"] = block.side(hex20::zeta_max);
    auto& contact = mesh.surface["contact"];
    for (const ElementFace& face : mesh.surface["ventricular"]) {  // of the first layer: j n_x + i
      const Eigen::Vector2d uv = parameters(2 * (face.element % n_x) + 1, 2 * (face.element / n_x) + 1);
      if (uv[1] >= 1 - shape.contact_fraction) contact.push_back(face);
    }
  }

  StructuredBlock block;
  SolidMesh mesh;
};

/// A leaflet in its own axes, surfaces without a number.
SolidMesh make_leaflet(const ValveShape& shape, const LeafletSurface& surface, const LeafletGrid& grid) {
  LeafletPatch ring(shape, surface, grid.n_around(), grid.n_ring(), [&](int i, int j) { return grid.ring(i, j); });
  LeafletPatch centre(shape, surface, grid.n_centre_along(), grid.n_centre_across(),
                      [&](int i, int j) { return grid.centre(i, j); });
  ring.mesh.surface["base"] = ring.block.side(hex20::eta_min);
  ring.mesh.surface["free_edge"] = ring.block.side(hex20::xi_min);
  for (const ElementFace& face : ring.block.side(hex20::xi_max)) ring.mesh.surface["free_edge"].push_back(face);
  centre.mesh.surface["free_edge"] = centre.block.side(hex20::eta_max);
  auto& commissure = ring.mesh.node_set["commissure"];
  for (int k = 0; k <= 2 * shape.n_elements[2]; ++k)
    for (const int i : {0, 2 * grid.n_around()}) commissure.push_back(ring.block.node_at({i, 0, k}));
  // In the middle (half of the lattice along the free edge) there is always a node: on a corner or inside an edge.
  centre.mesh.marker["free_edge_middle"] = centre.block.node_at({grid.n_centre_along(), 2 * grid.n_centre_across(), 0});
  return merge_patches({ring.mesh, centre.mesh});
}

Index nearest_node(const SolidMesh& mesh, const std::vector<Index>& nodes, const Eigen::Vector3d& point) {
  Index nearest = nodes.front();
  const auto distance = [&](Index node) { return (mesh.node_position.row(node).transpose() - point).squaredNorm(); };
  for (const Index node : nodes)
    if (distance(node) < distance(nearest)) nearest = node;
  return nearest;
}

/// The leaflet at its place, its names with its number and without.
SolidMesh place_leaflet(const SolidMesh& leaflet, int number) {
  const std::string suffix = "_" + std::to_string(number);
  SolidMesh placed = leaflet;
  place_mesh(leaflet_turn(number), placed);
  for (ElementBlock& block : placed.block) block.region = "leaflet" + suffix;
  for (const auto& [name, faces] : leaflet.surface) placed.surface[name + suffix] = faces;
  for (const auto& [name, nodes] : leaflet.node_set) placed.node_set[name + suffix] = nodes;
  placed.marker.clear();
  for (const auto& [name, node] : leaflet.marker) placed.marker[name + suffix] = node;
  return placed;
}

void check_shape(const ValveShape& shape) {
  const auto refuse = [](const std::string& what, double value, const std::string& advice) {
    throw report::SceneError("valve", what + " of " + report::text(value) + advice);
  };
  if (!(shape.thickness > 0)) refuse("a thickness", shape.thickness, " m is not above 0");
  if (!(shape.commissure_gap > 0)) refuse("a commissure_gap", shape.commissure_gap, " m is not above 0");
  if (!(shape.contact_fraction > 0 && shape.contact_fraction <= 1))
    refuse("a contact_fraction", shape.contact_fraction, " is not above 0 and at most 1");
  if (shape.n_elements[2] < 1)
    refuse("a number", shape.n_elements[2], " elements through the thickness is not above 0");
}

}  // namespace

SolidMesh make_valve_mesh(const ValveShape& shape) {
  check_shape(shape);
  const LeafletSurface surface(shape.leaflet, (shape.thickness + shape.commissure_gap) / 2);
  const LeafletGrid grid(surface, shape.n_elements[0], shape.n_elements[1]);
  SolidMesh leaflet = make_leaflet(shape, surface, grid);
  const std::vector<Index> ventricular = nodes_of_faces(leaflet, leaflet.surface.at("ventricular"));
  for (const auto& [name, v] : {std::pair{"lower_belly", 1.0 / 3}, std::pair{"upper_belly", 2.0 / 3}})
    leaflet.marker[name] =
        nearest_node(leaflet, ventricular, surface.offset_position(0, v, -shape.thickness / 2, shape.thickness));
  std::vector<SolidMesh> leaflets;
  for (const int number : {1, 2, 3}) leaflets.push_back(place_leaflet(leaflet, number));
  return merge_patches(leaflets);
}

}  // namespace couplet::solid
