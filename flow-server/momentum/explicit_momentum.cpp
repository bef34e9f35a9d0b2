#include "flow-server/momentum/explicit_momentum.hpp"

namespace couplet::flow {

namespace {

/// Momentum that leaves through a face, of which `next` lies beyond: carried by `carrier`, and by viscosity. The
/// convected velocity is the plain mean whatever the spacing: that makes convection skew-symmetric.
inline double flux(double carrier, double here, double next, double viscosity_over_distance) {
  return 0.5 * carrier * (here + next) - viscosity_over_distance * (next - here);
}

/// The rows that the stencil of one row touches.
struct Rows {
  const double *here, *south, *north, *bottom, *top;
};

Rows rows_of(const Field<double>& field, int j, int k, bool has_depth) {
  const double* here = field.row(j, k);
  const std::ptrdiff_t y = field.stride_y(), z = has_depth ? field.stride_z() : 0;
  return {here, here - y, here + y, here - z, here + z};
}

template <int n_dimensions, bool is_own_carrier, bool reads_before, bool stores_rate>
class MomentumSweep {
 public:
  static constexpr bool three = n_dimensions == 3;

  MomentumSweep(const FlowBlock& block, const MomentumWeights& weights, const VectorField& carrier,
                const VectorField& velocity, const Field<double>& pressure, const VectorField* rate_before,
                VectorField* rate, VectorField& new_velocity)
      : block_(block),
        weights_(weights),
        carrier_(is_own_carrier ? velocity : carrier),
        velocity_(velocity),
        pressure_(pressure),
        rate_before_(rate_before),
        rate_(rate),
        new_velocity_(new_velocity) {}

  /// Faces begin <= i < end normal to x.
  void x_row(int begin, int end, int j, int k) {
    const AxisMetrics& x = block_.axis[0];
    const double* __restrict inverse_width = x.inverse_width.from_zero();
    const double* __restrict inverse_control_width = x.inverse_control_width.from_zero();
    const double* __restrict share = x.share.from_zero();
    const Rows q = rows_of(velocity_[0], j, k, three);
    const Rows u = rows_of(carrier_[0], j, k, three), v = rows_of(carrier_[1], j, k, three);
    const Rows w = three ? rows_of(carrier_[2], j, k, three) : Rows{};
    const double* __restrict p = pressure_.row(j, k);
    const double nu = weights_.viscosity;
    const double y_over = block_.axis[1].inverse_width[j], z_over = block_.axis[2].inverse_width[k];
    const double nu_south = nu * block_.axis[1].inverse_distance[j - 1],
                 nu_north = nu * block_.axis[1].inverse_distance[j];
    const double nu_bottom = nu * block_.axis[2].inverse_distance[k - 1],
                 nu_top = nu * block_.axis[2].inverse_distance[k];
    update_row(0, begin, end, j, k, [&](int i, double& slope) {
      const double here = q.here[i];
      // The carrier is the mean of the fluxes of both cells, so that it is as free of divergence as they are.
      const double east = flux(0.5 * (u.here[i] + u.here[i + 1]), here, q.here[i + 1], nu * inverse_width[i + 1]);
      const double west = flux(0.5 * (u.here[i - 1] + u.here[i]), q.here[i - 1], here, nu * inverse_width[i]);
      const double left = share[i], right = 1 - share[i];
      const double north = flux(left * v.here[i] + right * v.here[i + 1], here, q.north[i], nu_north);
      const double south = flux(left * v.south[i] + right * v.south[i + 1], q.south[i], here, nu_south);
      double out = (east - west) * inverse_control_width[i] + (north - south) * y_over;
      if constexpr (three) {
        const double top = flux(left * w.here[i] + right * w.here[i + 1], here, q.top[i], nu_top);
        const double bottom = flux(left * w.bottom[i] + right * w.bottom[i + 1], q.bottom[i], here, nu_bottom);
        out += (top - bottom) * z_over;
      }
      slope = (p[i + 1] - p[i]) * inverse_control_width[i];
      return -out;
    });
  }

