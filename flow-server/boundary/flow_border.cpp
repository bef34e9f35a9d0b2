#include "flow-server/boundary/flow_border.hpp"

#include <cmath>

#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {

using report::text;

std::string border_name(int direction, int side) {
  return std::string("border ") + "xyz"[direction] + (side == 0 ? " start" : " end");
}

BorderKind kind_of(const FaceCondition& condition) {
  if (std::holds_alternative<PrescribedVelocity>(condition)) return BorderKind::prescribed;
  if (std::holds_alternative<PressureOpening>(condition)) return BorderKind::opening;
  if (std::holds_alternative<ConvectiveOutflow>(condition)) return BorderKind::outflow;
  return BorderKind::slip;
}

bool varies_in_time(const FaceCondition& condition) {
  if (const auto* prescribed = std::get_if<PrescribedVelocity>(&condition)) {
    for (const SpaceTimeValue& value : prescribed->velocity)
      if (value.varies_in_time()) return true;
  }
  if (const auto* opening = std::get_if<PressureOpening>(&condition)) return opening->pressure.varies_in_time();
  return false;
}

bool contains(const FacePatch& patch, int direction, const Point& point) {
  for (int d = 0; d < 3; ++d)
    if (d != direction && !(point[d] >= patch.from[d] && point[d] <= patch.to[d])) return false;
  return true;
}

}  // namespace

FlowBorder::FlowBorder(const StretchedGrid& grid, const BlockDecomposition& decomposition,
                       const BorderConditions& conditions, const IsFluid& is_fluid, bool balances_inflow)
    : grid_(grid),
      decomposition_(decomposition),
      n_dimensions_(grid.n_dimensions),
      sizes_(decomposition.mine().sizes()),
      balances_inflow_(balances_inflow) {
  patches_.push_back({FacePatch{.name = "wall", .condition = PrescribedVelocity{}}, "wall", false});
  std::array<std::array<std::size_t, 2>, 3> first_patch{};
  const std::array<bool, 3> is_periodic = grid.is_periodic();
  for (int d = 0; d < n_dimensions_; ++d) {
    for (int side = 0; side < 2; ++side) {
      first_patch[d][side] = patches_.size();
      for (const FacePatch& patch : conditions[d][side]) {
        const std::string place = border_name(d, side) + (patch.name.empty() ? "" : ", patch " + patch.name);
        if (is_periodic[d])
          throw report::SceneError(place, "a condition is given on a periodic axis",
                                   "remove it, or make the axis not periodic");
        patches_.push_back({patch, place, varies_in_time(patch.condition)});
        const BorderKind kind = kind_of(patch.condition);
        prescribed_varies_ |= kind == BorderKind::prescribed && patches_.back().varies_in_time;
        opening_varies_ |= kind == BorderKind::opening && patches_.back().varies_in_time;
      }
    }
  }
  outside_share_.assign(patches_.size(), 1.0);

  std::vector<double> counts(12, 0.0);  // per border: faces that are open, that are closed
  std::vector<double> has_kind(2, 0.0);
  for (int d = 0; d < n_dimensions_; ++d) {
    for (int side = 0; side < 2; ++side) {
      if (!decomposition.is_at_border(d, side)) continue;
      const int n = sizes_[d], global_cell = side == 0 ? 0 : grid.axis[d].n_cells() - 1;
      Border border{.direction = d,
                    .side = side,
                    .outside = side == 0 ? -1 : n,
                    .face = side == 0 ? -1 : n - 1,
                    .inside = side == 0 ? 0 : n - 1,
                    .next = side == 0 ? 1 : n - 2,
                    .outward = side == 0 ? -1.0 : 1.0,
                    .width = grid.axis[d].width(global_cell),
                    .ghost = linear_ghost(),
                    .layer = {}};
      if (grid.axis[d].n_cells() > 1)
        border.ghost = parabolic_ghost(border.width, grid.axis[d].width(global_cell + (side == 0 ? 1 : -1)));
      for (int c = 0; c < n_dimensions_; ++c) {
        Layer& layer = border.layer[c];
        layer.end = sizes_;
        if (c != d) layer.begin[c] = -1;
        const int a = (d + 1) % 3, b = (d + 2) % 3;
        const std::size_t n_faces = static_cast<std::size_t>(layer.end[a] - layer.begin[a]) *
                                    static_cast<std::size_t>(layer.end[b] - layer.begin[b]);
        layer.kind.assign(n_faces, BorderKind::prescribed);
        layer.patch.assign(n_faces, 0);
        layer.value.assign(n_faces, 0.0);
        if (c == d) layer.pressure.assign(n_faces, 0.0);
        for_each(border, layer, [&](const Triple& cell, std::size_t m) {
          const Point place = place_of(border, c, cell);
          for (std::size_t p = first_patch[d][side]; p < first_patch[d][side] + conditions[d][side].size(); ++p)
            if (contains(patches_[p].patch, d, place)) layer.patch[m] = static_cast<std::uint16_t>(p);
          if (is_fluid && c == d) {
            Point centre = place;
            centre[d] = grid.axis[d].centre(global_cell);
            if (!is_fluid(centre)) layer.patch[m] = 0;
          }
          layer.kind[m] = kind_of(patches_[layer.patch[m]].patch.condition);
          if (c != d) return;
          counts[static_cast<std::size_t>(4 * d + 2 * side) + (layer.kind[m] == BorderKind::opening ? 0 : 1)] += 1;
          if (layer.kind[m] == BorderKind::outflow) has_kind[0] += face_area(border, cell);
        });
      }
      borders_.push_back(std::move(border));
    }
  }
  if (is_fluid) leave_out_solid(is_fluid);
  sum_over_ranks(counts);
  sum_over_ranks(has_kind);
  for (int d = 0; d < n_dimensions_; ++d)
    for (int side = 0; side < 2; ++side) {
      const double open = counts[static_cast<std::size_t>(4 * d + 2 * side)];
      partly_open_[d][side] = open > 0;
      all_open_[d][side] = open > 0 && counts[static_cast<std::size_t>(4 * d + 2 * side + 1)] == 0;
      has_openings_ |= open > 0;
    }
  outflow_area_ = has_kind[0];
  has_outflow_ = outflow_area_ > 0;
}

