#include "flow-server/output/momentum_balance.hpp"

#include <limits>

#include "flow-server/immersed/body_geometry.hpp"
#include "flow-server/output/open_face.hpp"
#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {

constexpr int least_cells = 4;

template <class Visit>
void for_each_cell(const Box& box, const Visit& visit) {
  for (int k = box.begin[2]; k < box.end[2]; ++k)
    for (int j = box.begin[1]; j < box.end[1]; ++j)
      for (int i = box.begin[0]; i < box.end[0]; ++i) visit(Triple{i, j, k});
}

/// Of the two layers of cells along the faces of the box, those of this rank.
int count_blocked(const FlowPart& part, const Box& cells) {
  const Box inner = cells.grown({-2, -2, part.grid.n_dimensions == 3 ? -2 : 0});
  const BodyGeometry* const bodies = part.state.bodies.get();
  int n = 0;
  for_each_cell(intersection(cells, part.decomposition.mine()).relative_to(part.origin()), [&](const Triple& cell) {
    const Triple global{cell[0] + part.origin()[0], cell[1] + part.origin()[1], cell[2] + part.origin()[2]};
    if (inner.contains(global)) return;
    const bool is_cut = bodies && (bodies->cut().find(cell) >= 0 || bodies->cut().is_solid(cell));
    if (is_cut || !part.active.contains(cell[0], cell[1], cell[2])) ++n;
  });
  return n;
}

}  // namespace

Box cells_of(const StretchedGrid& grid, const BalanceBox& box) {
  Box cells{{0, 0, 0}, grid.n_cells()};
  for (int d = 0; d < grid.n_dimensions; ++d) {
    const StretchedAxis& axis = grid.axis[d];
    while (cells.begin[d] < cells.end[d] && axis.centre(cells.begin[d]) < box.from[d]) ++cells.begin[d];
    while (cells.end[d] > cells.begin[d] && axis.centre(cells.end[d] - 1) > box.to[d]) --cells.end[d];
    if (cells.size(d) < least_cells)
      throw report::SceneError("flow.navier_stokes.momentum_balance '" + box.name + "'",
                               "has " + std::to_string(cells.size(d)) + " cells along " + "xyz"[d],
                               "give at least " + std::to_string(least_cells) + ", with the bodies well inside");
  }
  return cells;
}

BoxMomentum measure_momentum(const FlowPart& part, const Box& cells, double density, double viscosity,
                             const VectorValue& body_force) {
  BoxMomentum sum{.time = part.state.time, .pressure_time = part.state.pressure_time};
  if (!part.decomposition.has_cells()) return sum;
  const Box& mine = part.decomposition.mine();
  const BodyGeometry* const bodies = part.state.bodies.get();
  const VectorField& velocity = part.state.velocity;
  const Field<double>& pressure = part.state.pressure;
  std::array<AxisMetrics, 3> axis;
  for (int d = 0; d < 3; ++d) axis[d] = make_axis_metrics(part.grid.axis[d], mine.begin[d], mine.end[d]);
  sum.n_blocked = count_blocked(part, cells);
  for (int c = 0; c < part.grid.n_dimensions; ++c) {
    const AxisMetrics& along = axis[c];
    Box faces = cells;
    --faces.end[c];
    const Box first_and_last = faces.relative_to(part.origin());
    const Field<double>& u = velocity[c];
    for_each_cell(intersection(faces, mine).relative_to(part.origin()), [&](const Triple& face) {
      Triple next = face;
      ++next[c];
      const double length = 1 / along.inverse_control_width[face[c]];
      double volume = length;
      for (int e = 0; e < 3; ++e) volume *= e == c ? 1 : axis[e].width[face[e]];
      sum.momentum[c] += density * volume * open_velocity(bodies, u, c, face);
      Point at;
      for (int e = 0; e < 3; ++e) at[e] = e == c ? along.face[face[e]] : axis[e].centre[face[e]];
      const double force = body_force[c].at(at, part.state.time);
      if (force != 0) sum.body_force[c] += volume * open_share(bodies, c, face) * force;
      const double here = u(face[0], face[1], face[2]);
      for (int e = 0; e < part.grid.n_dimensions; ++e)
        for (const int side : {0, 1}) {
          if (face[e] != (side == 0 ? first_and_last.begin[e] : first_and_last.end[e] - 1)) continue;
          const double outward = side == 0 ? -1 : 1;
          Triple beyond = face;
          beyond[e] += side == 0 ? -1 : 1;
          const double there = u(beyond[0], beyond[1], beyond[2]);
          const double area = e == c ? volume / length : volume / axis[e].width[face[e]];
          double carrier, inverse_distance;  // on the face of the control volume, along e
          if (e == c) {
            const Triple& cell = side == 0 ? face : next;  // in whose middle that face stands
            carrier = 0.5 * (here + there);
            inverse_distance = along.inverse_width[cell[c]];
            sum.push[c] -= outward * area * pressure(cell[0], cell[1], cell[2]);
          } else {
            const int back = side == 0 ? 1 : 0;
            Triple lower = face, upper = next;
            lower[e] -= back, upper[e] -= back;
            carrier = along.share[face[c]] * velocity[e](lower[0], lower[1], lower[2]) +
                      (1 - along.share[face[c]]) * velocity[e](upper[0], upper[1], upper[2]);
            inverse_distance = axis[e].inverse_distance[face[e] - back];
          }
          sum.outflow[c] += area * (outward * density * carrier * 0.5 * (here + there) -
                                    viscosity * (there - here) * inverse_distance);
        }
    });
  }
  return sum;
}

Point force_on_bodies(const BoxMomentum& before, const BoxMomentum& after) {
  Point force{};
  if (before.n_blocked > 0 || after.n_blocked > 0) {
    force.fill(std::numeric_limits<double>::quiet_NaN());
    return force;
  }
  // The push in the middle of the interval, from the two times at which it is known.
  const double middle = 0.5 * (before.time + after.time), between = after.pressure_time - before.pressure_time;
  const double share = between > 0 ? (middle - before.pressure_time) / between : 1;
  for (std::size_t d = 0; d < 3; ++d)
    force[d] = -(after.momentum[d] - before.momentum[d]) / (after.time - before.time) -
               0.5 * (before.outflow[d] + after.outflow[d]) + (1 - share) * before.push[d] + share * after.push[d] +
               0.5 * (before.body_force[d] + after.body_force[d]);
  return force;
}

}  // namespace couplet::flow