  /// Faces normal to y between the rows j and j + 1.
  void y_row(int begin, int end, int j, int k) {
    const AxisMetrics& x = block_.axis[0];
    const double* __restrict inverse_width = x.inverse_width.from_zero();
    const double* __restrict inverse_distance = x.inverse_distance.from_zero();
    const Rows q = rows_of(velocity_[1], j, k, three);
    const Rows u = rows_of(carrier_[0], j, k, three), v = rows_of(carrier_[1], j, k, three);
    const Rows w = three ? rows_of(carrier_[2], j, k, three) : Rows{};
    const double* __restrict w_bottom_north = three ? carrier_[2].row(j + 1, k - 1) : nullptr;
    const Rows p = rows_of(pressure_, j, k, three);
    const double nu = weights_.viscosity;
    const double y_over = block_.axis[1].inverse_control_width[j], z_over = block_.axis[2].inverse_width[k];
    const double nu_south = nu * block_.axis[1].inverse_width[j], nu_north = nu * block_.axis[1].inverse_width[j + 1];
    const double nu_bottom = nu * block_.axis[2].inverse_distance[k - 1],
                 nu_top = nu * block_.axis[2].inverse_distance[k];
    const double low = block_.axis[1].share[j], high = 1 - low;
    update_row(1, begin, end, j, k, [&](int i, double& slope) {
      const double here = q.here[i];
      const double east = flux(low * u.here[i] + high * u.north[i], here, q.here[i + 1], nu * inverse_distance[i]);
      const double west =
          flux(low * u.here[i - 1] + high * u.north[i - 1], q.here[i - 1], here, nu * inverse_distance[i - 1]);
      const double north = flux(0.5 * (v.here[i] + v.north[i]), here, q.north[i], nu_north);
      const double south = flux(0.5 * (v.south[i] + v.here[i]), q.south[i], here, nu_south);
      double out = (east - west) * inverse_width[i] + (north - south) * y_over;
      if constexpr (three) {
        const double top = flux(low * w.here[i] + high * w.north[i], here, q.top[i], nu_top);
        const double bottom = flux(low * w.bottom[i] + high * w_bottom_north[i], q.bottom[i], here, nu_bottom);
        out += (top - bottom) * z_over;
      }
      slope = (p.north[i] - p.here[i]) * y_over;
      return -out;
    });
  }

  /// Faces normal to z between the planes k and k + 1.
  void z_row(int begin, int end, int j, int k) {
    const AxisMetrics& x = block_.axis[0];
    const double* __restrict inverse_width = x.inverse_width.from_zero();
    const double* __restrict inverse_distance = x.inverse_distance.from_zero();
    const Rows q = rows_of(velocity_[2], j, k, true);
    const Rows u = rows_of(carrier_[0], j, k, true), v = rows_of(carrier_[1], j, k, true);
    const Rows w = rows_of(carrier_[2], j, k, true);
    const double* __restrict v_south_top = carrier_[1].row(j - 1, k + 1);
    const Rows p = rows_of(pressure_, j, k, true);
    const double nu = weights_.viscosity;
    const double y_over = block_.axis[1].inverse_width[j], z_over = block_.axis[2].inverse_control_width[k];
    const double nu_south = nu * block_.axis[1].inverse_distance[j - 1],
                 nu_north = nu * block_.axis[1].inverse_distance[j];
    const double nu_bottom = nu * block_.axis[2].inverse_width[k], nu_top = nu * block_.axis[2].inverse_width[k + 1];
    const double low = block_.axis[2].share[k], high = 1 - low;
    update_row(2, begin, end, j, k, [&](int i, double& slope) {
      const double here = q.here[i];
      const double east = flux(low * u.here[i] + high * u.top[i], here, q.here[i + 1], nu * inverse_distance[i]);
      const double west =
          flux(low * u.here[i - 1] + high * u.top[i - 1], q.here[i - 1], here, nu * inverse_distance[i - 1]);
      const double north = flux(low * v.here[i] + high * v.top[i], here, q.north[i], nu_north);
      const double south = flux(low * v.south[i] + high * v_south_top[i], q.south[i], here, nu_south);
      const double top = flux(0.5 * (w.here[i] + w.top[i]), here, q.top[i], nu_top);
      const double bottom = flux(0.5 * (w.bottom[i] + w.here[i]), q.bottom[i], here, nu_bottom);
      slope = (p.top[i] - p.here[i]) * z_over;
      return -((east - west) * inverse_width[i] + (north - south) * y_over + (top - bottom) * z_over);
    });
  }

