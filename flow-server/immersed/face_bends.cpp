#include "flow-server/immersed/face_bends.hpp"

#include <algorithm>

namespace couplet::flow {

namespace {

Eigen::Vector3d corner_of(const BodySurface& surface, int triangle, int v) {
  const auto c =
      static_cast<std::size_t>(surface.triangle[static_cast<std::size_t>(triangle)][static_cast<std::size_t>(v)]);
  return {surface.position[c][0], surface.position[c][1], surface.position[c][2]};
}

}  // namespace

void FaceBends::update(std::span<const BodySurface> surfaces, std::span<const Eigen::Vector3d> shifts, const Box& cells,
                       const std::array<std::vector<double>, 3>& corners) {
  found_.clear(), face_.clear(), bend_.clear();
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    for (const SharpEdge& edge : surfaces[s].sharp_edge)
      for (const Eigen::Vector3d& shift : shifts)
        cross_faces(surfaces[s], static_cast<int>(s), edge, shift, cells, corners);
  std::stable_sort(found_.begin(), found_.end(), [](const Found& a, const Found& b) { return a.face < b.face; });
  for (const Found& found : found_) {
    face_.push_back(found.face);
    bend_.push_back(found.bend);
  }
}

void FaceBends::cross_faces(const BodySurface& surface, int surface_index, const SharpEdge& edge,
                            const Eigen::Vector3d& shift, const Box& cells,
                            const std::array<std::vector<double>, 3>& corners) {
  const Eigen::Vector3d from = corner_of(surface, edge.triangle, edge.end[0]) + shift;
  const Eigen::Vector3d way = corner_of(surface, edge.triangle, edge.end[1]) + shift - from;
  for (int d = is_flat_ ? 2 : 0; d < 3; ++d) {
    if (way[d] == 0) continue;
    const std::vector<double>& along = corners[static_cast<std::size_t>(d)];
    // In two dimensions all is seen in the middle plane.
    const double middle = 0.5 * (along.front() + along.back());
    const std::span<const double> planes = is_flat_ ? std::span<const double>(&middle, 1) : std::span(along);
    const double low = std::min(from[d], from[d] + way[d]), high = std::max(from[d], from[d] + way[d]);
    const auto first = std::lower_bound(planes.begin(), planes.end(), low);
    for (auto plane = first; plane != planes.end() && *plane <= high; ++plane) {
      const double share = (*plane - from[d]) / way[d];
      Found found;
      found.face.direction = d;
      found.face.corner[d] = is_flat_ ? 0 : cells.begin[d] + static_cast<int>(plane - planes.begin());
      bool is_looked_at = true;
      for (int t = 0; t < 2; ++t) {
        const int e = (d + 1 + t) % 3;
        const std::vector<double>& at = corners[static_cast<std::size_t>(e)];
        const double x = from[e] + share * way[e];
        const auto behind = std::upper_bound(at.begin(), at.end(), x);
        is_looked_at = is_looked_at && behind != at.begin() && behind != at.end();
        if (!is_looked_at) break;
        found.face.corner[e] = cells.begin[e] + static_cast<int>(behind - at.begin()) - 1;
        found.bend.place[t] = (x - *(behind - 1)) / (*behind - *(behind - 1));
      }
      if (!is_looked_at) continue;
      SurfacePoint& point = found.bend.point;
      point.surface = surface_index;
      point.triangle = edge.triangle;
      point.weight.setZero();
      point.weight[edge.end[0]] = 1 - share;
      point.weight[edge.end[1]] = share;
      point.velocity.setZero();
      for (int v = 0; v < 3; ++v) {
        const auto c = static_cast<std::size_t>(
            surface.triangle[static_cast<std::size_t>(edge.triangle)][static_cast<std::size_t>(v)]);
        for (int q = 0; q < 3; ++q)
          point.velocity[q] += point.weight[v] * surface.velocity[c][static_cast<std::size_t>(q)];
      }
      found_.push_back(found);
    }
  }
}

std::span<const FaceBend> FaceBends::in_face(int d, const Triple& corner) const {
  if (face_.empty()) return {};
  Face face{d, corner};
  if (is_flat_) face.corner[2] = 0;
  const auto [begin, end] = std::equal_range(face_.begin(), face_.end(), face);
  return {bend_.data() + (begin - face_.begin()), static_cast<std::size_t>(end - begin)};
}

}  // namespace couplet::flow
