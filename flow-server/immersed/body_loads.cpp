#include "flow-server/immersed/body_loads.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "flow-server/immersed/corner_sums.hpp"
#include "flow-server/immersed/imposed_momentum.hpp"
#include "flow-server/immersed/triangle_geometry.hpp"

namespace couplet::flow {

namespace {

/// Distance of the nearer of two points, over the extent of the box of faces around them; the farther one has all its
/// faces before a flat wall.
constexpr double near_point = 0.6;
/// Where less of the farther point is seen the derivative falls back to the nearer one.
constexpr double least_seen = 0.75;
/// Where the nearer one sees no face further away than this the wall is taken for slip: the gap is closed.
constexpr double least_distance = 0.02;
/// Walls of which the cosine of the angle between the normals is smaller lie on different sides of an edge.
constexpr double same_side = 0.5;
/// Shapes beyond these, over the same extent, are corners and edges, not curved walls.
constexpr double largest_offset = 0.25, largest_bend = 0.5;

Eigen::Vector3d corner_value(const BodySurface& surface, const std::vector<Point>& values, int triangle,
                             std::size_t v) {
  const int corner = surface.triangle[static_cast<std::size_t>(triangle)][v];
  return Eigen::Vector3d::Map(values[static_cast<std::size_t>(corner)].data());
}

/// dU_i / dx_j in the plane of a triangle.
Eigen::Matrix3d velocity_gradient_along(const BodySurface& surface, int triangle) {
  const auto edge = [&](const std::vector<Point>& values, std::size_t v) {
    return Eigen::Vector3d(corner_value(surface, values, triangle, v) - corner_value(surface, values, triangle, 0));
  };
  const Eigen::Vector3d a = edge(surface.position, 1), b = edge(surface.position, 2), n = a.cross(b);
  const double square = n.squaredNorm();
  if (square == 0) return Eigen::Matrix3d::Zero();
  return (edge(surface.velocity, 1) * b.cross(n).transpose() + edge(surface.velocity, 2) * n.cross(a).transpose()) /
         square;
}

/// Spreads forces on walls to the corners of loads.
class CornerForces {
  auto to_loads() {
    return [this](std::size_t surface, std::size_t corner, const Eigen::Vector3d& force) {
      Eigen::Vector3d::Map(loads_[surface].corner_force[corner].data()) += force;
    };
  }

 public:
  CornerForces(const BodyGeometry& bodies, std::vector<SurfaceLoad>& loads) : sums_(bodies), loads_(loads) {}

  void add(const WallTriangle& wall, const Eigen::Vector3d& force) { sums_.add(wall, force, to_loads()); }
  /// What stands on the middles, after all others.
  void spread_middles() { sums_.spread_middles(to_loads()); }

 private:
  CornerSums<Eigen::Vector3d> sums_;
  std::vector<SurfaceLoad>& loads_;
};

/// A face of a component on the same side of the walls as a part of a cell: in the cell, or beyond an opening of the
/// part; the one nearest to a point.
class FaceOfPart {
 public:
  FaceOfPart(const BodyGeometry& bodies, const FlowBlock& block, int component, const Eigen::Vector3d& point)
      : cut_(bodies.cut()), layer_(bodies.layer()), block_(block), component_(component), point_(point) {}

  std::optional<Triple> find(const Triple& cell, int part) {
    look_at(cell, part);
    if (found_) return found_;
    for (int d = 0; d < block_.n_dimensions; ++d)
      for (const int side : {0, 1}) {
        Triple face = cell, next = cell;
        face[d] -= side == 0 ? 1 : 0;
        next[d] += side == 0 ? -1 : 1;
        const int index = cut_.find_face(d, face);
        if (index < 0) continue;
        const CutFace& open = cut_.faces()[static_cast<std::size_t>(index)];
        for (int p = open.first_piece; p < open.first_piece + open.n_pieces; ++p) {
          const FacePiece& piece = cut_.pieces()[static_cast<std::size_t>(p)];
          if ((side == 0 ? piece.upper_part : piece.lower_part) != part) continue;
          look_at(next, side == 0 ? piece.lower_part : piece.upper_part);
        }
      }
    return found_;
  }

 private:
  void look_at(const Triple& cell, int part) {
    for (const int back : {0, 1}) {
      Triple face = cell;
      face[component_] -= back;
      if (!layer_.is_known(component_, face) || cut_.part_at(cell, component_, face) != part) continue;
      double square = 0;
      for (int d = 0; d < block_.n_dimensions; ++d) {
        const AxisValues& at = d == component_ ? block_.axis[d].face : block_.axis[d].centre;
        square += std::pow(at[face[d]] - point_[d], 2);
      }
      if (found_ && square >= nearest_) continue;
      found_ = face, nearest_ = square;
    }
  }

