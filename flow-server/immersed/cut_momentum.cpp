#include "flow-server/immersed/cut_momentum.hpp"

namespace couplet::flow {

namespace {

/// The velocities that the rate of one face depends on: its own, then the entries of CutRow.
struct RowValues {
  double own = 0;
  std::array<double, CutRow::n_entries> seen{};
};

RowValues values_behind_walls(const FlowBlock& block, const CutRow& row, const VectorField& velocity) {
  RowValues values;
  const int c = row.component;
  values.own = velocity[c](row.face[0], row.face[1], row.face[2]);
  for (int e = 0; e < block.n_dimensions; ++e)
    for (int side = 0; side < 2; ++side) {
      Triple next = row.face;
      next[e] += side == 0 ? -1 : 1;
      values.seen[static_cast<std::size_t>(2 * e + side)] = velocity[c](next[0], next[1], next[2]);
    }
  std::size_t entry = 6;
  for (int e = 0; e < block.n_dimensions; ++e) {
    if (e == c) continue;
    for (int beyond = 0; beyond < 2; ++beyond)
      for (int side = 0; side < 2; ++side) {
        Triple cell = row.face;
        cell[c] += beyond;
        cell[e] -= side == 0 ? 1 : 0;
        values.seen[entry++] = velocity[e](cell[0], cell[1], cell[2]);
      }
  }
  return values;
}

/// Convection and diffusion as in explicit_momentum.cpp, for one face.
double rate_of(const FlowBlock& block, const CutRow& row, const RowValues& values, double viscosity) {
  const int c = row.component;
  const AxisMetrics& along = block.axis[c];
  const int at = row.face[c];
  const double share = along.share[at];
  const auto flux = [](double carrier, double here, double next, double viscosity_over_distance) {
    return 0.5 * carrier * (here + next) - viscosity_over_distance * (next - here);
  };
  double out = 0;
  std::size_t entry = 6;
  for (int e = 0; e < block.n_dimensions; ++e) {
    const double before = values.seen[static_cast<std::size_t>(2 * e)];
    const double after = values.seen[static_cast<std::size_t>(2 * e + 1)];
    if (e == c) {
      const double end = flux(0.5 * (values.own + after), values.own, after, viscosity * along.inverse_width[at + 1]);
      const double start = flux(0.5 * (before + values.own), before, values.own, viscosity * along.inverse_width[at]);
      out += (end - start) * along.inverse_control_width[at];
      continue;
    }
    const AxisMetrics& across = block.axis[e];
    const int i = row.face[e];
    const double start_carrier = share * values.seen[entry] + (1 - share) * values.seen[entry + 2];
    const double end_carrier = share * values.seen[entry + 1] + (1 - share) * values.seen[entry + 3];
    entry += 4;
    const double end = flux(end_carrier, values.own, after, viscosity * across.inverse_distance[i]);
    const double start = flux(start_carrier, before, values.own, viscosity * across.inverse_distance[i - 1]);
    out += (end - start) * across.inverse_width[i];
  }
  return -out;
}

}  // namespace

void correct_cut_rows(const FlowBlock& block, const WallLayer& layer, double share, double viscosity, double now,
                      const VectorField& velocity, VectorField* rate, VectorField& new_velocity) {
  std::vector<double> ghost;
  ghost.reserve(layer.ghosts().size());
  for (const WallValue& value : layer.ghosts()) ghost.push_back(WallLayer::value_of(value, velocity[value.component]));
  for (const CutRow& row : layer.rows()) {
    const RowValues through = values_behind_walls(block, row, velocity);
    RowValues seen = through;
    for (std::size_t n = 0; n < seen.seen.size(); ++n) {
      const CutRow::Seen& what = row.seen[n];
      if (what.ghost >= 0) seen.seen[n] += what.blocked * (ghost[static_cast<std::size_t>(what.ghost)] - seen.seen[n]);
    }
    const double change = share * (rate_of(block, row, seen, viscosity) - rate_of(block, row, through, viscosity));
    new_velocity[row.component](row.face[0], row.face[1], row.face[2]) += now * change;
    if (rate) (*rate)[row.component](row.face[0], row.face[1], row.face[2]) += change;
  }
}

}  // namespace couplet::flow
