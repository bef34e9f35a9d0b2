#include "solid-server/contact/rigid_plane.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "solid-server/element/lane_transpose.hpp"

namespace couplet::solid {

namespace {

std::size_t at(Index n) {
  return static_cast<std::size_t>(n);
}

[[gnu::always_inline]] inline Pack positive_part(const Pack& value) {
  return value > 0.0 ? value : Pack{};
}

[[gnu::always_inline]] inline double sum_of(const Pack& pack) {
  double sum = 0;
  for (int lane = 0; lane < n_lanes; ++lane) sum += pack[lane];
  return sum;
}

/// Depth beyond the plane, offset - n.x, at the points of eight faces.
template <int n_nodes, int n_points>
[[gnu::always_inline]] inline void depth_at_points(const FacePacks& faces, const Eigen::Vector3d& n, double offset,
                                                   Index p, const double* displacement, Pack (&depth)[n_points]) {
  const Index* start = &faces.node_start[at(p) * n_nodes * n_lanes];
  const StoredPack* position = &faces.position[at(p) * n_nodes * 3];
  for (int q = 0; q < n_points; ++q) depth[q] = Pack{};
  for (int a = 0; a < n_nodes; ++a) {
    Pack x, y, z;
    load_nodes(displacement, start + a * n_lanes, x, y, z);
    x += load(position[3 * a]);
    y += load(position[3 * a + 1]);
    z += load(position[3 * a + 2]);
    const Pack node_depth = offset - (n[0] * x + n[1] * y + n[2] * z);
    for (int q = 0; q < n_points; ++q) depth[q] += node_depth * faces.shape[q][a];
  }
}

template <int n_points>
[[gnu::always_inline]] inline bool touches(const Pack (&depth)[n_points]) {
  Pack deepest = depth[0];
  for (const Pack& at_point : depth) deepest = at_point > deepest ? at_point : deepest;
  return !all_true(deepest <= 0.0);
}

}  // namespace

PlaneContact::PlaneContact(const SolidMesh& mesh, const std::vector<FaceNodes>& faces, const RigidPlane& plane)
    : faces_(make_face_packs(mesh, faces)),
      normal_(plane.normal.normalized()),
      offset_(normal_.dot(plane.point)),
      stiffness_(plane.stiffness) {
  const std::size_t n_nodes = at(faces_.n_nodes), n_points = at(faces_.n_points);
  area_.resize(at(faces_.n_packs) * n_points);
  for (std::size_t face = 0; face < faces.size(); ++face)  // a copy that fills up a pack has no area
    for (std::size_t q = 0; q < n_points; ++q) {
      const std::size_t p = face / n_lanes, lane = face % n_lanes;
      Eigen::Vector3d t[2] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
      for (std::size_t a = 0; a < n_nodes; ++a)
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t k = 0; k < 2; ++k)
            t[k][static_cast<Eigen::Index>(i)] +=
                faces_.position[(p * n_nodes + a) * 3 + i].lane[lane] * faces_.gradient[q][a][k];
      area_[p * n_points + q].lane[lane] = t[0].cross(t[1]).norm() * faces_.weight[q];
    }
}

template <int n_nodes, int n_points>
void PlaneContact::force_of(Index first, Index last, const double* displacement, StoredPack* force,
                            char* was_touching) const {
  for (Index p = first; p < last; ++p) {
    Pack depth[n_points];
    depth_at_points<n_nodes>(faces_, normal_, offset_, p, displacement, depth);
    const bool is_touching = touches(depth);
    if (!is_touching && !was_touching[p]) continue;

    Pack f[n_nodes]{};
    for (int q = 0; q < n_points; ++q) {
      const Pack push = stiffness_ * positive_part(depth[q]) * load(area_[at(p) * n_points + at(q)]);
      for (int a = 0; a < n_nodes; ++a) f[a] += push * faces_.shape[q][a];
    }
    StoredPack* out = force + at(p) * at(faces_.packs_of_force());
    for (int a = 0; a < n_nodes; ++a) store_nodes(normal_[0] * f[a], normal_[1] * f[a], normal_[2] * f[a], out + 4 * a);
    was_touching[p] = is_touching;
  }
}

