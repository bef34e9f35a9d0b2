#pragma once
// A box with parallel sheets, as a problem of the pressure solver on a block and as connections of the whole.

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <vector>

#include "flow-server/poisson/pressure_solver.hpp"

namespace couplet::flow {

/// Sheets are the planes normal * x = offset; side s lies between offset s - 1 and offset s.
struct SplitBox {
  std::array<std::vector<double>, 3> faces;
  int n_dimensions = 3;
  std::array<bool, 3> is_periodic{};
  std::array<std::array<bool, 2>, 3> border_is_open{};
  std::array<double, 3> normal{1, 0, 0};
  std::vector<double> offset = {};  // rising; none: no sheet
  /// Is the cell with that centre cut by sheets? Where not, it has one unknown on all sides. Not set: every one.
  std::function<bool(double x, double y, double z)> is_cut = {};
  double edge_conductance = 0;  // over the width of the cell: between all pieces of each cut cell

  StretchedGrid grid() const {
    return {{StretchedAxis(faces[0], is_periodic[0]), StretchedAxis(faces[1], is_periodic[1]),
             StretchedAxis(faces[2], is_periodic[2])},
            n_dimensions};
  }
};

/// One end of a connection in indices of the whole; number 0: the cell's own unknown. cell beyond an open border: phi =
/// 0.
struct GridUnknown {
  Triple cell{0, 0, 0};
  int number = 0;
  friend auto operator<=>(const GridUnknown&, const GridUnknown&) = default;
};

class SheetGeometry {
 public:
  explicit SheetGeometry(const SplitBox& box) : box_(box), grid_(box.grid()), n_(grid_.n_cells()) {}

  const StretchedGrid& grid() const { return grid_; }
  int n_sides() const { return static_cast<int>(box_.offset.size()) + 1; }
  Triple wrapped(Triple cell) const {
    for (int d = 0; d < 3; ++d)
      if (box_.is_periodic[d]) cell[d] = (cell[d] + n_[d]) % n_[d];
    return cell;
  }
  bool is_inside(const Triple& cell) const {
    for (int d = 0; d < 3; ++d)
      if (!box_.is_periodic[d] && (cell[d] < 0 || cell[d] >= n_[d])) return false;
    return true;
  }

