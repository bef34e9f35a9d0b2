#include "solid-server/contact/rigid_plane.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "solid-server/element/lane_transpose.hpp"

namespace couplet::solid {

namespace {

constexpr int n_nodes = hex20::n_face_nodes;

[[gnu::always_inline]] inline Pack positive_part(const Pack& value) {
  return value > 0.0 ? value : Pack{};
}

/// y of the eight nodes of eight faces.
[[gnu::always_inline]] inline void load_y(const FacePacks& faces, Index p, const double* displacement,
                                          Pack (&y)[n_nodes]) {
  const Index* start = &faces.node_start[static_cast<std::size_t>(p) * n_nodes * n_lanes];
  const StoredPack* position = &faces.position[static_cast<std::size_t>(p) * n_nodes * 3];
  for (int a = 0; a < n_nodes; ++a) {
    Pack u_x, u_y, u_z;
    load_nodes(displacement, start + a * n_lanes, u_x, u_y, u_z);
    y[a] = load(position[3 * a + 1]) + u_y;
  }
}

[[gnu::always_inline]] inline Pack interpolate(const double (&shape)[n_nodes], const Pack (&y)[n_nodes]) {
  Pack value{};
  for (int a = 0; a < n_nodes; ++a) value += y[a] * shape[a];
  return value;
}

/// An upper bound of y at the points: with shapes that add up to 1, sum N_a y_a <= y_max + (sum |N_a| - 1)/2 (y_max -
/// y_min).
[[gnu::always_inline]] inline Pack reach(const Pack (&y)[n_nodes], double overshoot) {
  Pack low = y[0], high = y[0];
  for (int a = 1; a < n_nodes; ++a) {
    low = y[a] < low ? y[a] : low;
    high = y[a] > high ? y[a] : high;
  }
  return high + overshoot * (high - low);
}

}  // namespace

PlaneContact::PlaneContact(const SolidMesh& mesh, const std::vector<FaceNodes>& faces, std::vector<RigidPlane> planes)
    : faces_(make_face_packs(mesh, faces)), planes_(std::move(planes)) {
  area_.resize(static_cast<std::size_t>(faces_.n_packs) * n_face_points);
  for (int q = 0; q < n_face_points; ++q) {
    double sum = 0;
    for (const double N : faces_.shape[q]) sum += std::abs(N);
    overshoot_ = std::max(overshoot_, (sum - 1) / 2);
  }
  for (std::size_t p = 0; p < static_cast<std::size_t>(faces_.n_packs); ++p)
    for (std::size_t q = 0; q < n_face_points; ++q)
      for (std::size_t lane = 0; lane < n_lanes; ++lane) {
        Eigen::Vector3d t[2] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
        for (std::size_t a = 0; a < n_nodes; ++a)
          for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t k = 0; k < 2; ++k)
              t[k][static_cast<Eigen::Index>(i)] +=
                  faces_.position[(p * n_nodes + a) * 3 + i].lane[lane] * faces_.gradient[q][a][k];
        area_[p * n_face_points + q].lane[lane] = t[0].cross(t[1]).norm() * faces_.weight[q];
      }
}

bool PlaneContact::is_near(const Pack& highest) const {
  return std::any_of(planes_.begin(), planes_.end(),
                     [&](const RigidPlane& plane) { return !all_true(highest <= plane.y); });
}

void PlaneContact::force(Index first, Index last, const double* displacement, StoredPack* force,
                         char* was_touching) const {
  for (Index p = first; p < last; ++p) {
    Pack y[n_nodes];
    load_y(faces_, p, displacement, y);
    const bool touches = is_near(reach(y, overshoot_));
    if (!touches && !was_touching[p]) continue;

    Pack f[n_nodes]{};
    for (int q = 0; q < n_face_points; ++q) {
      const Pack y_point = interpolate(faces_.shape[q], y),
                 dA = load(area_[static_cast<std::size_t>(p * n_face_points + q)]);
      Pack pressure{};
      for (const RigidPlane& plane : planes_) pressure += plane.stiffness * positive_part(y_point - plane.y);
      for (int a = 0; a < n_nodes; ++a) f[a] -= pressure * dA * faces_.shape[q][a];
    }
    StoredPack* out = force + static_cast<std::size_t>(p) * packs_per_face_pack;
    for (int a = 0; a < n_nodes; ++a) store_nodes(Pack{}, f[a], Pack{}, out + 4 * a);
    was_touching[p] = touches;
  }
}

PlaneContact::Total PlaneContact::total(const double* displacement) const {
  Total total;
  for (Index p = 0; p < faces_.n_packs; ++p) {
    Pack y[n_nodes];
    load_y(faces_, p, displacement, y);
    if (!is_near(reach(y, overshoot_))) continue;
    for (int q = 0; q < n_face_points; ++q) {
      const Pack y_point = interpolate(faces_.shape[q], y);
      const auto& dA = area_[static_cast<std::size_t>(p * n_face_points + q)];
      for (Index lane = 0; lane < std::min<Index>(n_lanes, faces_.n_faces - p * n_lanes); ++lane)
        for (const RigidPlane& plane : planes_) {
          const double depth = std::max(0.0, y_point[lane] - plane.y);
          total.energy += plane.stiffness / 2 * depth * depth * dA.lane[lane];
          total.force += plane.stiffness * depth * dA.lane[lane];
        }
    }
  }
  return total;
}

Eigen::VectorXd PlaneContact::stiffness_bound(Index n_nodes_of_body) const {
  Eigen::VectorXd bound = Eigen::VectorXd::Zero(n_nodes_of_body);
  double stiffness = 0;
  for (const RigidPlane& plane : planes_) stiffness += plane.stiffness;
  for (Index face = 0; face < faces_.n_faces; ++face) {
    const Index p = face / n_lanes, lane = face % n_lanes;
    for (int q = 0; q < n_face_points; ++q) {
      const double dA = area_[static_cast<std::size_t>(p * n_face_points + q)].lane[lane];
      double sum = 0;
      for (const double N : faces_.shape[q]) sum += std::abs(N);
      for (int a = 0; a < n_nodes; ++a) {
        const Index start = faces_.node_start[static_cast<std::size_t>((p * n_nodes + a) * n_lanes + lane)];
        bound[start / NodeVectors::ColsAtCompileTime] += stiffness * dA * std::abs(faces_.shape[q][a]) * sum;
      }
    }
  }
  return bound;
}

}  // namespace couplet::solid
