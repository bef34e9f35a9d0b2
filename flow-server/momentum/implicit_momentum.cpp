#include "flow-server/momentum/implicit_momentum.hpp"

#include <algorithm>

namespace couplet::flow {

ImplicitMomentum::ImplicitMomentum(const FlowBlock& block, const FlowBorder& border)
    : block_(block),
      border_(border),
      lower_(block.new_field()),
      diagonal_(block.new_field()),
      upper_(block.new_field()) {
  for (int d = 0; d < block.n_dimensions; ++d) lines_[d] = std::make_unique<LineSolver>(*block.decomposition, d);
}

void ImplicitMomentum::solve(double half_step, double viscosity, const VectorField& carrier, VectorField& change) {
  for (int c = 0; c < block_.n_dimensions; ++c)
    for (int d = block_.n_dimensions - 1; d >= 0; --d) {
      fill_rows(c, d, half_step, viscosity, carrier);
      add_inner_walls(c, d, half_step, viscosity);
      hold_openings(c);
      close_rows(c, d, carrier, change[c]);
      lines_[d]->solve(lower_, diagonal_, upper_, change[c]);
    }
}

/// Row i: x_i + dt/2 (F_i - F_{i-1}) / width, F_i = C_i (x_i + x_{i+1}) / 2 - nu (x_{i+1} - x_i) / distance.
void ImplicitMomentum::fill_rows(int c, int d, double half_step, double viscosity, const VectorField& carrier) {
  const AxisMetrics& along = block_.axis[d];
  const Field<double>& normal = carrier[d];
  // Steps in memory along the line and along the component.
  const std::array<std::ptrdiff_t, 3> strides{1, normal.stride_y(), normal.stride_z()};
  const std::ptrdiff_t step = strides[d], side = strides[c];
  for (int k = 0; k < block_.sizes[2]; ++k)
    for (int j = 0; j < block_.sizes[1]; ++j) {
      double* __restrict lower = lower_.row(j, k);
      double* __restrict diagonal = diagonal_.row(j, k);
      double* __restrict upper = upper_.row(j, k);
      std::fill(lower, lower + block_.sizes[0], 0.0);
      std::fill(diagonal, diagonal + block_.sizes[0], 1.0);
      std::fill(upper, upper + block_.sizes[0], 0.0);
      const double* __restrict speed = normal.row(j, k);
      const Triple cell{0, j, k};
      for_each_interval(block_.faces[c], j, k, 0, block_.sizes[0], [&](int begin, int end) {
        const auto set = [&](int i, double before, double after, double over, double nu_before, double nu_after) {
          const double factor = half_step * over;
          lower[i] = -factor * (0.5 * before + nu_before);
          diagonal[i] = 1 + factor * (0.5 * (after - before) + nu_after + nu_before);
          upper[i] = factor * (0.5 * after - nu_after);
        };
        if (c == d) {
#pragma GCC ivdep
          for (int i = begin; i < end; ++i) {
            const int n = d == 0 ? i : cell[d];
            set(i, 0.5 * (speed[i - step] + speed[i]), 0.5 * (speed[i] + speed[i + step]),
                along.inverse_control_width[n], viscosity * along.inverse_width[n],
                viscosity * along.inverse_width[n + 1]);
          }
        } else {
          const AxisMetrics& across = block_.axis[c];
#pragma GCC ivdep
          for (int i = begin; i < end; ++i) {
            const int n = d == 0 ? i : cell[d];
            const double share = across.share[c == 0 ? i : cell[c]];
            const double before = share * speed[i - step] + (1 - share) * speed[i - step + side];
            const double after = share * speed[i] + (1 - share) * speed[i + side];
            set(i, before, after, along.inverse_width[n], viscosity * along.inverse_distance[n - 1],
                viscosity * along.inverse_distance[n]);
          }
        }
      });
    }
}

/// More shear at walls inside the grid.
void ImplicitMomentum::add_inner_walls(int c, int d, double half_step, double viscosity) {
  for (const InnerWall& wall : block_.inner_walls[c])
    if (wall.direction == d)
      diagonal_(wall.cell[0], wall.cell[1], wall.cell[2]) += half_step * viscosity * wall.coefficient;
}

/// The faces of an opening at the end of the grid are rows of the block, those at its start are not; both are known.
void ImplicitMomentum::hold_openings(int c) {
  if (!border_.is_partly_open(c, 1) || !block_.decomposition->is_at_border(c, 1)) return;
  Box face = box_of(block_.sizes);
  face.begin[c] = face.end[c] - 1;
  for (int k = face.begin[2]; k < face.end[2]; ++k)
    for (int j = face.begin[1]; j < face.end[1]; ++j)
      for (int i = face.begin[0]; i < face.end[0]; ++i) {
        lower_(i, j, k) = upper_(i, j, k) = 0;
        diagonal_(i, j, k) = 1;
      }
}

/// The ends of lines at borders: the known change there goes to the right side, the ghost into the matrix.
void ImplicitMomentum::close_rows(int c, int d, const VectorField& carrier, Field<double>& change) {
  if (c == d) {
    if (!block_.decomposition->is_at_border(d, 0)) return;
    Box first = box_of(block_.sizes);
    first.end[d] = 1;
    for (int k = first.begin[2]; k < first.end[2]; ++k)
      for (int j = first.begin[1]; j < first.end[1]; ++j)
        for (int i = first.begin[0]; i < first.end[0]; ++i) {
          Triple border{i, j, k};
          --border[d];
          change(i, j, k) -= lower_(i, j, k) * change(border[0], border[1], border[2]);
          lower_(i, j, k) = 0;
        }
    return;
  }
  border_.visit_tangential(c, d, carrier,
                           [&](const Triple& cell, int side, const GhostWeights& ghost, double border_change) {
                             if (cell[c] < 0) return;
                             Field<double>& outward = side == 0 ? lower_ : upper_;
                             Field<double>& inward = side == 0 ? upper_ : lower_;
                             double& coefficient = outward(cell[0], cell[1], cell[2]);
                             change(cell[0], cell[1], cell[2]) -= coefficient * ghost.border * border_change;
                             diagonal_(cell[0], cell[1], cell[2]) += coefficient * ghost.first;
                             inward(cell[0], cell[1], cell[2]) += coefficient * ghost.second;
                             coefficient = 0;
                           });
}

Traffic ImplicitMomentum::traffic() const {
  Traffic all;
  for (const auto& lines : lines_)
    if (lines) all += lines->traffic();
  return all;
}

std::size_t ImplicitMomentum::n_bytes() const {
  std::size_t n = lower_.n_bytes() + diagonal_.n_bytes() + upper_.n_bytes();
  for (const auto& lines : lines_)
    if (lines) n += lines->n_bytes();
  return n;
}

}  // namespace couplet::flow
