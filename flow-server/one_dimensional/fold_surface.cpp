#include "flow-server/one_dimensional/fold_surface.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {

// Positions agree when they differ by less than this share of the length of the face along z: mesh files may be in
// single precision.
constexpr double relative_tolerance = 1e-5;

using FaceNodes = std::array<std::int32_t, 8>;

[[noreturn]] void refuse(std::int64_t face, const std::string& sentence) {
  throw report::PeerError(
      "surface of the fold", "face " + std::to_string(face) + " " + sentence,
      "the one-dimensional flow needs eight-node faces that are extruded along z in the reference state");
}

FaceNodes nodes_of(const surface::SurfaceMesh& mesh, std::int64_t face) {
  const auto begin = mesh.face_offset[face];
  if (mesh.face_offset[face + 1] - begin != 8) {
    refuse(face, "has " + std::to_string(mesh.face_offset[face + 1] - begin) + " nodes, not 8");
  }
  FaceNodes nodes{};
  for (int i = 0; i < 8; ++i) nodes[i] = static_cast<std::int32_t>(mesh.face_node[begin + i]);
  return nodes;
}

/// The same face numbered from its next corner: r becomes s.
FaceNodes turned(const FaceNodes& f) {
  return {f[1], f[2], f[3], f[0], f[5], f[6], f[7], f[4]};
}

/// Straight along z with its middle node in the middle.
bool is_along_z(const surface::NodeArray& position, int from, int middle, int to) {
  const Eigen::RowVector3d edge = position.row(to) - position.row(from);
  const Eigen::RowVector3d bend = position.row(middle) - 0.5 * (position.row(from) + position.row(to));
  const double tolerance = relative_tolerance * std::abs(edge[2]);
  return tolerance > 0 && std::hypot(edge[0], edge[1]) <= tolerance && bend.norm() <= tolerance;
}

bool is_extruded(const surface::NodeArray& position, const FaceNodes& f) {
  if (!is_along_z(position, f[1], f[5], f[2]) || !is_along_z(position, f[3], f[7], f[0])) return false;
  const double tolerance = relative_tolerance * std::abs(position(f[2], 2) - position(f[1], 2));
  const auto same_z = [&](int a, int b, int c) {
    return std::abs(position(a, 2) - position(b, 2)) <= tolerance &&
           std::abs(position(a, 2) - position(c, 2)) <= tolerance;
  };
  return same_z(f[0], f[4], f[1]) && same_z(f[2], f[6], f[3]);
}

FaceNodes across_and_along(const surface::SurfaceMesh& mesh, std::int64_t face) {
  const FaceNodes nodes = nodes_of(mesh, face);
  if (is_extruded(mesh.node_position, nodes)) return nodes;
  if (is_extruded(mesh.node_position, turned(nodes))) return turned(nodes);
  refuse(face, "does not have two straight edges along z and two edges in planes z = constant");
}

FaceRow row_of(const surface::NodeArray& position, const FaceNodes& f) {
  const auto [low, high] = std::minmax(position(f[1], 2), position(f[2], 2));
  return {low, high};
}

bool same_row(const FaceRow& a, const FaceRow& b) {
  const double tolerance = 10 * relative_tolerance * (a.z_high - a.z_low);
  return std::abs(a.z_low - b.z_low) <= tolerance && std::abs(a.z_high - b.z_high) <= tolerance;
}

/// Index of the row in `rows`, which grows when it is new.
std::int32_t find_row(std::vector<FaceRow>& rows, const FaceRow& row, std::int64_t face) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (same_row(rows[i], row)) return static_cast<std::int32_t>(i);
    const double overlap = std::min(rows[i].z_high, row.z_high) - std::max(rows[i].z_low, row.z_low);
    if (overlap > 10 * relative_tolerance * (row.z_high - row.z_low)) {
      std::ostringstream found;
      found << "spans z = " << row.z_low << " to " << row.z_high << " m and overlaps the row from " << rows[i].z_low
            << " to " << rows[i].z_high << " m";
      refuse(face, found.str());
    }
  }
  rows.push_back(row);
  return static_cast<std::int32_t>(rows.size() - 1);
}

}  // namespace

FoldSurface::FoldSurface(const surface::SurfaceMesh& mesh) : n_faces_(mesh.n_faces()) {
  surface::check_surface(mesh, "surface of the fold");
  if (n_faces_ == 0) {
    throw report::PeerError("surface of the fold", "it has no faces",
                            "name the wetted surfaces of the solid in solid.body.wetted");
  }
  reference_ = {mesh.node_position.col(0).array(), mesh.node_position.col(1).array(),
                mesh.node_position.col(2).array()};
  std::vector<FaceNodes> faces;
  std::vector<FaceRow> found;
  std::vector<std::int32_t> row_of_face;
  for (std::int64_t face = 0; face < n_faces_; ++face) {
    faces.push_back(across_and_along(mesh, face));
    row_of_face.push_back(find_row(found, row_of(mesh.node_position, faces.back()), face));
  }
  rows_ = found;
  std::sort(rows_.begin(), rows_.end(), [](const FaceRow& a, const FaceRow& b) { return a.z_low < b.z_low; });
  for (auto& row : row_of_face) {
    const double z_low = found[static_cast<std::size_t>(row)].z_low;
    row = static_cast<std::int32_t>(
        std::find_if(rows_.begin(), rows_.end(), [&](const FaceRow& r) { return r.z_low == z_low; }) - rows_.begin());
  }
  for (std::size_t first = 0; first < faces.size(); first += n_lanes) {
    FaceBatch batch;
    batch.n_faces = static_cast<int>(std::min<std::size_t>(n_lanes, faces.size() - first));
    for (std::size_t lane = 0; lane < n_lanes; ++lane) {
      const std::size_t face = first + (static_cast<int>(lane) < batch.n_faces ? lane : 0);
      for (std::size_t i = 0; i < 8; ++i) batch.node[i][lane] = faces[face][i];
      batch.row[lane] = row_of_face[face];
    }
    batches_.push_back(batch);
  }
}

void FoldSurface::move(const surface::NodeArray& displacement, NodePositions& moved) const {
  moved.x = reference_.x + displacement.col(0).array();
  moved.y = reference_.y + displacement.col(1).array();
  moved.z = reference_.z + displacement.col(2).array();
}

}  // namespace couplet::flow
