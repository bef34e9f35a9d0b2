#include "flow-server/output/surface_results.hpp"

#include <mpi.h>

#include <Eigen/Core>
#include <algorithm>
#include <numeric>

#include "flow-server/immersed/body_geometry.hpp"

namespace couplet::flow {

namespace {

/// Of what the walls around a corner give to it: area, outer and inner pressure times area, force of the pressure.
using WallSums = Eigen::Matrix<double, 6, 1>;

/// Spreads sums over the points of walls to corners, each by the weights with which these move them.
class CornerSums {
 public:
  explicit CornerSums(const BodyGeometry& bodies)
      : bodies_(bodies), on_middle_(bodies.cut().middles().size(), WallSums::Zero()) {
    for (const BodySurface& surface : bodies.surfaces()) {
      first_.push_back(n_corners_);
      n_corners_ += surface.position.size();
    }
    sums_.assign(n_corners_ * WallSums::SizeAtCompileTime, 0.0);
  }

  void add(const WallTriangle& wall, const WallSums& value) {
    for (const EdgeCrossing* end : wall.end) add(*end, value / 3);
    on_middle_[static_cast<std::size_t>(wall.middle)] += value / 3;
  }

  /// After all walls; then sums over ranks.
  void finish(MPI_Comm communicator) {
    for (std::size_t m = 0; m < on_middle_.size(); ++m) {
      const WallMiddle& middle = bodies_.cut().middles()[m];
      for (int c = middle.first_crossing; c < middle.first_crossing + middle.n_crossings; ++c)
        add(*bodies_.cut().middle_crossings()[static_cast<std::size_t>(c)], on_middle_[m] / middle.n_crossings);
    }
    MPI_Allreduce(MPI_IN_PLACE, sums_.data(), static_cast<int>(sums_.size()), MPI_DOUBLE, MPI_SUM, communicator);
  }

  Eigen::Map<WallSums> of(std::size_t surface, std::size_t corner) {
    return Eigen::Map<WallSums>(sums_.data() + WallSums::SizeAtCompileTime * (first_[surface] + corner));
  }

 private:
  void add(const EdgeCrossing& crossing, const WallSums& value) {
    const auto s = static_cast<std::size_t>(crossing.surface);
    const auto& corners = bodies_.surfaces()[s].triangle[static_cast<std::size_t>(crossing.triangle)];
    for (std::size_t v = 0; v < 3; ++v)
      of(s, static_cast<std::size_t>(corners[v])) += crossing.weight[static_cast<Eigen::Index>(v)] * value;
  }

