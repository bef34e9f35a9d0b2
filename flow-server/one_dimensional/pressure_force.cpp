#include "flow-server/one_dimensional/pressure_force.hpp"

#include <cmath>

namespace couplet::flow {

PressureForce::PressureForce(const FoldSurface& surface, const StationAxis& axis)
    : surface_(&surface), axis_(&axis), line_(static_cast<std::size_t>(axis.n_stations()) + 1) {
  const std::array<double, 3> place{-std::sqrt(0.6), 0, std::sqrt(0.6)};
  constexpr std::array<double, 3> weight{5.0 / 9, 8.0 / 9, 5.0 / 9};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      point_[3 * i + j] = quadratic_face_point(place[i], place[j]);
      weight_[3 * i + j] = weight[i] * weight[j];
    }
  }
}

void PressureForce::find(const NodePositions& moved, const GlottalSolution& flow, const EndPressures& pressures,
                         surface::NodeArray& force) {
  find_lines(flow, pressures);
  force.setZero();
  for (const FaceBatch& batch : surface_->batches()) {
    FaceLanes face;
    for (std::size_t i = 0; i < 8; ++i) {
      for (int lane = 0; lane < n_lanes; ++lane) {
        const auto node = batch.node[i][static_cast<std::size_t>(lane)];
        face.x[i][lane] = moved.x[node];
        face.y[i][lane] = moved.y[node];
        face.z[i][lane] = moved.z[node];
      }
    }
    const FaceLanes f = force_on_batch(face);
    for (int lane = 0; lane < batch.n_faces; ++lane) {
      for (std::size_t i = 0; i < 8; ++i) {
        const auto node = batch.node[i][static_cast<std::size_t>(lane)];
        force(node, 0) += f.x[i][lane];
        force(node, 1) += f.y[i][lane];
        force(node, 2) += f.z[i][lane];
      }
    }
  }
}

void PressureForce::find_lines(const GlottalSolution& flow, const EndPressures& pressures) {
  const Eigen::ArrayXd& xi = axis_->fraction();
  const int n = axis_->n_stations();
  inlet_ = flow.position[0];
  fraction_per_length_ = 1 / (flow.exit - inlet_);
  line_.front() = {pressures.inlet, 0};
  line_.back() = {pressures.exit, 0};
  for (int k = 0; k < n - 1; ++k) {
    const double slope = (flow.pressure[k + 1] - flow.pressure[k]) / (xi[k + 1] - xi[k]);
    line_[static_cast<std::size_t>(k) + 1] = {flow.pressure[k] - slope * xi[k], slope};
  }
}

Lanes PressureForce::pressure_at(const Lanes& x) const {
  const Lanes xi = (x - inlet_) * fraction_per_length_;
  Lanes p;
  for (int lane = 0; lane < n_lanes; ++lane) {
    const PressureLine& line = line_[static_cast<std::size_t>(axis_->first_at_or_after(xi[lane]))];
    p[lane] = line.value + line.slope * xi[lane];
  }
  return p;
}

PressureForce::FaceLanes PressureForce::force_on_batch(const FaceLanes& face) const {
  FaceLanes force;
  for (auto* component : {&force.x, &force.y, &force.z}) component->fill(Lanes::Zero());
  for (std::size_t g = 0; g < n_points; ++g) {
    const QuadraticFacePoint& point = point_[g];
    Lanes x = Lanes::Zero();
    Lanes xr = Lanes::Zero(), yr = Lanes::Zero(), zr = Lanes::Zero();
    Lanes xs = Lanes::Zero(), ys = Lanes::Zero(), zs = Lanes::Zero();
    for (std::size_t i = 0; i < 8; ++i) {
      x += point.value[i] * face.x[i];
      xr += point.by_r[i] * face.x[i];
      yr += point.by_r[i] * face.y[i];
      zr += point.by_r[i] * face.z[i];
      xs += point.by_s[i] * face.x[i];
      ys += point.by_s[i] * face.y[i];
      zs += point.by_s[i] * face.z[i];
    }
    const Lanes minus_pw = -weight_[g] * pressure_at(x);
    const Lanes fx = minus_pw * (yr * zs - zr * ys);  // -p dX/dr x dX/ds
    const Lanes fy = minus_pw * (zr * xs - xr * zs);
    const Lanes fz = minus_pw * (xr * ys - yr * xs);
    for (std::size_t i = 0; i < 8; ++i) {
      force.x[i] += point.value[i] * fx;
      force.y[i] += point.value[i] * fy;
      force.z[i] += point.value[i] * fz;
    }
  }
  return force;
}

}  // namespace couplet::flow