 private:
  template <class Rate>
  void update_row(int c, int begin, int end, int j, int k, const Rate& rate_of) {
    const double* __restrict old = velocity_[c].row(j, k);
    const double* before = reads_before ? (*rate_before_)[c].row(j, k) : nullptr;
    double* stored = stores_rate ? (*rate_)[c].row(j, k) : nullptr;
    double* __restrict fresh = new_velocity_[c].row(j, k);
    const double weight_now = weights_.now, weight_before = weights_.before, impulse = weights_.impulse[c];
    const double weight_pressure = weights_.pressure;
#pragma GCC ivdep
    for (int i = begin; i < end; ++i) {
      double slope;
      const double rate_now = rate_of(i, slope);
      double change = weight_now * rate_now - weight_pressure * slope + impulse;
      if constexpr (reads_before) change += weight_before * before[i];
      if constexpr (stores_rate) stored[i] = rate_now;
      fresh[i] = old[i] + change;
    }
  }

  const FlowBlock& block_;
  const MomentumWeights& weights_;
  const VectorField& carrier_;
  const VectorField& velocity_;
  const Field<double>& pressure_;
  const VectorField* rate_before_;
  VectorField* rate_;
  VectorField& new_velocity_;
};

template <class Sweep>
void sweep_rows(const FlowBlock& block, const Box& part, Sweep sweep) {
  std::array<Box, 3> box;
  Box rows{{0, part.begin[1], part.begin[2]}, {0, part.end[1], part.end[2]}};
  for (int c = 0; c < block.n_dimensions; ++c) box[c] = intersection(part, block.computed_faces(c));
  for (int k = rows.begin[2]; k < rows.end[2]; ++k)
    for (int j = rows.begin[1]; j < rows.end[1]; ++j)
      for (int c = 0; c < block.n_dimensions; ++c) {
        if (j < box[c].begin[1] || j >= box[c].end[1] || k < box[c].begin[2] || k >= box[c].end[2]) continue;
        for_each_interval(block.faces[c], j, k, box[c].begin[0], box[c].end[0], [&](int begin, int end) {
          if (c == 0) sweep.x_row(begin, end, j, k);
          if (c == 1) sweep.y_row(begin, end, j, k);
          if constexpr (Sweep::three)
            if (c == 2) sweep.z_row(begin, end, j, k);
        });
      }
}

/// The part of the shear at walls inside the grid that the sweep does not see.
void add_inner_walls(const FlowBlock& block, const Box& part, const MomentumWeights& weights,
                     const VectorField& velocity, VectorField* rate, VectorField& new_velocity) {
  for (int c = 0; c < block.n_dimensions; ++c)
    for (const InnerWall& wall : block.inner_walls[c]) {
      if (!part.contains(wall.cell)) continue;
      const auto [i, j, k] = wall.cell;
      const double slowing = -weights.viscosity * wall.coefficient * velocity[c](i, j, k);
      new_velocity[c](i, j, k) += weights.now * slowing;
      if (rate) (*rate)[c](i, j, k) += slowing;
    }
}

}  // namespace

void advance_momentum(const FlowBlock& block, const Box& part, const MomentumWeights& weights,
                      const VectorField& carrier, const VectorField& velocity, const Field<double>& pressure,
                      const VectorField* rate_before, VectorField* rate, VectorField& new_velocity) {
  const auto with = [&]<int n_dimensions, bool is_own_carrier, bool reads_before, bool stores_rate>() {
    sweep_rows(block, part,
               MomentumSweep<n_dimensions, is_own_carrier, reads_before, stores_rate>(
                   block, weights, carrier, velocity, pressure, rate_before, rate, new_velocity));
  };
  const auto with_dimensions = [&]<int n_dimensions>() {
    const bool reads = weights.before != 0, stores = rate != nullptr;
    if (&carrier != &velocity) return with.template operator()<n_dimensions, false, false, false>();
    if (reads && stores) with.template operator()<n_dimensions, true, true, true>();
    if (reads && !stores) with.template operator()<n_dimensions, true, true, false>();
    if (!reads && stores) with.template operator()<n_dimensions, true, false, true>();
    if (!reads && !stores) with.template operator()<n_dimensions, true, false, false>();
  };
  if (block.n_dimensions == 3) {
    with_dimensions.template operator()<3>();
  } else {
    with_dimensions.template operator()<2>();
  }
  add_inner_walls(block, part, weights, velocity, rate, new_velocity);
}

}  // namespace couplet::flow
