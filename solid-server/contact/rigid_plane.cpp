#include "solid-server/contact/rigid_plane.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "solid-server/element/lane_transpose.hpp"

namespace couplet::solid {

namespace {

constexpr int n_nodes = 8, n_face_points = PlaneContact::n_face_points;

[[gnu::always_inline]] inline Pack positive_part(const Pack& value) {
  return value > 0.0 ? value : Pack{};
}

[[gnu::always_inline]] inline double sum_of(const Pack& pack) {
  double sum = 0;
  for (int lane = 0; lane < n_lanes; ++lane) sum += pack[lane];
  return sum;
}

/// y at the points of eight faces.
[[gnu::always_inline]] inline void y_at_points(const FacePacks& faces, Index p, const double* displacement,
                                               Pack (&y)[n_face_points]) {
  const Index* start = &faces.node_start[static_cast<std::size_t>(p) * n_nodes * n_lanes];
  const StoredPack* position = &faces.position[static_cast<std::size_t>(p) * n_nodes * 3];
  for (int q = 0; q < n_face_points; ++q) y[q] = Pack{};
  for (int a = 0; a < n_nodes; ++a) {
    Pack u_x, u_y, u_z;
    load_nodes(displacement, start + a * n_lanes, u_x, u_y, u_z);
    const Pack y_node = load(position[3 * a + 1]) + u_y;
    for (int q = 0; q < n_face_points; ++q) y[q] += y_node * faces.shape[q][a];
  }
}

}  // namespace

PlaneContact::PlaneContact(const SolidMesh& mesh, const std::vector<FaceNodes>& faces, std::vector<RigidPlane> planes)
    : faces_(make_face_packs(mesh, faces)), planes_(std::move(planes)) {
  area_.resize(static_cast<std::size_t>(faces_.n_packs) * n_face_points);
  for (std::size_t p = 0; p < static_cast<std::size_t>(faces_.n_packs); ++p)
    for (std::size_t q = 0; q < n_face_points; ++q)
      for (std::size_t lane = 0; lane < n_lanes; ++lane) {
        if (p * n_lanes + lane >= faces.size()) continue;  // a copy has no area
        Eigen::Vector3d t[2] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
        for (std::size_t a = 0; a < n_nodes; ++a)
          for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t k = 0; k < 2; ++k)
              t[k][static_cast<Eigen::Index>(i)] +=
                  faces_.position[(p * n_nodes + a) * 3 + i].lane[lane] * faces_.gradient[q][a][k];
        area_[p * n_face_points + q].lane[lane] = t[0].cross(t[1]).norm() * faces_.weight[q];
      }
}

bool PlaneContact::touches(const Pack (&y)[n_face_points]) const {
  Pack highest = y[0];
  for (const Pack& y_point : y) highest = y_point > highest ? y_point : highest;
  return std::any_of(planes_.begin(), planes_.end(),
                     [&](const RigidPlane& plane) { return !all_true(highest <= plane.y); });
}

void PlaneContact::force(Index first, Index last, const double* displacement, StoredPack* force,
                         char* was_touching) const {
  for (Index p = first; p < last; ++p) {
    Pack y[n_face_points];
    y_at_points(faces_, p, displacement, y);
    const bool is_touching = touches(y);
    if (!is_touching && !was_touching[p]) continue;

    Pack f[n_nodes]{};
    for (int q = 0; q < n_face_points; ++q) {
      Pack pressure{};
      for (const RigidPlane& plane : planes_) pressure += plane.stiffness * positive_part(y[q] - plane.y);
      const Pack push = pressure * load(area_[static_cast<std::size_t>(p * n_face_points + q)]);
      for (int a = 0; a < n_nodes; ++a) f[a] -= push * faces_.shape[q][a];
    }
    StoredPack* out = force + static_cast<std::size_t>(p) * faces_.packs_of_force();
    for (int a = 0; a < n_nodes; ++a) store_nodes(Pack{}, f[a], Pack{}, out + 4 * a);
    was_touching[p] = is_touching;
  }
}

PlaneContact::Total PlaneContact::total(const double* displacement) const {
  Pack energy{}, force{};
  for (Index p = 0; p < faces_.n_packs; ++p) {
    Pack y[n_face_points];
    y_at_points(faces_, p, displacement, y);
    if (!touches(y)) continue;
    for (int q = 0; q < n_face_points; ++q) {
      const Pack dA = load(area_[static_cast<std::size_t>(p * n_face_points + q)]);
      for (const RigidPlane& plane : planes_) {
        const Pack depth = positive_part(y[q] - plane.y);
        energy += (plane.stiffness / 2) * depth * depth * dA;
        force += plane.stiffness * depth * dA;
      }
    }
  }
  return {sum_of(energy), sum_of(force)};
}

void PlaneContact::stiffness(
    const double* displacement,
    const std::function<void(Index node_a, Index node_b, const Eigen::Matrix3d& block)>& take) const {
  for (Index p = 0; p < faces_.n_packs; ++p) {
    Pack y[n_face_points];
    y_at_points(faces_, p, displacement, y);
    if (!touches(y)) continue;
    for (Index lane = 0; lane < std::min<Index>(n_lanes, faces_.n_faces - p * n_lanes); ++lane) {
      Eigen::Matrix<double, n_nodes, n_nodes> C = Eigen::Matrix<double, n_nodes, n_nodes>::Zero();
      for (int q = 0; q < n_face_points; ++q) {
        double per_area = 0;
        for (const RigidPlane& plane : planes_) per_area += y[q][lane] > plane.y ? plane.stiffness : 0;
        if (per_area == 0) continue;
        const auto N = Eigen::Map<const Eigen::Matrix<double, n_nodes, 1>>(faces_.shape[q]);
        C += per_area * area_[static_cast<std::size_t>(p * n_face_points + q)].lane[lane] * N * N.transpose();
      }
      if (C.isZero(0)) continue;
      const auto node = [&](int a) {
        return faces_.node_start[static_cast<std::size_t>((p * n_nodes + a) * n_lanes + lane)] /
               NodeVectors::ColsAtCompileTime;
      };
      for (int a = 0; a < n_nodes; ++a)
        for (int b = 0; b < n_nodes; ++b) {
          Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
          block(1, 1) = C(a, b);
          take(node(a), node(b), block);
        }
    }
  }
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
