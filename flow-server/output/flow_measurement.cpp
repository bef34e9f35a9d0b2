#include "flow-server/output/flow_measurement.hpp"

#include <algorithm>
#include <cmath>

#include "flow-server/immersed/body_geometry.hpp"
#include "flow-server/output/open_face.hpp"

namespace couplet::flow {

namespace {

/// Visits the cells of the block itself that are fluid and not cut by bodies, as (j, k, i_begin, i_end).
template <class Visit>
void for_each_run(const FlowPart& part, Visit visit) {
  const Box own = box_of(part.decomposition.mine().sizes());
  if (own.is_empty()) return;
  const BodyGeometry* const bodies = part.state.bodies.get();
  const ActiveCells whole = bodies ? bodies->cut().whole(part.active) : ActiveCells::all({});
  const ActiveCells& cells = bodies ? whole : part.active;
  for (int k = 0; k < own.end[2]; ++k) {
    for (int j = 0; j < own.end[1]; ++j) {
      for (const Interval& run : cells.row(j, k)) {
        const int begin = std::max(run.begin, 0), end = std::min(run.end, own.end[0]);
        if (begin < end) visit(j, k, begin, end);
      }
    }
  }
}

/// Widths of the cells and distances of their centres on a block, with one more on both sides: value[i + 1] belongs to
/// local index i.
struct Spacing {
  std::vector<double> width, inverse_distance;  // of cell i; from centre i to i + 1
};

Spacing spacing_of(const StretchedAxis& axis, int begin, int n) {
  Spacing spacing;
  for (int i = -1; i <= n; ++i) {
    spacing.width.push_back(axis.width(begin + i));
    spacing.inverse_distance.push_back(1 / axis.distance(begin + i));
  }
  return spacing;
}

double square(double x) {
  return x * x;
}

}  // namespace

double fluid_share(const FlowPart& part, const Triple& cell) {
  if (!part.active.contains(cell[0], cell[1], cell[2])) return 0;
  if (!part.state.bodies) return 1;
  const CutCells& cut = part.state.bodies->cut();
  const int index = cut.find(cell);
  if (index < 0) return cut.is_solid(cell) ? 0 : 1;
  const double volume =
      part.grid.volume({part.origin()[0] + cell[0], part.origin()[1] + cell[1], part.origin()[2] + cell[2]});
  return cut.fluid_volume(cut.cells()[static_cast<std::size_t>(index)]) / volume;
}

IntegralQuantities integrate(const FlowPart& part, double density, double viscosity) {
  const Triple sizes = part.decomposition.mine().sizes(), origin = part.origin();
  const int n_dimensions = part.grid.n_dimensions == 2 ? 2 : 3;
  IntegralQuantities total;
  if (!part.decomposition.has_cells()) return total;
  std::array<Spacing, 3> spacing;
  for (int d = 0; d < 3; ++d) spacing[d] = spacing_of(part.grid.axis[d], origin[d], sizes[d]);
  const Field<double>& first = part.state.velocity[0];
  const std::array<std::ptrdiff_t, 3> step{1, first.stride_y(), first.stride_z()};
  std::vector<double> energy(static_cast<std::size_t>(sizes[0])), strain(energy), rotation(energy);

  const auto add_run = [&](int j, int k, int begin, int end, double share) {
    const Triple row{0, j, k};
    for (std::vector<double>* const sums : {&energy, &strain, &rotation})
      std::fill(sums->begin() + begin, sums->begin() + end, 0.0);
    double* __restrict e = energy.data();
    double* __restrict s = strain.data();
    double* __restrict w = rotation.data();
    for (int d = 0; d < n_dimensions; ++d) {
      const double* u = part.state.velocity[d].row(j, k);
      const std::ptrdiff_t back = step[d];
      const double* width = spacing[d].width.data() + 1;
#pragma GCC ivdep
      for (int i = begin; i < end; ++i) {
        const double h = d == 0 ? width[i] : width[row[d]];
        e[i] += 0.5 * (square(u[i]) + square(u[i - back]));  // mean of the two faces
        s[i] += 2 * square((u[i] - u[i - back]) / h);        // 2 S_dd^2
      }
    }
    for (int a = 0; a < n_dimensions; ++a) {
      for (int b = a + 1; b < n_dimensions; ++b) {
        const double* u = part.state.velocity[a].row(j, k);
        const double* v = part.state.velocity[b].row(j, k);
        const double* to_a = spacing[a].inverse_distance.data() + 1;
        const double* to_b = spacing[b].inverse_distance.data() + 1;
        // The four edges around a cell in the plane of a and b: entry e is the edge towards +a and +b.
        for (int back_a = 0; back_a < 2; ++back_a) {
          for (int back_b = 0; back_b < 2; ++back_b) {
            const std::ptrdiff_t at = -back_a * step[a] - back_b * step[b];
            const std::ptrdiff_t next_a = step[a], next_b = step[b];
            const double gb = to_b[row[b] - back_b];
#pragma GCC ivdep
            for (int i = begin; i < end; ++i) {
              const double ga = a == 0 ? to_a[i - back_a] : to_a[row[a] - back_a];
              const double dv = (v[i + at + next_a] - v[i + at]) * ga;  // d u_b / d x_a
              const double du = (u[i + at + next_b] - u[i + at]) * gb;  // d u_a / d x_b
              s[i] += 0.25 * square(dv + du);                           // 4 S_ab^2
              w[i] += 0.25 * square(dv - du);
            }
          }
        }
      }
    }
    const double area =
        spacing[1].width[static_cast<std::size_t>(j + 1)] * spacing[2].width[static_cast<std::size_t>(k + 1)];
    double energy_sum = 0, strain_sum = 0, rotation_sum = 0;
    for (int i = begin; i < end; ++i) {
      const double volume = area * spacing[0].width[static_cast<std::size_t>(i + 1)];
      energy_sum += volume * e[i];
      strain_sum += volume * s[i];
      rotation_sum += volume * w[i];
    }
    total.kinetic_energy += share * 0.5 * density * energy_sum;
    total.dissipation += share * viscosity * strain_sum;
    total.enstrophy += share * 0.5 * rotation_sum;
  };
  for_each_run(part, [&](int j, int k, int begin, int end) { add_run(j, k, begin, end, 1); });
  if (!part.state.bodies) return total;
  const CutCells& cut = part.state.bodies->cut();
  for (const CutCell& cell : cut.cells()) {
    const auto& [i, j, k] = cell.cell;
    if (box_of(sizes).contains(cell.cell)) add_run(j, k, i, i + 1, fluid_share(part, cell.cell));
  }
  return total;
}

namespace {

/// Length of the part of a cell that lies between two limits.
double overlap(const StretchedAxis& axis, int cell, double from, double to) {
  return std::max(0.0, std::min(axis.face(cell + 1), to) - std::max(axis.face(cell), from));
}

/// The cell whose faces lie around a position, the last one at the end of the axis.
int cell_around(const StretchedAxis& axis, double position) {
  const auto& faces = axis.faces();
  const auto next = std::upper_bound(faces.begin(), faces.end(), position);
  return std::clamp(static_cast<int>(next - faces.begin()) - 1, 0, axis.n_cells() - 1);
}

}  // namespace

PlaneRates integrate(const FlowPart& part, const PlaneCut& plane, double density) {
  const int d = plane.direction, a = (d + 1) % 3, b = (d + 2) % 3;
  const StretchedAxis& axis = part.grid.axis[d];
  const Box& mine = part.decomposition.mine();
  const int cell = cell_around(axis, plane.position);
  const BodyGeometry* const bodies = part.state.bodies.get();
  PlaneRates rates;
  if (!part.decomposition.has_cells() || cell < mine.begin[d] || cell >= mine.end[d]) return rates;
  const double after = (plane.position - axis.face(cell)) / axis.width(cell);  // share of the face behind the cell
  Triple here, before;
  here[d] = cell - mine.begin[d];
  before[d] = here[d] - 1;
  for (int jb = 0; jb < mine.size(b); ++jb) {
    const double height = overlap(part.grid.axis[b], mine.begin[b] + jb, plane.from[b], plane.to[b]);
    for (int ja = 0; ja < mine.size(a); ++ja) {
      const double area = height * overlap(part.grid.axis[a], mine.begin[a] + ja, plane.from[a], plane.to[a]);
      here[a] = before[a] = ja;
      here[b] = before[b] = jb;
      if (area == 0 || !part.active.contains(here[0], here[1], here[2])) continue;
      const Field<double>& u = part.state.velocity[d];
      const double normal =
          (1 - after) * open_velocity(bodies, u, d, before) + after * open_velocity(bodies, u, d, here);
      const double share = (1 - after) * open_share(bodies, d, before) + after * open_share(bodies, d, here);
      rates.flow_rate += area * normal;
      if (share > 0) rates.momentum_flux += density * area * normal * normal / share;
    }
  }
  return rates;
}

PointValue measure(const FlowPart& part, const PointProbe& probe) {
  PointValue value;
  const Box& mine = part.decomposition.mine();
  Triple cell;
  for (int d = 0; d < 3; ++d) cell[d] = cell_around(part.grid.axis[d], probe.position[d]);
  if (!part.decomposition.has_cells() || !mine.contains(cell)) return value;

  constexpr int pressure = -1;
  // Ghosts exist beyond one border at a time. Beyond an edge or a corner stands what makes the field linear there.
  const auto value_at = [&](const Field<double>& field, int component, const Triple& at) {
    Triple inside = at;
    int n_beyond = 0;
    for (int d = 0; d < part.grid.n_dimensions; ++d) {
      const int global = at[d] + mine.begin[d], n = part.grid.axis[d].n_cells();
      if (d == component || part.grid.axis[d].is_periodic() || (global >= 0 && global < n)) continue;
      inside[d] = (global < 0 ? 0 : n - 1) - mine.begin[d];
      ++n_beyond;
    }
    if (n_beyond < 2) return field(at[0], at[1], at[2]);
    const double within = field(inside[0], inside[1], inside[2]);
    double sum = within;
    for (int d = 0; d < 3; ++d) {
      if (inside[d] == at[d]) continue;
      Triple beyond = inside;
      beyond[d] = at[d];
      sum += field(beyond[0], beyond[1], beyond[2]) - within;
    }
    return sum;
  };
  const auto interpolate = [&](const Field<double>& field, int component) {
    std::array<int, 3> lower{0, 0, 0};
    std::array<double, 3> share{0, 0, 0};  // of the upper neighbour
    for (int d = 0; d < 3; ++d) {
      if (d >= part.grid.n_dimensions) break;
      const StretchedAxis& axis = part.grid.axis[d];
      const double x = probe.position[d];
      const int i = cell[d];
      if (d == component) {
        lower[d] = i - 1;  // entry i - 1 is the face at the start of cell i
        share[d] = (x - axis.face(i)) / axis.width(i);
      } else {
        lower[d] = x < axis.centre(i) ? i - 1 : i;
        share[d] = (x - axis.centre(lower[d])) / axis.distance(lower[d]);
        const bool has_neighbours = axis.is_periodic() || (lower[d] >= 0 && lower[d] + 1 < axis.n_cells());
        // The pressure beside a border is that of the cell there; a velocity has the border's own in its ghosts.
        if (component == pressure && !has_neighbours) lower[d] = i, share[d] = 0;
      }
      lower[d] -= mine.begin[d];
    }
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      double weight = 1;
      Triple at;
      for (int d = 0; d < 3; ++d) {
        const int upper = corner >> d & 1;
        weight *= upper == 1 ? share[d] : 1 - share[d];
        at[d] = lower[d] + upper;
      }
      if (weight != 0) sum += weight * value_at(field, component, at);
    }
    return sum;
  };
  for (int d = 0; d < part.grid.n_dimensions; ++d) value.velocity[d] = interpolate(part.state.velocity[d], d);
  value.pressure = interpolate(part.state.pressure, pressure);
  return value;
}

ErrorSums compare(const FlowPart& part, const ExactFlow& exact) {
  ErrorSums sums;
  const Triple origin = part.origin();
  for_each_run(part, [&](int j, int k, int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const Triple cell{origin[0] + i, origin[1] + j, origin[2] + k};
      Point centre;
      for (int d = 0; d < 3; ++d) centre[d] = part.grid.axis[d].centre(cell[d]);
      const double volume = part.grid.volume(cell);
      sums.volume += volume;
      const double error = part.state.pressure(i, j, k) - exact.pressure(centre, part.state.pressure_time);
      sums.pressure += volume * error;
      sums.pressure_square += volume * error * error;
      for (int d = 0; d < part.grid.n_dimensions; ++d) {
        Point face = centre;
        face[d] = part.grid.axis[d].face(cell[d] + 1);
        const double distance = std::abs(part.state.velocity[d](i, j, k) -
                                         exact.velocity(face, part.state.time)[static_cast<std::size_t>(d)]);
        sums.velocity_square += volume * distance * distance;
        sums.largest_velocity = std::max(sums.largest_velocity, distance);
      }
    }
  });
  return sums;
}

}  // namespace couplet::flow
