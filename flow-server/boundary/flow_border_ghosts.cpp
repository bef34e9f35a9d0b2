#include <cmath>

#include "flow-server/boundary/flow_border.hpp"

namespace couplet::flow {

/// How the ghost of a tangential velocity follows from the border's and the two inner ones.
GhostWeights FlowBorder::ghost_weights(const Border& border, int component, Triple cell, std::size_t m,
                                       const VectorField& velocity) const {
  const BorderKind kind = border.layer[component].kind[m];
  if (kind == BorderKind::prescribed) return border.ghost;
  const GhostWeights no_shear{.border = 0, .first = 1, .second = 0};
  if (kind == BorderKind::slip) return no_shear;
  // Fluid that leaves has no shear there, fluid that enters comes straight.
  const Field<double>& normal = velocity[border.direction];
  cell[border.direction] = border.face;
  double outward = 0;
  for (const int place : {cell[component], cell[component] + 1}) {
    // Beyond another border stands a ghost that may not be filled yet; the cell before it tells the same.
    Triple at = cell;
    at[component] = place;
    if (place < 0 && decomposition_.is_at_border(component, 0)) at[component] = 0;
    if (place >= sizes_[component] && decomposition_.is_at_border(component, 1)) at[component] = sizes_[component] - 1;
    outward += border.outward * normal(at[0], at[1], at[2]);
  }
  return outward < 0 ? GhostWeights{} : no_shear;
}

void FlowBorder::fill_ghosts(const VectorField& velocity, double given, VectorField& field) const {
  for (const Border& border : borders_) {
    const int d = border.direction;
    for (int c = 0; c < n_dimensions_; ++c) {
      const Layer& layer = border.layer[c];
      for_each(border, layer, [&](Triple cell, std::size_t m) {
        const auto value_at = [&](const Field<double>& of, int place) {
          cell[d] = place;
          return of(cell[0], cell[1], cell[2]);
        };
        if (c == d) {
          // Only openings need the ghost of the normal velocity; the kernel's outer flux is (here + ghost)^2 / 4. Where
          // fluid leaves it is here^2. Fluid that comes back comes from rest, the mean of both convected values is
          // here / 2, the flux here^2 / 2. Through an inlet it comes straight, so that du/dn = 0 by continuity: the
          // flux is that on the inner side.
          const bool leaves = border.outward * value_at(velocity[c], border.face) >= 0;
          const double here = value_at(field[c], border.face);
          const double inner = value_at(field[c], border.face + (border.side == 0 ? 1 : -1));
          const double share = outside_share_[layer.patch[m]];
          const double from_rest = (std::sqrt(2.0) - 1) * here;
          const double ghost = leaves ? here : share * inner + (1 - share) * from_rest;
          cell[d] = border.face + (border.side == 0 ? -1 : 1);
          field[c](cell[0], cell[1], cell[2]) = ghost;
          return;
        }
        const GhostWeights weights = ghost_weights(border, c, cell, m, velocity);
        const double first = value_at(field[c], border.inside);
        double ghost = given * weights.border * layer.value[m] + weights.first * first;
        if (weights.second != 0) ghost += weights.second * value_at(field[c], border.next);
        cell[d] = border.outside;
        field[c](cell[0], cell[1], cell[2]) = ghost;
      });
    }
  }
}

void FlowBorder::fill_pressure_ghosts(Field<double>& pressure) const {
  for (const Border& border : borders_) {
    const int d = border.direction;
    const Layer& layer = border.layer[d];
    for_each(border, layer, [&](Triple cell, std::size_t m) {
      cell[d] = border.inside;
      const double inner = pressure(cell[0], cell[1], cell[2]);
      cell[d] = border.outside;
      pressure(cell[0], cell[1], cell[2]) = layer.kind[m] == BorderKind::opening ? layer.pressure[m] : inner;
    });
  }
}

void FlowBorder::fill_increment_ghosts(Field<double>& phi) const {
  for (const Border& border : borders_) {
    const Layer& layer = border.layer[border.direction];
    for_each(border, layer, [&](Triple cell, std::size_t) {
      cell[border.direction] = border.outside;
      phi(cell[0], cell[1], cell[2]) = 0;
    });
  }
}

}  // namespace couplet::flow
