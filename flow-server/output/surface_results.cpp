#include "flow-server/output/surface_results.hpp"

#include <mpi.h>

#include <Eigen/Core>
#include <algorithm>

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

/// Values of corners that have none: the mean of neighbours that have one, from there on and on. (n_corners,
/// n_components).
void fill_from_neighbours(const StoredSurface& surface, std::vector<bool> has_value, int n_components,
                          std::vector<double>& values) {
  const auto n_corners = static_cast<std::size_t>(surface.n_corners);
  std::vector<std::vector<std::size_t>> triangles_of(n_corners);  // of the corners that wait
  std::vector<std::size_t> waiting;
  for (std::size_t c = 0; c < n_corners; ++c)
    if (!has_value[c]) waiting.push_back(c);
  for (std::size_t t = 0; t < surface.triangle.size(); ++t)
    for (const int corner : surface.triangle[t])
      if (!has_value[static_cast<std::size_t>(corner)]) triangles_of[static_cast<std::size_t>(corner)].push_back(t);
  std::vector<double> sum(static_cast<std::size_t>(n_components));
  while (!waiting.empty()) {
    std::vector<std::size_t> filled, still;
    for (const std::size_t c : waiting) {
      std::fill(sum.begin(), sum.end(), 0.0);
      int n = 0;
      for (const std::size_t t : triangles_of[c])
        for (const int corner : surface.triangle[t]) {
          const auto other = static_cast<std::size_t>(corner);
          if (!has_value[other]) continue;
          for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += values[other * sum.size() + i];
          ++n;
        }
      (n > 0 ? filled : still).push_back(c);
      for (std::size_t i = 0; i < sum.size() && n > 0; ++i) values[c * sum.size() + i] = sum[i] / n;
    }
    if (filled.empty()) return;  // the surface does not touch the fluid: nothing presses on it
    for (const std::size_t c : filled) has_value[c] = true;
    waiting = std::move(still);
  }
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
    std::vector<double> outer(n), inner(n), traction(3 * n);
    for (std::size_t c = 0; c < n; ++c) {
      const Eigen::Map<WallSums> sum = sums.of(s, c);
      has_value[c] = sum[0] > 0;
      if (!has_value[c]) continue;
      outer[c] = sum[1] / sum[0], inner[c] = sum[2] / sum[0];
      for (std::size_t d = 0; d < 3; ++d)
        traction[3 * c + d] = (loads[s].corner_force[c][d] - sum[static_cast<Eigen::Index>(3 + d)]) / sum[0];
    }
    fill_from_neighbours(surfaces[s], has_value, 1, outer);
    fill_from_neighbours(surfaces[s], has_value, 3, traction);
    SurfaceValues values{flat({bodies[s].position.data(), n}), flat({bodies[s].velocity.data(), n}), flat(force[s])};
    if (surfaces[s].has_two_sides) {
      fill_from_neighbours(surfaces[s], has_value, 1, inner);
      values.insert(values.end(), {outer, inner, traction});
    } else {
      values.insert(values.end(), {outer, traction});
    }
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