  const BodyGeometry& bodies_;
  std::vector<WallSums> on_middle_;
  std::vector<std::size_t> first_;  // corner of each surface
  std::size_t n_corners_ = 0;
  std::vector<double> sums_;
};

void add_walls(const FlowPart& part, CornerSums& sums) {
  const BodyGeometry& bodies = *part.state.bodies;
  const CutCells& cut = bodies.cut();
  const Box mine = box_of(part.decomposition.mine().sizes());
  for (const CutCell& cell : cut.cells()) {
    if (!mine.contains(cell.cell)) continue;
    const auto pressure_of = [&](int p) {
      return bodies.pieces().is_fluid(p, cell.cell)
                 ? bodies.pieces().value_at(p, cell.cell, part.state.pressure, bodies.piece_pressure)
                 : 0.0;
    };
    for (int w = cell.first_wall; w < cell.first_wall + cell.n_walls; ++w) {
      const WallTriangle& wall = cut.walls()[static_cast<std::size_t>(w)];
      const bool touches_fluid =
          bodies.pieces().is_fluid(wall.outer_part, cell.cell) || bodies.pieces().is_fluid(wall.inner_part, cell.cell);
      if (!touches_fluid) continue;
      const double outer = pressure_of(wall.outer_part), inner = pressure_of(wall.inner_part);
      const double area = wall.area.norm();
      WallSums value;
      value << area, outer * area, inner * area, (1 - wall.opening) * (inner - outer) * wall.area;
      sums.add(wall, value);
    }
  }
}

/// Seams are gone by then where a cell holds less than some hundred triangles.
constexpr int most_sweeps = 20;

/// Outer and inner pressure, viscous traction of a corner [Pa].
using CornerValues = Eigen::Matrix<double, 5, 1>;

/// The triangles at each corner: those of corner c are triangle[first[c]] to triangle[first[c + 1] - 1].
struct TrianglesOfCorners {
  explicit TrianglesOfCorners(const StoredSurface& surface)
      : first(static_cast<std::size_t>(surface.n_corners) + 1, 0), triangle(3 * surface.triangle.size()) {
    for (const auto& corners : surface.triangle)
      for (const int corner : corners) ++first[static_cast<std::size_t>(corner) + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (std::size_t t = 0; t < surface.triangle.size(); ++t)
      for (const int corner : surface.triangle[t]) triangle[next[static_cast<std::size_t>(corner)]++] = t;
  }
  std::vector<std::size_t> first, triangle;
};

/// Values of corners that have none: the mean of neighbours that have one, and on from there, layer by layer; then as
/// many sweeps of means of all neighbours, which take away most of the seams.
void fill_from_neighbours(const StoredSurface& surface, std::vector<bool> has_value,
                          std::vector<CornerValues>& values) {
  if (std::find(has_value.begin(), has_value.end(), false) == has_value.end()) return;
  const TrianglesOfCorners around(surface);
  const auto visit_neighbours = [&](std::size_t c, const auto& visit) {
    for (std::size_t t = around.first[c]; t < around.first[c + 1]; ++t)
      for (const int corner : surface.triangle[around.triangle[t]]) visit(static_cast<std::size_t>(corner));
  };
  const auto take_mean = [&](std::size_t c) {
    CornerValues sum = CornerValues::Zero();
    int n = 0;
    visit_neighbours(c, [&](std::size_t other) {
      if (!has_value[other] || other == c) return;
      sum += values[other];
      ++n;
    });
    values[c] = sum / n;
  };
  std::vector<std::size_t> layer;
  for (std::size_t c = 0; c < has_value.size(); ++c)
    if (has_value[c]) layer.push_back(c);
  std::vector<bool> is_next(has_value.size(), false);
  std::vector<std::size_t> filled;
  int n_layers = 0;
  while (!layer.empty()) {  // where the surface does not touch the fluid at all nothing presses on it
    std::vector<std::size_t> next;
    for (const std::size_t c : layer)
      visit_neighbours(c, [&](std::size_t other) {
        if (has_value[other] || is_next[other]) return;
        is_next[other] = true;
        next.push_back(other);
      });
    for (const std::size_t c : next) take_mean(c);
    for (const std::size_t c : next) has_value[c] = true;
    filled.insert(filled.end(), next.begin(), next.end());
    ++n_layers;
    layer = std::move(next);
  }
  for (int sweep = 0; sweep < std::min(n_layers, most_sweeps); ++sweep)
    for (const std::size_t c : filled) take_mean(c);
}

std::vector<double> flat(std::span<const Point> points) {
  std::vector<double> values;
  for (const Point& point : points) values.insert(values.end(), point.begin(), point.end());
  return values;
}

}  // namespace

StoredSurface stored_surface(const BodySurface& shown) {
  return {shown.name, !shown.is_closed, static_cast<std::int64_t>(shown.position.size()), shown.triangle};
}

std::vector<SurfaceField> fields_of(const StoredSurface& surface) {
  if (surface.has_two_sides)
    return {{"position", 3},       {"velocity", 3},       {"force", 3},
            {"pressure_outer", 1}, {"pressure_inner", 1}, {"viscous_traction", 3}};
  return {{"position", 3}, {"velocity", 3}, {"force", 3}, {"pressure", 1}, {"viscous_traction", 3}};
}

std::vector<SurfaceValues> measure_surfaces(const FlowPart& part, std::span<const StoredSurface> surfaces,
                                            std::span<const SurfaceLoad> loads,
                                            std::span<const std::vector<Point>> force) {
  const std::vector<BodySurface>& bodies = part.state.bodies->surfaces();
  CornerSums sums(*part.state.bodies);
  add_walls(part, sums);
  sums.finish(part.decomposition.communicator());
  std::vector<SurfaceValues> all;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const auto n = static_cast<std::size_t>(surfaces[s].n_corners);
    std::vector<bool> has_value(n);
    std::vector<CornerValues> at_corner(n, CornerValues::Zero());
    for (std::size_t c = 0; c < n; ++c) {
      const Eigen::Map<WallSums> sum = sums.of(s, c);
      has_value[c] = sum[0] > 0;
      if (!has_value[c]) continue;
      const Eigen::Vector3d friction = Eigen::Vector3d::Map(loads[s].corner_force[c].data()) - sum.tail<3>();
      at_corner[c] << sum[1] / sum[0], sum[2] / sum[0], friction / sum[0];
    }
    fill_from_neighbours(surfaces[s], has_value, at_corner);
    std::vector<double> outer, inner, traction;
    for (const CornerValues& value : at_corner) {
      outer.push_back(value[0]), inner.push_back(value[1]);
      traction.insert(traction.end(), value.data() + 2, value.data() + 5);
    }
    SurfaceValues values{flat({bodies[s].position.data(), n}), flat({bodies[s].velocity.data(), n}), flat(force[s])};
    values.push_back(std::move(outer));
    if (surfaces[s].has_two_sides) values.push_back(std::move(inner));
    values.push_back(std::move(traction));
    all.push_back(std::move(values));
  }
  return all;
}

void write_surface(ParallelFile& file, const StoredSurface& surface, const SurfaceValues& values, int rank) {
  const std::vector<SurfaceField> fields = fields_of(surface);
  const auto n_corners = static_cast<hsize_t>(surface.n_corners);
  for (std::size_t f = 0; f < fields.size(); ++f) {
    const hsize_t n_mine = rank == 0 ? n_corners : 0;  // all ranks know all values; one writes them
    ArrayBlock block{{n_corners}, {0}, {n_mine}};
    if (fields[f].n_components > 1) {
      const auto n_components = static_cast<hsize_t>(fields[f].n_components);
      block = {{n_corners, n_components}, {0, 0}, {n_mine, n_components}};
    }
    file.write("body/" + surface.name + "/" + fields[f].name, block, values[f].data(), Precision::single);
  }
}

}  // namespace couplet::flow