  /// Share of the area of the face at the upper side of `cell` along `d` that lies on each side.
  std::vector<double> shares(const Triple& cell, int d) const {
    Triple at = wrapped(cell);
    const double plane = cell[d] < 0 && !box_.is_periodic[d] ? box_.faces[d].front() : box_.faces[d][at[d] + 1];
    std::array<std::array<double, 2>, 3> corner;
    for (int e = 0; e < 3; ++e)
      corner[e] = e == d ? std::array{plane, plane} : std::array{box_.faces[e][at[e]], box_.faces[e][at[e] + 1]};
    std::vector<double> share(static_cast<std::size_t>(n_sides()), 0.0);
    if (const int alone = side_of(corner); alone >= 0) {
      share[static_cast<std::size_t>(alone)] = 1;
      return share;
    }
    share.clear();
    double below = 0;
    for (const double offset : box_.offset) {
      const double up_to = share_below(corner, d, offset);
      share.push_back(up_to - below);
      below = up_to;
    }
    share.push_back(1 - below);
    for (double& one : share)
      if (one < 1e-13) one = 0;
    return share;
  }
  /// The sides that a cell has, that of its centre first; -1 alone where it is not cut.
  std::vector<int> sides(const Triple& given) const {
    const Triple cell = wrapped(given);
    const double x = grid_.axis[0].centre(cell[0]), y = grid_.axis[1].centre(cell[1]),
                 z = grid_.axis[2].centre(cell[2]);
    if (box_.offset.empty() || (box_.is_cut && !box_.is_cut(x, y, z))) return {-1};
    std::array<std::array<double, 2>, 3> corner;
    for (int e = 0; e < 3; ++e) corner[e] = {box_.faces[e][cell[e]], box_.faces[e][cell[e] + 1]};
    if (const int alone = side_of(corner); alone >= 0) return {alone};
    std::vector<bool> has(static_cast<std::size_t>(n_sides()), false);
    for (int d = 0; d < box_.n_dimensions; ++d)
      for (const int lower : {1, 0}) {
        Triple face = cell;
        face[d] -= lower;
        const std::vector<double> share = shares(face, d);
        for (std::size_t s = 0; s < share.size(); ++s) has[s] = has[s] || share[s] > 0;
      }
    const double level = box_.normal[0] * x + box_.normal[1] * y + box_.normal[2] * z;
    const int centre =
        static_cast<int>(std::lower_bound(box_.offset.begin(), box_.offset.end(), level) - box_.offset.begin());
    std::vector<int> sides{centre};
    for (int s = 0; s < n_sides(); ++s)
      if (has[static_cast<std::size_t>(s)] && s != centre) sides.push_back(s);
    return sides;
  }
  struct Connection {
    GridUnknown a, b;
    double conductance, share;  // share: of a full face
    int direction;              // -1: inside the cell
  };
  /// Across the face at the upper side of a cell, and (where asked) inside it. The upper cell is not wrapped.
  std::vector<Connection> connections(const Triple& cell, int d) const {
    Triple upper = cell;
    ++upper[d];
    const bool has_lower = is_inside(cell), has_upper = is_inside(upper);
    std::vector<Connection> all;
    if (!has_lower && !has_upper) return all;
    if (!has_lower && !box_.border_is_open[d][0]) return all;
    if (!has_upper && !box_.border_is_open[d][1]) return all;
    const Triple at = wrapped(has_lower ? cell : upper), after = wrapped(upper);
    double distance = 0.5 * grid_.axis[d].width(at[d]);
    if (has_lower && has_upper) distance += 0.5 * grid_.axis[d].width(after[d]);
    const double area = grid_.volume(at) / grid_.axis[d].width(at[d]);
    const std::vector<int> below = has_lower ? sides(cell) : std::vector<int>{-1};
    const std::vector<int> above = has_upper ? sides(upper) : std::vector<int>{-1};
    std::map<std::pair<int, int>, double> sums;
    const std::vector<double> share = shares(cell, d);
    for (int s = 0; s < n_sides(); ++s)
      if (share[static_cast<std::size_t>(s)] > 0)
        sums[{number_of(below, s), number_of(above, s)}] += share[static_cast<std::size_t>(s)];
    for (const auto& [numbers, part] : sums)
      all.push_back({{cell, numbers.first}, {upper, numbers.second}, part * area / distance, part, d});
    return all;
  }
  std::vector<Connection> inner_connections(const Triple& cell) const {
    std::vector<Connection> all;
    const int n = static_cast<int>(sides(cell).size());
    if (box_.edge_conductance > 0)
      for (int p = 1; p < n; ++p)
        all.push_back({{cell, p - 1}, {cell, p}, box_.edge_conductance * grid_.axis[0].width(wrapped(cell)[0]), 0, -1});
    return all;
  }

 private:
  static int number_of(const std::vector<int>& sides, int side) {
    if (sides.front() < 0) return 0;
    return static_cast<int>(std::find(sides.begin(), sides.end(), side) - sides.begin());
  }
  /// The side on which a box lies as a whole, else -1.
  int side_of(const std::array<std::array<double, 2>, 3>& corner) const {
    double least = 0, most = 0;
    for (int e = 0; e < 3; ++e) {
      const double a = box_.normal[e] * corner[e][0], b = box_.normal[e] * corner[e][1];
      least += std::min(a, b), most += std::max(a, b);
    }
    const auto below = [&](double level) {
      return static_cast<int>(std::lower_bound(box_.offset.begin(), box_.offset.end(), level) - box_.offset.begin());
    };
    return below(least) == below(most) && !(below(least) < n_sides() - 1 && box_.offset[below(least)] == most)
               ? below(least)
               : -1;
  }
  /// Share of the rectangle where normal * x < offset, by clipping.
  double share_below(const std::array<std::array<double, 2>, 3>& corner, int d, double offset) const {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    const double fixed = offset - box_.normal[d] * corner[d][0];
    std::vector<std::array<double, 2>> rectangle{{corner[e][0], corner[f][0]},
                                                 {corner[e][1], corner[f][0]},
                                                 {corner[e][1], corner[f][1]},
                                                 {corner[e][0], corner[f][1]}};
    std::vector<std::array<double, 2>> kept;
    const auto level = [&](const std::array<double, 2>& p) {
      return box_.normal[e] * p[0] + box_.normal[f] * p[1] - fixed;
    };
    for (std::size_t v = 0; v < 4; ++v) {
      const auto &p = rectangle[v], &q = rectangle[(v + 1) % 4];
      const double at_p = level(p), at_q = level(q);
      if (at_p < 0) kept.push_back(p);
      if ((at_p < 0) != (at_q < 0)) {
        const double t = at_p / (at_p - at_q);
        kept.push_back({p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])});
      }
    }
    double twice = 0;
    for (std::size_t v = 1; v + 1 < kept.size(); ++v)
      twice += (kept[v][0] - kept[0][0]) * (kept[v + 1][1] - kept[0][1]) -
               (kept[v + 1][0] - kept[0][0]) * (kept[v][1] - kept[0][1]);
    return std::clamp(0.5 * std::abs(twice) / ((corner[e][1] - corner[e][0]) * (corner[f][1] - corner[f][0])), 0.0,
                      1.0);
  }

  SplitBox box_;
  StretchedGrid grid_;
  Triple n_;
};

