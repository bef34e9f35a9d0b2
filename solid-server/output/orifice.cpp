#include "solid-server/output/orifice.hpp"

#include <algorithm>
#include <cmath>

#include "solid-server/element/shape_functions.hpp"

namespace couplet::solid {

namespace {

constexpr int n_pieces = 4;  // along each side of a face

/// Corners of the flat pieces of a face, in natural coordinates: (n_pieces + 1)^2 of a quadrilateral; those of a
/// triangle lie on the collapsed quadrilateral.
Eigen::Vector2d natural(FaceShape shape, int i, int j) {
  const double s = static_cast<double>(i) / n_pieces, t = static_cast<double>(j) / n_pieces;
  if (shape == FaceShape::triangle6) return {s * (1 - t), t};
  return {2 * s - 1, 2 * t - 1};
}

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

Orifice::Orifice(const SolidMesh& mesh, const OrificeShape& shape, const std::string& where)
    : shape_(shape), position_(mesh.node_position), cell_(2 * shape.radius / shape.n_cells) {
  for (std::size_t s = 0; s < shape.surfaces.size(); ++s)
    for (const ElementFace& face : mesh.find_surface(shape.surfaces[s], where + ".surface[" + std::to_string(s) + "]"))
      faces_.push_back(mesh.nodes_of(face));
  for (int j = 0; j < shape.n_cells; ++j)
    for (int i = 0; i < shape.n_cells; ++i)
      disc_.push_back(std::hypot(i + 0.5 - shape.n_cells / 2.0, j + 0.5 - shape.n_cells / 2.0) * cell_ <= shape.radius);
}

double Orifice::area(const NodeVectors& displacement) {
  is_open_ = disc_;
  const int first = (shape_.axis + 1) % 3, second = (shape_.axis + 2) % 3;
  std::array<std::array<Eigen::Vector2d, n_pieces + 1>, n_pieces + 1> point;
  for (const FaceNodes& face : faces_) {
    for (int j = 0; j <= n_pieces; ++j)
      for (int i = 0; i <= n_pieces; ++i) {
        const auto shape = shape_values(face.shape(), natural(face.shape(), i, j));
        Eigen::Vector2d p(-shape_.centre[first], -shape_.centre[second]);
        for (std::size_t a = 0; a < face.size(); ++a)
          p += shape[static_cast<Eigen::Index>(a)] *
               Eigen::Vector2d(position_(face[a], first) + displacement(face[a], first),
                               position_(face[a], second) + displacement(face[a], second));
        // In cells from the corner of the grid: the centre of cell (i, j) lies at (i + 1/2, j + 1/2).
        point[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)] = (p.array() + shape_.radius).matrix() / cell_;
      }
    for (std::size_t j = 0; j < n_pieces; ++j)
      for (std::size_t i = 0; i < n_pieces; ++i) {
        cover(point[j][i], point[j][i + 1], point[j + 1][i + 1]);
        cover(point[j][i], point[j + 1][i + 1], point[j + 1][i]);
      }
  }
  return static_cast<double>(std::count(is_open_.begin(), is_open_.end(), 1)) * cell_ * cell_;
}

/// Row by row: between the crossings of the triangle's sides with the line through the cells' centres.
void Orifice::cover(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  if (cross(b - a, c - a) == 0) return;
  const auto [low, high] = std::minmax({a.y(), b.y(), c.y()});
  const int n = shape_.n_cells;
  const int first_row = std::max(0, static_cast<int>(std::ceil(low - 0.5)));
  const int last_row = std::min(n - 1, static_cast<int>(std::floor(high - 0.5)));
  for (int j = first_row; j <= last_row; ++j) {
    const double y = j + 0.5;
    double left = n, right = 0;
    const auto cross_side = [&](const Eigen::Vector2d& p, const Eigen::Vector2d& q) {
      if ((p.y() <= y) == (q.y() <= y)) return;
      const double x = p.x() + (y - p.y()) / (q.y() - p.y()) * (q.x() - p.x());
      left = std::min(left, x);
      right = std::max(right, x);
    };
    cross_side(a, b);
    cross_side(b, c);
    cross_side(c, a);
    const int first = std::max(0, static_cast<int>(std::ceil(left - 0.5)));
    const int last = std::min(n - 1, static_cast<int>(std::floor(right - 0.5)));
    for (int i = first; i <= last; ++i) is_open_[static_cast<std::size_t>(j * n + i)] = 0;
  }
}

}  // namespace couplet::solid