/// What stands beside solid cells only would cost memory for cells that are never computed.
void FlowBorder::leave_out_solid(const IsFluid& is_fluid) {
  for (Border& border : borders_)
    for (int c = 0; c < n_dimensions_; ++c) {
      Layer& layer = border.layer[c];
      const int d = border.direction;
      const auto is_fluid_at = [&](Triple cell) {
        cell[d] = border.inside;
        Point centre;
        for (int e = 0; e < 3; ++e) centre[e] = grid_.axis[e].centre(decomposition_.mine().begin[e] + cell[e]);
        return is_fluid(centre);
      };
      std::vector<std::uint8_t> is_beside_fluid(layer.kind.size());
      for_each(border, layer, [&](Triple cell, std::size_t m) {
        const bool here = is_fluid_at(cell);
        if (c != d) ++cell[c];
        is_beside_fluid[m] = here || is_fluid_at(cell);
      });
      layer.is_beside_fluid = std::move(is_beside_fluid);
    }
}

Point FlowBorder::place_of(const Border& border, int component, const Triple& cell) const {
  Point place{};
  for (int d = 0; d < 3; ++d) {
    const int global = decomposition_.mine().begin[d] + cell[d];
    place[d] = d == component ? grid_.axis[d].face(global + 1) : grid_.axis[d].centre(global);
  }
  const StretchedAxis& axis = grid_.axis[border.direction];
  place[border.direction] = border.side == 0 ? axis.start() : axis.end();
  return place;
}

double FlowBorder::face_area(const Border& border, const Triple& cell) const {
  double area = 1;
  for (int d = 0; d < 3; ++d)
    if (d != border.direction) area *= grid_.axis[d].width(decomposition_.mine().begin[d] + cell[d]);
  return area;
}

void FlowBorder::sum_over_ranks(std::vector<double>& sums) {
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM,
                decomposition_.communicator());
  ++reductions_;
}

BorderKind FlowBorder::kind(int direction, int side, const Triple& cell) const {
  for (const Border& border : borders_)
    if (border.direction == direction && border.side == side) {
      const Layer& layer = border.layer[direction];
      return layer.kind[layer.at(cell, direction)];
    }
  return BorderKind::prescribed;
}