/// The sheets of a box on one block.
struct SplitBlock {
  FaceFractions share;
  SplitCells split;
  std::vector<GridUnknown> name;  // (n_pieces) cell wrapped
};

inline SplitBlock split_block(const SheetGeometry& geometry, const SplitBox& box, const Box& mine) {
  SplitBlock block;
  const Triple layer{1, 1, box.n_dimensions == 3}, sizes = mine.sizes();
  const Box around = box_of(sizes).grown(layer);
  std::map<GridUnknown, int> piece;  // local cells
  const auto global = [&](Triple cell) {
    for (int d = 0; d < 3; ++d) cell[d] += mine.begin[d];
    return cell;
  };
  for (int k = around.begin[2]; k < around.end[2]; ++k)
    for (int j = around.begin[1]; j < around.end[1]; ++j)
      for (int i = around.begin[0]; i < around.end[0]; ++i) {
        const Triple cell{i, j, k};
        if (!geometry.is_inside(global(cell))) continue;
        const int n = static_cast<int>(geometry.sides(global(cell)).size());
        for (int p = 1; p < n; ++p) {
          piece[{cell, p}] = static_cast<int>(block.split.cell.size());
          block.split.cell.push_back(cell);
          block.name.push_back({geometry.wrapped(global(cell)), p});
        }
      }
  const auto unknown = [&](GridUnknown u) {
    for (int d = 0; d < 3; ++d) u.cell[d] -= mine.begin[d];
    return PressureUnknown{u.cell, u.number == 0 ? -1 : piece.at(u)};
  };
  const auto add = [&](const SheetGeometry::Connection& one) {
    const PressureUnknown a = unknown(one.a), b = unknown(one.b);
    if (a.piece < 0 && b.piece < 0)
      block.share[one.direction](a.cell[0], a.cell[1], a.cell[2]) = static_cast<float>(one.share);
    else if (box_of(sizes).contains(a.cell) || box_of(sizes).contains(b.cell))
      block.split.links.push_back({a, b, one.conductance});
  };
  for (int d = 0; d < 3; ++d) block.share[d] = Field<float>(sizes, layer);
  for (int k = around.begin[2]; k < around.end[2]; ++k)
    for (int j = around.begin[1]; j < around.end[1]; ++j)
      for (int i = around.begin[0]; i < around.end[0]; ++i) {
        const Triple cell = global({i, j, k});
        if (box_of(sizes).contains({i, j, k}))
          for (const auto& one : geometry.inner_connections(cell)) add(one);
        for (int d = 0; d < box.n_dimensions; ++d) {
          Triple upper{i, j, k};
          ++upper[d];
          bool is_beside = true;  // of the grid in the other directions
          for (int e = 0; e < 3; ++e)
            if (e != d && !box.is_periodic[e] && (cell[e] < 0 || cell[e] >= geometry.grid().n_cells()[e]))
              is_beside = false;
          if (!is_beside || !around.contains(upper)) continue;
          for (const auto& one : geometry.connections(cell, d)) add(one);
        }
      }
  return block;
}

}  // namespace couplet::flow