  const CutCells& cut_;
  const WallLayer& layer_;
  const FlowBlock& block_;
  int component_;
  const Eigen::Vector3d& point_;
  std::optional<Triple> found_;
  double nearest_ = 0;
};

/// A velocity between faces, less that of the wall, as g <xi> + q <xi^2> / 2, xi: distance of the faces from the wall.
struct Sample {
  double rise = 0;                       // sum of weight (u - U) over the faces that are seen [m/s]
  double distance = 0, half_square = 0;  // sums of weight xi [m], weight xi^2 / 2 [m^2]
  double seen = 0;                       // sum of weights
};

}  // namespace

/// The walls between two parts of a cell that belong to one surface.
struct BodyLoads::WallPatch {
  Triple cell;
  int surface, outer_part, inner_part;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(), velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d area = Eigen::Vector3d::Zero();               // towards the outer side [m^2]
  Eigen::Matrix3d velocity_gradient = Eigen::Matrix3d::Zero();  // along the wall [1/s]
  /// The surface's distance on the outer side, at a height z above the middle of the patch and y beside it:
  /// z + offset + y . bend . y / 2.
  double offset = 0;
  Eigen::Matrix3d bend = Eigen::Matrix3d::Zero();
  /// The same of the velocity of the wall, of which the first derivatives are velocity_gradient.
  std::array<Eigen::Matrix3d, 3> velocity_bend{Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero(),
                                               Eigen::Matrix3d::Zero()};
};

Point moment_about(const Point& point, const BodySurface& surface, std::span<const Point> corner_force) {
  Point moment{};
  for (std::size_t c = 0; c < corner_force.size(); ++c)
    moment = moment + cross(surface.position[c] - point, corner_force[c]);
  return moment;
}

std::vector<SurfaceLoad> BodyLoads::no_loads(std::span<const BodySurface> surfaces) {
  std::vector<SurfaceLoad> loads(surfaces.size());
  for (std::size_t s = 0; s < surfaces.size(); ++s) loads[s].corner_force.assign(surfaces[s].position.size(), Point{});
  return loads;
}

void BodyLoads::add_pressure(const BodyGeometry& bodies, const Field<double>& pressure,
                             std::vector<SurfaceLoad>& loads) const {
  const CutCells& cut = bodies.cut();
  const Box mine = box_of(block_.sizes);
  CornerForces forces(bodies, loads);
  for (const CutCell& cell : cut.cells()) {
    if (!mine.contains(cell.cell)) continue;
    const auto pressure_of = [&](int part) {
      return bodies.pieces().is_fluid(part, cell.cell)
                 ? bodies.pieces().value_at(part, cell.cell, pressure, bodies.piece_pressure)
                 : 0.0;
    };
    for (int w = cell.first_wall; w < cell.first_wall + cell.n_walls; ++w) {
      const WallTriangle& wall = cut.walls()[static_cast<std::size_t>(w)];
      if (wall.outer_part == wall.inner_part) continue;
      const double jump = pressure_of(wall.inner_part) - pressure_of(wall.outer_part);
      const Eigen::Vector3d force = (1 - wall.opening) * jump * wall.area;
      forces.add(wall, force);
      Eigen::Vector3d::Map(loads[static_cast<std::size_t>(wall.surface)].pressure_force.data()) += force;
    }
  }
  forces.spread_middles();
}

/// From the points of the surface that are nearest to a few places above the patch.
void BodyLoads::find_bend(const BodyGeometry& bodies, const Eigen::Vector3d& normal, double size,
                          WallPatch& patch) const {
  const SurfaceTree& tree = bodies.trees()[static_cast<std::size_t>(patch.surface)];
  const BodySurface& surface = bodies.surfaces()[static_cast<std::size_t>(patch.surface)];
  using Values = Eigen::Vector4d;  // distance, less the height; velocity
  const auto values_at = [&](const Eigen::Vector3d& beside) {
    const Eigen::Vector3d at = patch.centre + size * (normal + beside);
    const ClosestPoint closest = tree.closest({at[0], at[1], at[2]}, 2 * size);
    Values values;
    values << 0, patch.velocity;
    if (!closest.is_found()) return values;
    values << closest.distance - size, Eigen::Vector3d::Zero();
    for (std::size_t v = 0; v < 3; ++v)
      values.tail<3>() += closest.weight[v] * corner_value(surface, surface.velocity, closest.triangle, v);
    return values;
  };
  const Values middle = values_at(Eigen::Vector3d::Zero());
  patch.offset = std::clamp(middle[0], -largest_offset * size, largest_offset * size);
  patch.velocity = middle.tail<3>();
  const auto bend_along = [&](const Eigen::Vector3d& direction) {
    Values bend = (values_at(direction) + values_at(-direction) - 2 * middle) / (size * size);
    bend[0] = std::clamp(bend[0], -largest_bend / size, largest_bend / size);
    return bend;
  };
  const auto add = [&](const Values& bend, const Eigen::Matrix3d& directions) {
    patch.bend += bend[0] * directions;
    for (int c = 0; c < 3; ++c) patch.velocity_bend[static_cast<std::size_t>(c)] += bend[c + 1] * directions;
  };
  Eigen::Vector3d first = normal.unitOrthogonal();
  if (block_.n_dimensions == 2) first = Eigen::Vector3d(-normal[1], normal[0], 0);
  const Values bend_first = bend_along(first);
  add(bend_first, first * first.transpose());
  if (block_.n_dimensions == 2) return;
  const Eigen::Vector3d second = normal.cross(first);
  const Values bend_second = bend_along(second);
  add(bend_second, second * second.transpose());
  const Values mixed = bend_along((first + second) / std::sqrt(2.0)) - 0.5 * (bend_first + bend_second);
  add(mixed, first * second.transpose() + second * first.transpose());
}

/// du/dm on the side of the wall that `normal` points to, where the fluid is the given part. `size`: extent along the
/// normal of the box between the faces around a point.
Eigen::Vector3d BodyLoads::normal_derivative(const BodyGeometry& bodies, const VectorField& velocity,
                                             const WallPatch& patch, const Eigen::Vector3d& normal, double size,
                                             int part) const {
  const double side = normal.dot(patch.area) > 0 ? 1 : -1;
  const auto sample_at = [&](int c, double distance) {
    Sample sample;
    const Eigen::Vector3d point = patch.centre + distance * normal;
    const std::optional<Triple> from = FaceOfPart(bodies, block_, c, point).find(patch.cell, part);
    if (!from) return sample;
    const WallImage around = bodies.layer().image_at(c, point, *from);
    for (std::size_t n = 0; n < around.weight.size(); ++n) {
      const double weight = around.weight[n];
      if (weight == 0) continue;
      Triple face = around.base;
      Eigen::Vector3d beside = Eigen::Vector3d::Zero();
      for (int d = 0; d < block_.n_dimensions; ++d) {
        face[d] += static_cast<int>((n >> d) & 1u);
        const AxisValues& at = d == c ? block_.axis[d].face : block_.axis[d].centre;
        beside[d] = at[face[d]] - patch.centre[d];
      }
      const double height = beside.dot(normal);
      beside -= height * normal;
      const double xi = height + side * (patch.offset + 0.5 * beside.dot(patch.bend * beside));
      const double wall = patch.velocity[c] + patch.velocity_gradient.row(c).dot(beside) +
                          0.5 * beside.dot(patch.velocity_bend[static_cast<std::size_t>(c)] * beside);
      sample.rise += weight * (velocity[c](face[0], face[1], face[2]) - wall);
      sample.distance += weight * xi;
      sample.half_square += 0.5 * weight * xi * xi;
      sample.seen += weight;
    }
    return sample;
  };
  Eigen::Vector3d derivative = Eigen::Vector3d::Zero();
  for (int c = 0; c < block_.n_dimensions; ++c) {
    const Sample near = sample_at(c, near_point * size), far = sample_at(c, 2 * near_point * size);
    const double trust = std::clamp((far.seen - least_seen) / (1 - least_seen), 0.0, 1.0);
    const double determinant = near.distance * far.half_square - far.distance * near.half_square;
    const bool has_one = near.distance > least_distance * size;
    const double of_one = has_one ? near.rise / near.distance : 0;
    derivative[c] = of_one;
    if (trust > 0 && has_one && determinant > 0)
      derivative[c] += trust * ((near.rise * far.half_square - far.rise * near.half_square) / determinant - of_one);
  }
  return derivative;
}

void BodyLoads::add_viscous_stress(const BodyGeometry& bodies, const VectorField& velocity,
                                   std::vector<SurfaceLoad>& loads) const {
  if (viscosity_ == 0) return;
  const CutCells& cut = bodies.cut();
  const Box mine = box_of(block_.sizes);
  CornerForces forces(bodies, loads);
  std::vector<int> patch_of;  // of each wall of a cell: the number of the first one of its patch
  for (const CutCell& cell : cut.cells()) {
    if (!mine.contains(cell.cell)) continue;
    const std::span walls(cut.walls().data() + cell.first_wall, static_cast<std::size_t>(cell.n_walls));
    // Beside a sharp edge each side has its own stress.
    const auto is_same = [](const WallTriangle& a, const WallTriangle& b) {
      return a.surface == b.surface && a.outer_part == b.outer_part && a.inner_part == b.inner_part &&
             a.area.dot(b.area) > same_side * a.area.norm() * b.area.norm();
    };
    patch_of.assign(walls.size(), -1);
    for (std::size_t w = 0; w < walls.size(); ++w) {
      const WallTriangle* const first = &walls[w];
      if (patch_of[w] >= 0 || first->outer_part == first->inner_part) continue;
      const int number = static_cast<int>(w);
      for (std::size_t v = w; v < walls.size(); ++v)
        if (patch_of[v] < 0 && (v == w || is_same(*first, walls[v]))) patch_of[v] = number;
      const BodySurface& surface = bodies.surfaces()[static_cast<std::size_t>(first->surface)];
      WallPatch patch{.cell = cell.cell,
                      .surface = first->surface,
                      .outer_part = first->outer_part,
                      .inner_part = first->inner_part};
      double size = 0;
      for (std::size_t v = w; v < walls.size(); ++v) {
        if (patch_of[v] != number) continue;
        const WallTriangle* const wall = &walls[v];
        const double area = wall->area.norm();
        size += area;
        patch.area += wall->area;
        patch.centre += area * wall->centroid;
        patch.velocity += area * wall->velocity;
        for (const WeighedPoint& end : wall->end)
          if (end.point)
            patch.velocity_gradient += 1.5 * end.weight * area * velocity_gradient_along(surface, end.point->triangle);
      }
      const double projected = patch.area.norm();
      if (projected == 0) continue;
      patch.centre /= size, patch.velocity /= size, patch.velocity_gradient /= size;
      const Eigen::Vector3d outwards = patch.area / projected;
      double reach = 0;
      for (int d = 0; d < block_.n_dimensions; ++d)
        reach += std::abs(outwards[d]) / std::min(block_.axis[d].inverse_distance[cell.cell[d]],
                                                  block_.axis[d].inverse_distance[cell.cell[d] - 1]);
      find_bend(bodies, outwards, reach, patch);
      Eigen::Vector3d stress = Eigen::Vector3d::Zero();  // of both sides [N/m^2]
      for (const bool is_outer : {true, false}) {
        const int part = is_outer ? patch.outer_part : patch.inner_part;
        if (!bodies.pieces().is_fluid(part, cell.cell)) continue;
        const Eigen::Vector3d m = is_outer ? outwards : Eigen::Vector3d(-outwards);
        const Eigen::Vector3d g = normal_derivative(bodies, velocity, patch, m, reach, part);
        stress += viscosity_ * (g - m * m.dot(g) - 2 * patch.velocity_gradient.trace() * m +
                                patch.velocity_gradient.transpose() * m);
      }
      for (std::size_t v = w; v < walls.size(); ++v) {
        if (patch_of[v] != number) continue;
        const WallTriangle* const wall = &walls[v];
        const Eigen::Vector3d force = (1 - wall->opening) * wall->area.dot(outwards) * stress;
        forces.add(*wall, force);
        Eigen::Vector3d::Map(loads[static_cast<std::size_t>(wall->surface)].viscous_force.data()) += force;
      }
    }
  }
  forces.spread_middles();
}

std::vector<SurfaceLoad> BodyLoads::measure(const FlowState& state, double density) const {
  const BodyGeometry& bodies = *state.bodies;
  std::vector<SurfaceLoad> loads = no_loads(bodies.surfaces());
  add_pressure(bodies, state.pressure, loads);
  add_imposed_momentum(block_, density, state, loads);
  add_viscous_stress(bodies, state.velocity, loads);
  std::vector<Point> all;
  for (const SurfaceLoad& load : loads) {
    all.insert(all.end(), {load.pressure_force, load.viscous_force});
    all.insert(all.end(), load.corner_force.begin(), load.corner_force.end());
  }
  MPI_Allreduce(MPI_IN_PLACE, all.data(), static_cast<int>(3 * all.size()), MPI_DOUBLE, MPI_SUM,
                block_.decomposition->communicator());
  auto next = all.begin();
  for (SurfaceLoad& load : loads) {
    load.pressure_force = *next++, load.viscous_force = *next++;
    for (Point& force : load.corner_force) force = *next++;
  }
  return loads;
}

}  // namespace couplet::flow
