#include "solid-server/mesh/parametric/leaflet_grid.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>

#include "proto/report/failure.hpp"

namespace couplet::solid {

namespace {

/// `n + 1` values from -1 to 1 that divide the curve evenly by length.
std::vector<double> divide_evenly(const std::function<Eigen::Vector3d(double)>& curve, int n) {
  constexpr int n_pieces = 4000;  // chords: the length is off by some 1e-7 of itself
  std::vector<double> length(n_pieces + 1, 0.0);
  const auto parameter = [](double piece) { return -1 + 2 * piece / n_pieces; };
  Eigen::Vector3d last = curve(-1);
  for (int piece = 1; piece <= n_pieces; ++piece) {
    const Eigen::Vector3d next = curve(parameter(piece));
    length[static_cast<std::size_t>(piece)] = length[static_cast<std::size_t>(piece) - 1] + (next - last).norm();
    last = next;
  }
  std::vector<double> values = {-1};
  for (int part = 1; part < n; ++part) {
    const double wanted = length.back() * part / n;
    const auto after = std::upper_bound(length.begin() + 1, length.end() - 1, wanted);
    const double before = *std::prev(after);
    values.push_back(
        parameter(static_cast<double>(after - length.begin()) - 1 + (wanted - before) / (*after - before)));
  }
  values.push_back(1);
  return values;
}

/// Moves the inner points to where the springs on the lines between neighbours hold them still: each is the mean of its
/// neighbours, weighted with the stiffness of the line to it.
void balance(const std::vector<std::array<std::size_t, 2>>& line, const std::vector<double>& stiffness,
             const std::vector<bool>& is_on_rim, std::vector<Eigen::Vector2d>& place) {
  std::vector<int> unknown(place.size(), -1);
  int n_unknown = 0;
  for (std::size_t point = 0; point < place.size(); ++point)
    if (!is_on_rim[point]) unknown[point] = n_unknown++;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX2d rhs = Eigen::MatrixX2d::Zero(n_unknown, 2);
  for (std::size_t l = 0; l < line.size(); ++l)
    for (const auto& [from, to] : {std::pair{line[l][0], line[l][1]}, std::pair{line[l][1], line[l][0]}}) {
      const int row = unknown[from], column = unknown[to];
      if (row < 0) continue;
      entries.emplace_back(row, row, stiffness[l]);
      if (column >= 0)
        entries.emplace_back(row, column, -stiffness[l]);
      else
        rhs.row(row) += stiffness[l] * place[to].transpose();
    }
  Eigen::SparseMatrix<double> matrix(n_unknown, n_unknown);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix);
  const Eigen::MatrixX2d solved = factor.solve(rhs);
  for (std::size_t point = 0; point < place.size(); ++point)
    if (const int row = unknown[point]; row >= 0) place[point] = solved.row(row).transpose();
}

}  // namespace

std::size_t LeafletGrid::centre_point(int i, int j) const {
  return static_cast<std::size_t>(j * (2 * n_centre_along() + 1) + i);
}

std::size_t LeafletGrid::ring_point(int i, int j) const {
  const int along = 2 * n_centre_along(), across = 2 * n_centre_across();
  if (j == 2 * n_ring_) {  // the ring's inner side is the rim of the centre: down, along, up
    if (i <= across) return centre_point(0, across - i);
    if (i <= across + along) return centre_point(i - across, 0);
    return centre_point(along, i - across - along);
  }
  const int n_centre_points = (along + 1) * (across + 1);
  return static_cast<std::size_t>(n_centre_points + j * (2 * n_around() + 1) + i);
}

LeafletGrid::LeafletGrid(const LeafletSurface& surface, int n_along, int n_across)
    : n_along_(n_along), n_across_(n_across), n_ring_(std::clamp((n_along + 2) / 5, 1, std::max(1, n_across / 2))) {
  if (n_along < 4 || n_across < 2)
    throw report::SceneError(
        "valve", std::to_string(n_along) + " by " + std::to_string(n_across) + " elements are too few for a leaflet",
        "give at least 4 along the free edge and 2 across");
  const int ring_i = 2 * n_around(), ring_j = 2 * n_ring_, centre_i = 2 * n_centre_along(),
            centre_j = 2 * n_centre_across();
  const std::size_t n_points = centre_point(centre_i, centre_j) + 1 + static_cast<std::size_t>(ring_j * (ring_i + 1));
  parameters_.resize(n_points);

  // The rim is given, in the projection (y, z).
  std::vector<bool> is_on_rim(n_points, false);
  std::vector<Eigen::Vector2d> place(n_points);
  const auto put_on_rim = [&](std::size_t point, double u, double v) {
    is_on_rim[point] = true;
    parameters_[point] = {u, v};
    place[point] = surface.position(u, v).tail<2>();
  };
  const auto free_edge = divide_evenly([&](double u) { return surface.position(u, 1); }, 2 * n_along);
  for (int i = 0; i <= 2 * n_along; ++i) {
    const double u = free_edge[static_cast<std::size_t>(i)];
    if (i < ring_j)
      put_on_rim(ring_point(0, i), u, 1);
    else if (i <= ring_j + centre_i)
      put_on_rim(centre_point(i - ring_j, centre_j), u, 1);
    else
      put_on_rim(ring_point(ring_i, 2 * n_along - i), u, 1);
  }
  const auto attachment = divide_evenly([&](double u) { return surface.position(u, 0); }, ring_i);
  for (int i = 0; i <= ring_i; ++i) put_on_rim(ring_point(i, 0), attachment[static_cast<std::size_t>(i)], 0);

  std::vector<std::array<std::size_t, 2>> line;  // between neighbours, of both lattices, each once
  for (int j = 0; j <= centre_j; ++j)
    for (int i = 0; i <= centre_i; ++i) {
      if (i < centre_i) line.push_back({centre_point(i, j), centre_point(i + 1, j)});
      if (j < centre_j) line.push_back({centre_point(i, j), centre_point(i, j + 1)});
    }
  for (int j = 0; j < ring_j; ++j)
    for (int i = 0; i <= ring_i; ++i) {
      if (i < ring_i) line.push_back({ring_point(i, j), ring_point(i + 1, j)});
      line.push_back({ring_point(i, j), ring_point(i, j + 1)});
    }
  std::vector<double> stiffness(line.size(), 1.0);
  balance(line, stiffness, is_on_rim, place);
  // Equal springs crowd the nodes where three elements meet. Springs as stiff as they are long, once, halve that.
  const auto point_in_space = [&](std::size_t point) {
    const Eigen::Vector2d uv = surface.parameters_at(place[point][0], place[point][1]);
    return surface.position(uv[0], uv[1]);
  };
  for (std::size_t l = 0; l < line.size(); ++l)
    stiffness[l] = (point_in_space(line[l][0]) - point_in_space(line[l][1])).norm();
  balance(line, stiffness, is_on_rim, place);
  for (std::size_t point = 0; point < n_points; ++point)
    if (!is_on_rim[point]) parameters_[point] = surface.parameters_at(place[point][0], place[point][1]);
}

}  // namespace couplet::solid