void FlowBorder::begin_step(const VectorField& velocity) {
  if (!has_openings_ && !has_outflow_) return;
  // Per patch: what flows in less what flows out, and both together [m^3/s].
  std::vector<double> flow(2 * patches_.size(), 0.0);
  for (const Border& border : borders_) {
    const Layer& layer = border.layer[border.direction];
    for_each(border, layer, [&](Triple cell, std::size_t m) {
      if (layer.kind[m] != BorderKind::opening && layer.kind[m] != BorderKind::outflow) return;
      const double area = face_area(border, cell);
      cell[border.direction] = border.face;
      const double inflow = -border.outward * velocity[border.direction](cell[0], cell[1], cell[2]) * area;
      flow[2 * layer.patch[m]] += inflow;
      flow[2 * layer.patch[m] + 1] += std::abs(inflow);
    });
  }
  sum_over_ranks(flow);
  double outflow = 0;
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    const BorderKind kind = kind_of(patches_[p].patch.condition);
    // An opening that as a whole takes fluid in passes on its momentum (the pressure given is that of the moving
    // fluid); what comes back through an opening that lets fluid out comes from fluid at rest, which takes energy out.
    outside_share_[p] = flow[2 * p] > 0 ? flow[2 * p] / flow[2 * p + 1] : 0.0;
    if (kind == BorderKind::outflow) outflow -= flow[2 * p];
  }
  outflow_speed_ = has_outflow_ ? std::max(0.0, outflow / outflow_area_) : 0.0;
}

void FlowBorder::evaluate_prescribed(double time) {
  for (Border& border : borders_)
    for (int c = 0; c < n_dimensions_; ++c) {
      Layer& layer = border.layer[c];
      // A value that does not vary in space is asked for once a patch.
      std::vector<double> of_patch(patches_.size(), std::numeric_limits<double>::quiet_NaN());
      std::vector<bool> is_known(patches_.size(), false);
      for_each(border, layer, [&](const Triple& cell, std::size_t m) {
        if (layer.kind[m] != BorderKind::prescribed) return;
        const std::size_t p = layer.patch[m];
        const SpaceTimeValue& value = std::get<PrescribedVelocity>(patches_[p].patch.condition).velocity[c];
        if (value.varies_in_space()) {
          layer.value[m] = value.at(place_of(border, c, cell), time);
        } else {
          if (!is_known[p]) of_patch[p] = value.at({}, time), is_known[p] = true;
          layer.value[m] = of_patch[p];
        }
      });
    }
}

void FlowBorder::set_time(double time, double elapsed, const VectorField& begin) {
  const bool is_new = !is_evaluated_ || (prescribed_varies_ && time != evaluated_time_) || balances_inflow_;
  if (is_new) evaluate_prescribed(time);
  evaluated_time_ = time;
  if (!is_new && !has_outflow_ && !opening_varies_) return;

  // What flows in, what passes in either direction, what the outflows carry out; then values that are not numbers.
  std::vector<double> sums(3 + patches_.size(), 0.0);
  for (Border& border : borders_) {
    const int d = border.direction;
    for (int c = 0; c < n_dimensions_; ++c) {
      const Layer& layer = border.layer[c];
      for (std::size_t m = 0; m < layer.value.size(); ++m)
        if (!std::isfinite(layer.value[m]) || (c == d && !std::isfinite(layer.pressure[m])))
          sums[3 + layer.patch[m]] += 1;
    }
    Layer& layer = border.layer[d];
    for_each(border, layer, [&](Triple cell, std::size_t m) {
      const double area = face_area(border, cell);
      if (layer.kind[m] == BorderKind::prescribed) {
        sums[0] -= border.outward * layer.value[m] * area;
        sums[1] += std::abs(layer.value[m]) * area;
      } else if (layer.kind[m] == BorderKind::outflow) {
        // du/dt + U du/dn = 0 over the half cell at the border, implicit in the border's value: stable with any step.
        cell[d] = border.face;
        const double here = begin[d](cell[0], cell[1], cell[2]);
        cell[d] += border.side == 0 ? 1 : -1;
        const double inner = begin[d](cell[0], cell[1], cell[2]);
        const double courant = outflow_speed_ * elapsed / border.width;
        layer.value[m] = here + courant / (1 + courant) * (inner - here);
        sums[2] += border.outward * layer.value[m] * area;
      }
    });
  }
  sum_over_ranks(sums);
  for (std::size_t p = 0; p < patches_.size(); ++p)
    if (sums[3 + p] > 0) {
      is_evaluated_ = false;
      throw report::NumericsError(patches_[p].place, "the value at t = " + text(time) + " s is not a number",
                                  "mend the time table or the expression of this patch");
    }
  is_evaluated_ = true;
  net_inflow_ = sums[0];
  if (has_openings_) return;
  if (has_outflow_) {
    // The flow through the outflows is what flows in, to round-off.
    const double missing = (net_inflow_ - sums[2]) / outflow_area_;
    for (Border& border : borders_) {
      Layer& layer = border.layer[border.direction];
      for (std::size_t m = 0; m < layer.value.size(); ++m)
        if (layer.kind[m] == BorderKind::outflow) layer.value[m] += border.outward * missing;
    }
    return;
  }
  constexpr double round_off = 1e-10;  // of sums over up to some million faces
  if (std::abs(net_inflow_) <= round_off * sums[1]) return;
  if (!balances_inflow_) {
    is_evaluated_ = false;
    const std::string sentence = "at t = " + text(time) + " s a net " + text(net_inflow_) +
                                 " m^3/s flows in through borders with a prescribed velocity and has no way out";
    const std::string advice =
        "open a border (pressure or outflow), correct the velocities, or let the inflow be balanced";
    if (prescribed_varies_) throw report::NumericsError("flow borders", sentence, advice);
    throw report::SceneError("flow borders", sentence, advice);
  }
  // Every moving face gives its share in proportion to what passes through it, so that walls stay closed.
  const double share = net_inflow_ / sums[1];
  for (Border& border : borders_) {
    Layer& layer = border.layer[border.direction];
    for (std::size_t m = 0; m < layer.value.size(); ++m)
      if (layer.kind[m] == BorderKind::prescribed) layer.value[m] += border.outward * share * std::abs(layer.value[m]);
  }
}