void PlaneContact::force(Index first, Index last, const double* displacement, StoredPack* force,
                         char* was_touching) const {
  with_face_shape(faces_, [&]<int n_nodes, int n_points>() {
    force_of<n_nodes, n_points>(first, last, displacement, force, was_touching);
  });
}

template <int n_nodes, int n_points>
PlaneContact::Total PlaneContact::total_of(const double* displacement) const {
  Pack energy{}, force{};
  for (Index p = 0; p < faces_.n_packs; ++p) {
    Pack depth[n_points];
    depth_at_points<n_nodes>(faces_, normal_, offset_, p, displacement, depth);
    if (!touches(depth)) continue;
    for (int q = 0; q < n_points; ++q) {
      const Pack push = stiffness_ * positive_part(depth[q]) * load(area_[at(p) * n_points + at(q)]);
      energy += push * positive_part(depth[q]) / 2.0;
      force += push;
    }
  }
  return {sum_of(energy), sum_of(force)};
}

PlaneContact::Total PlaneContact::total(const double* displacement) const {
  return with_face_shape(faces_,
                         [&]<int n_nodes, int n_points>() { return total_of<n_nodes, n_points>(displacement); });
}

void PlaneContact::stiffness(const double* displacement, const std::function<void(Index, Index, double)>& visit) const {
  const std::size_t n_nodes = at(faces_.n_nodes), n_points = at(faces_.n_points);
  for (Index face = 0; face < faces_.n_faces; ++face) {
    const std::size_t p = at(face) / n_lanes, lane = at(face) % n_lanes;
    const auto start = [&](std::size_t a) { return faces_.node_start[(p * n_nodes + a) * n_lanes + lane]; };
    double node_depth[max_face_nodes], sum[max_face_nodes][max_face_nodes]{};
    for (std::size_t a = 0; a < n_nodes; ++a) {
      node_depth[a] = offset_;
      for (std::size_t i = 0; i < 3; ++i)
        node_depth[a] -= normal_[static_cast<Eigen::Index>(i)] *
                         (faces_.position[(p * n_nodes + a) * 3 + i].lane[lane] + displacement[at(start(a)) + i]);
    }
    bool is_touching = false;
    for (std::size_t q = 0; q < n_points; ++q) {
      double depth = 0;
      for (std::size_t a = 0; a < n_nodes; ++a) depth += node_depth[a] * faces_.shape[q][a];
      if (!(depth > 0)) continue;
      is_touching = true;
      const double k_dA = stiffness_ * area_[p * n_points + q].lane[lane];
      for (std::size_t a = 0; a < n_nodes; ++a)
        for (std::size_t b = 0; b < n_nodes; ++b) sum[a][b] += k_dA * faces_.shape[q][a] * faces_.shape[q][b];
    }
    if (!is_touching) continue;
    for (std::size_t a = 0; a < n_nodes; ++a)
      for (std::size_t b = 0; b < n_nodes; ++b)
        visit(start(a) / NodeVectors::ColsAtCompileTime, start(b) / NodeVectors::ColsAtCompileTime, sum[a][b]);
  }
}

Eigen::VectorXd PlaneContact::stiffness_bound(Index n_nodes_of_body) const {
  Eigen::VectorXd bound = Eigen::VectorXd::Zero(n_nodes_of_body);
  const std::size_t n_nodes = at(faces_.n_nodes), n_points = at(faces_.n_points);
  for (Index face = 0; face < faces_.n_faces; ++face) {
    const std::size_t p = at(face) / n_lanes, lane = at(face) % n_lanes;
    for (std::size_t q = 0; q < n_points; ++q) {
      const double dA = area_[p * n_points + q].lane[lane];
      double sum = 0;
      for (std::size_t a = 0; a < n_nodes; ++a) sum += std::abs(faces_.shape[q][a]);
      for (std::size_t a = 0; a < n_nodes; ++a) {
        const Index start = faces_.node_start[(p * n_nodes + a) * n_lanes + lane];
        bound[start / NodeVectors::ColsAtCompileTime] += stiffness_ * dA * std::abs(faces_.shape[q][a]) * sum;
      }
    }
  }
  return bound;
}

}  // namespace couplet::solid