void FlowBorder::set_pressure_time(double time) {
  if (!has_openings_ || (pressure_is_evaluated_ && (!opening_varies_ || time == pressure_time_))) return;
  for (Border& border : borders_) {
    Layer& layer = border.layer[border.direction];
    for_each(border, layer, [&](const Triple& cell, std::size_t m) {
      if (layer.kind[m] != BorderKind::opening) return;
      const SpaceTimeValue& value = std::get<PressureOpening>(patches_[layer.patch[m]].patch.condition).pressure;
      layer.pressure[m] = value.at(place_of(border, border.direction, cell), time);
    });
  }
  pressure_time_ = time;
  pressure_is_evaluated_ = true;
}

void FlowBorder::impose(VectorField& velocity, bool with_outflow) const {
  for (const Border& border : borders_) {
    const int d = border.direction;
    const Layer& layer = border.layer[d];
    for_each(border, layer, [&](Triple cell, std::size_t m) {
      if (layer.kind[m] == BorderKind::opening || (layer.kind[m] == BorderKind::outflow && !with_outflow)) return;
      cell[d] = border.face;
      velocity[d](cell[0], cell[1], cell[2]) = layer.value[m];
    });
  }
}

void FlowBorder::remember() {
  for (Border& border : borders_)
    for (Layer& layer : border.layer) layer.remembered = layer.value;
}

void FlowBorder::add_pressure_change(double factor, const Field<double>& pressure, VectorField& velocity) const {
  for (const Border& border : borders_) {
    const int d = border.direction;
    const Layer& layer = border.layer[d];
    for_each(border, layer, [&](Triple cell, std::size_t m) {
      if (layer.kind[m] != BorderKind::opening) return;
      cell[d] = border.outside;
      const double change = layer.pressure[m] - pressure(cell[0], cell[1], cell[2]);
      cell[d] = border.face;
      velocity[d](cell[0], cell[1], cell[2]) -= factor * border.outward * change / (0.5 * border.width);
    });
  }
}

void FlowBorder::impose_rate(double time, double elapsed, const VectorField& velocity, VectorField& rate) {
  begin_step(velocity);
  std::vector<std::vector<double>> before;
  set_time(time, 0, velocity);
  for (const Border& border : borders_) before.push_back(border.layer[border.direction].value);
  set_time(time + elapsed, elapsed, velocity);
  for (std::size_t n = 0; n < borders_.size(); ++n) {
    const Border& border = borders_[n];
    const int d = border.direction;
    const Layer& layer = border.layer[d];
    for_each(border, layer, [&](Triple cell, std::size_t m) {
      if (layer.kind[m] == BorderKind::opening) return;
      cell[d] = border.face;
      rate[d](cell[0], cell[1], cell[2]) = (layer.value[m] - before[n][m]) / elapsed;
    });
  }
  set_time(time, 0, velocity);
}

}  // namespace couplet::flow
