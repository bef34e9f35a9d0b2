#include "flow-server/immersed/cut_cells.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "flow-server/immersed/body_shape.hpp"
#include "tests/unit/flow-server/immersed/surface_of.hpp"
#include "tests/unit/flow-server/immersed/test_surfaces.hpp"

namespace couplet::flow {
namespace {

class CutGrid {
 public:
  CutGrid(const StretchedGrid& grid, const Box& mine, int layers, std::vector<BodySurface> surfaces)
      : grid_(grid), crossings_(grid_, mine, layers), cut_(grid_, crossings_), surfaces_(std::move(surfaces)) {
    update();
  }
  void update() {
    crossings_.update(surfaces_);
    cut_.update(surfaces_);
  }
  const CutCells& cut() const { return cut_; }
  const EdgeCrossings& crossings() const { return crossings_; }
  std::vector<BodySurface>& surfaces() { return surfaces_; }
  double face_area(int d) const {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    return grid_.axis[static_cast<std::size_t>(e)].width(0) * grid_.axis[static_cast<std::size_t>(f)].width(0);
  }

 private:
  StretchedGrid grid_;
  EdgeCrossings crossings_;
  CutCells cut_;
  std::vector<BodySurface> surfaces_;
};

/// Of each part: sum of the outward areas of its face pieces and its walls. In two dimensions the ends along z are left
/// out, which cancel.
std::vector<Eigen::Vector3d> open_rims(const CutGrid& grid) {
  const CutCells& cut = grid.cut();
  std::vector<Eigen::Vector3d> sum(cut.parts().size(), Eigen::Vector3d::Zero());
  for (const CutFace& face : cut.faces())
    for (int p = face.first_piece; p < face.first_piece + face.n_pieces; ++p) {
      const FacePiece& piece = cut.pieces()[static_cast<std::size_t>(p)];
      const double area = piece.share * grid.face_area(face.direction);
      if (piece.lower_part >= 0) sum[static_cast<std::size_t>(piece.lower_part)][face.direction] += area;
      if (piece.upper_part >= 0) sum[static_cast<std::size_t>(piece.upper_part)][face.direction] -= area;
    }
  for (const WallTriangle& wall : cut.walls()) {
    sum[static_cast<std::size_t>(wall.outer_part)] -= wall.area;
    sum[static_cast<std::size_t>(wall.inner_part)] += wall.area;
  }
  return sum;
}

void expect_closed_parts(const CutGrid& grid) {
  ASSERT_FALSE(grid.cut().cells().empty());
  for (const Eigen::Vector3d& rim : open_rims(grid)) EXPECT_LT(rim.norm(), 1e-14 * 10);  // round-off of areas below 1
  EXPECT_EQ(grid.cut().n_lone_crossings(), 0);
}

double wall_area(const CutCells& cut) {
  double area = 0;
  for (const WallTriangle& wall : cut.walls()) area += wall.area.norm();
  return area;
}

/// Volume inside, by the divergence theorem over the walls.
double wall_volume(const CutCells& cut) {
  double volume = 0;
  for (const WallTriangle& wall : cut.walls()) volume += wall.centroid.dot(wall.area) / 3;
  return volume;
}

/// A box, turned about all axes by an angle [rad].
BodySurface turned_box(const Point& middle, const Point& half_sides, double angle) {
  BodySurface box = surface_of(make_box({-half_sides[0], -half_sides[1], -half_sides[2]}, half_sides, 0.21), true);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(angle, Eigen::Vector3d(0.3, 0.5, 0.81).normalized()).toRotationMatrix();
  for (Point& at : box.position) {
    const Eigen::Vector3d turned = turn * Eigen::Vector3d(at[0], at[1], at[2]);
    for (std::size_t d = 0; d < 3; ++d) at[d] = middle[d] + turned[static_cast<Eigen::Index>(d)];
  }
  box.sharp_edge = find_sharp_edges(box.position, box.triangle);
  return box;
}

TEST(CutCells, SharpEdgesOfABoxAreKept) {
  // What is missing of its volume are the corners, in eight cells, and cells that an edge passes by without a bend:
  // with chords alone 0.5 % of it are cut off at the edges with 24 cells.
  const Point half{0.23, 0.31, 0.28};
  const double volume = 8 * half[0] * half[1] * half[2];
  for (const double angle : {0.0, 0.4, 1.1}) {
    double error[2];
    for (int level = 0; level < 2; ++level) {
      const int n = 12 << level;
      const CutGrid grid(uniform_box({n, n, n}, 1.0 / n), box_of({n, n, n}), 0,
                         {turned_box({0.513, 0.487, 0.501}, half, angle)});
      expect_closed_parts(grid);
      error[level] = std::abs(wall_volume(grid.cut()) / volume - 1);
    }
    EXPECT_LT(error[1], 0.002) << angle;
    EXPECT_GT(std::log2(error[0] / error[1]), 1.7) << angle;
  }
}

TEST(CutCells, TheEndOfAThinBodyPassesAFaceWithoutAJump) {
  // In two dimensions, 1.3 cells thick: where its end stands next to a face of the grid, before or behind it, the open
  // shares of faces and the areas of walls change by as much as it moves and no more.
  const double h = 0.1, step = 1e-7;
  const auto cut_at = [&](double end) {
    return CutGrid(uniform_box({10, 10, 1}, h, 2), box_of({10, 10, 1}), 0,
                   {turned_box({end - 0.2, 0.4871, 0.05}, {0.2, 0.65 * h, 0.2}, 0)});
  };
  const auto wall_end = [](const CutGrid& grid) {
    double sum = 0;  // across x: that of both ends
    for (const WallTriangle& wall : grid.cut().walls()) sum += std::abs(wall.area[0]);
    return sum;
  };
  const auto wall_volume_of = [](const CutGrid& grid) {
    double volume = 0;  // between both ends along z, where walls face neither
    for (const WallTriangle& wall : grid.cut().walls())
      volume += 0.5 * (wall.centroid[0] * wall.area[0] + wall.centroid[1] * wall.area[1]);
    return volume;
  };
  const double end_area = 2 * 1.3 * h * h, volume = 0.4 * 1.3 * h * h;
  for (const double end : {0.7 - step, 0.7 + step, 0.7 - 0.4 * h, 0.7 - 0.01 * h}) {
    const CutGrid grid = cut_at(end);
    expect_closed_parts(grid);
    EXPECT_NEAR(wall_end(grid), end_area, 1e-8 * end_area) << end;
    EXPECT_NEAR(wall_volume_of(grid), volume, 1e-7 * volume) << end;
  }
}

TEST(CutCells, PartsOfASphereAreClosedAndItsAreaAndVolumeConvergeWithSecondOrder) {
  double area_error[2], volume_error[2];
  for (int level = 0; level < 2; ++level) {
    const int n = 16 << level;
    const CutGrid grid(uniform_box({n, n, n}, 1.0 / n), box_of({n, n, n}), 0,
                       {sphere_surface({0.513, 0.487, 0.501}, 0.3, 6)});
    expect_closed_parts(grid);
    area_error[level] = std::abs(wall_area(grid.cut()) / (4 * std::numbers::pi * 0.09) - 1);
    volume_error[level] = std::abs(wall_volume(grid.cut()) / (4.0 / 3 * std::numbers::pi * 0.027) - 1);
  }
  // Flat pieces in cells of width h are off by about (h / R)^2 / 4 in area, twice that in volume: 1.1 and 2.2 %. On
  // half the width it is four times less, but for the place of the sphere in the cells.
  EXPECT_LT(area_error[0], 0.015);
  EXPECT_LT(volume_error[0], 0.03);
  EXPECT_NEAR(area_error[0] / area_error[1], 4, 0.8);
  EXPECT_NEAR(volume_error[0] / volume_error[1], 4, 0.8);
}

TEST(CutCells, InsideOfASphereIsSolid) {
  const int n = 16;
  const Point centre{0.513, 0.487, 0.501};
  const CutGrid grid(uniform_box({n, n, n}, 1.0 / n), box_of({n, n, n}), 0, {sphere_surface(centre, 0.3, 5)});
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        for (int d = 0; d < 3; ++d) {
          Point middle{(i + 0.5) / n, (j + 0.5) / n, (k + 0.5) / n};
          middle[static_cast<std::size_t>(d)] += 0.5 / n;
          double square = 0;
          for (std::size_t e = 0; e < 3; ++e) square += std::pow(middle[e] - centre[e], 2);
          // Flat pieces stand at most h^2 / (8 R) inside the sphere's surface, a cell being 0.0625 wide.
          const double distance = std::sqrt(square) - 0.3;
          if (std::abs(distance) < 0.006) continue;
          EXPECT_EQ(grid.cut().is_face_solid(d, {i, j, k}), distance < 0) << i << " " << j << " " << k << " " << d;
        }
}

TEST(CutCells, AnObliquePlaneHasItsExactAreaAndCutsCellsInTwo) {
  const int n = 10;
  // x + y/2 + z/3 = 1, beyond the box on all sides; its area inside the unit box is that of y, z in [0, 1] where x
  // stays in [0, 1] as well: x = 1 - y/2 - z/3 >= 1/6, so all of it: sqrt(1 + 1/4 + 1/9).
  const CutGrid grid(uniform_box({n, n, n}, 1.0 / n), box_of({n, n, n}), 0,
                     {flat_sheet({2.5, -1, -3}, {-1.5, 3, 0}, {-2, 0, 6}, 7)});
  expect_closed_parts(grid);
  EXPECT_NEAR(wall_area(grid.cut()), std::sqrt(1 + 1.0 / 4 + 1.0 / 9), 1e-12);
  for (const CutCell& cut : grid.cut().cells()) EXPECT_EQ(cut.n_parts, 2);
}

TEST(CutCells, ASheetThatLiesInFacesOfCellsIsNoSpecialCase) {
  const int n = 8;
  for (int d = 0; d < 3; ++d) {
    Point corner{-1, -1, -1}, a{0, 0, 0}, b{0, 0, 0};
    corner[static_cast<std::size_t>(d)] = 0.5;
    a[static_cast<std::size_t>((d + 1) % 3)] = 3, b[static_cast<std::size_t>((d + 2) % 3)] = 3;
    const CutGrid grid(uniform_box({n, n, n}, 1.0 / n), box_of({n, n, n}), 0, {flat_sheet(corner, a, b, 24)});
    expect_closed_parts(grid);
    EXPECT_NEAR(wall_area(grid.cut()), 1, 1e-8);  // the surface stands off by 1e-9 of a cell
  }
  // Along the diagonal through corners of cells as well.
  const CutGrid grid(uniform_box({n, n, n}, 1.0 / n), box_of({n, n, n}), 0,
                     {flat_sheet({2, -1, -1}, {-3, 3, 0}, {0, 0, 3}, 24)});
  expect_closed_parts(grid);
  EXPECT_NEAR(wall_area(grid.cut()), std::numbers::sqrt2, 1e-8);
}

TEST(CutCells, TwoSheetsInOneLayerOfCellsLeaveThreeParts) {
  const int n = 6;
  const CutGrid grid(
      uniform_box({n, n, n}, 1.0 / n), box_of({n, n, n}), 0,
      {flat_sheet({0.55, -1, -1}, {0, 3, 0}, {0, 0, 3}, 5), flat_sheet({0.62, -1, -1}, {0, 3, 0}, {0, 0, 3}, 5)});
  expect_closed_parts(grid);
  EXPECT_EQ(grid.cut().cells().size(), 36u);
  for (const CutCell& cut : grid.cut().cells()) EXPECT_EQ(cut.n_parts, 3);
  EXPECT_EQ(grid.cut().further_parts().size(), 72u);
}

TEST(CutCells, AFreeEdgeInsideACellPartsNothingThere) {
  const int n = 6;
  // Half a sheet: it ends at y = 0.43, inside the cells with j = 2.
  const CutGrid grid(uniform_box({n, n, n}, 1.0 / n), box_of({n, n, n}), 0,
                     {flat_sheet({0.55, -1, -1}, {0, 1.43, 0}, {0, 0, 3}, 9)});
  EXPECT_GT(grid.cut().n_lone_crossings(), 0);
  for (const CutCell& cut : grid.cut().cells()) EXPECT_EQ(cut.n_parts, cut.cell[1] < 2 ? 2 : 1);
}

TEST(CutCells, ACylinderInTwoDimensionsIsSeenAlikeByAllRanks) {
  const int n = 24;
  StretchedGrid grid = uniform_box({n, n, 1}, 1.0 / n, 2);
  grid.axis[2] = StretchedAxis({0, 0.4}, false);
  const BodySurface cylinder = cylinder_surface({0.5, 0.52, 0}, 0.27, 200, 0.4);
  const CutGrid whole(grid, box_of({n, n, 1}), 0, {cylinder});
  EXPECT_NEAR(wall_area(whole.cut()), 2 * std::numbers::pi * 0.27 * 0.4, 2e-3);
  expect_closed_parts(whole);
  const Box right{{11, 0, 0}, {24, 24, 1}};
  const CutGrid part(grid, right, 3, {cylinder});
  int n_seen = 0;
  for (const CutCell& cut : part.cut().cells()) {
    const int index = whole.cut().find({cut.cell[0] + 11, cut.cell[1], cut.cell[2]});
    ASSERT_GE(index, 0);
    const CutCell& same = whole.cut().cells()[static_cast<std::size_t>(index)];
    ASSERT_EQ(cut.n_parts, same.n_parts);
    for (int p = 0; p < cut.n_parts; ++p)
      EXPECT_EQ(part.cut().parts()[static_cast<std::size_t>(cut.first_part + p)].is_fluid,
                whole.cut().parts()[static_cast<std::size_t>(same.first_part + p)].is_fluid);
    ++n_seen;
  }
  EXPECT_GT(n_seen, 30);
}

double fluid_in_cut_cells(const CutGrid& grid) {
  double volume = 0;
  for (const CutCell& cell : grid.cut().cells()) volume += grid.cut().fluid_volume(cell);
  return volume;
}

TEST(CutCells, VolumesOfFluidConvergeWithTheSquareOfTheWidth) {
  std::array<double, 2> error{}, flat_error{};
  for (std::size_t level = 0; level < 2; ++level) {
    const int n = level == 0 ? 16 : 32;
    const double width = 1.0 / n, radius = 0.31;
    const auto missing = [&](const CutGrid& grid, const StretchedGrid& box, double cell_volume) {
      const ActiveCells whole = grid.cut().whole(ActiveCells::all(box_of(box.n_cells())));
      return 1 - static_cast<double>(whole.n_cells()) * cell_volume - fluid_in_cut_cells(grid);
    };
    const StretchedGrid box = uniform_box({n, n, n}, width);
    const CutGrid ball(box, box_of({n, n, n}), 0, {sphere_surface({0.5, 0.47, 0.52}, radius, 6)});
    error[level] = missing(ball, box, width * width * width) / (4 * std::numbers::pi / 3 * std::pow(radius, 3)) - 1;
    StretchedGrid plane = uniform_box({n, n, 1}, width, 2);
    plane.axis[2] = StretchedAxis({0, 1}, false);
    const CutGrid disc(plane, box_of({n, n, 1}), 0, {cylinder_surface({0.5, 0.52, 0}, radius, 2000, 1)});
    flat_error[level] = missing(disc, plane, width * width) / (std::numbers::pi * radius * radius) - 1;
  }
  // Chords lie inside: of (width / radius)^2 = 0.04 a part, which falls by 4.
  EXPECT_LT(std::abs(error[0]), 0.03);
  EXPECT_NEAR(error[0] / error[1], 4, 1);
  EXPECT_LT(std::abs(flat_error[0]), 0.01);
  EXPECT_NEAR(flat_error[0] / flat_error[1], 4, 1);
}

TEST(CutCells, ASheetTakesNoVolume) {
  const int n = 8;
  const StretchedGrid box = uniform_box({n, n, n}, 1.0 / n);
  const CutGrid grid(box, box_of({n, n, n}), 0, {flat_sheet({0.2, -0.5, -0.5}, {0.6, 2, 0}, {0.1, 0, 2}, 10)});
  const double volume = static_cast<double>(grid.cut().cells().size()) / (n * n * n);
  EXPECT_NEAR(fluid_in_cut_cells(grid), volume, 1e-13);  // both sides are fluid
}

/// The largest gap in the rim of a part with fluid.
double largest_open_rim(const CutGrid& grid) {
  const std::vector<Eigen::Vector3d> rims = open_rims(grid);
  double largest = 0;
  for (std::size_t part = 0; part < rims.size(); ++part)
    if (grid.cut().parts()[part].is_fluid) largest = std::max(largest, rims[part].norm());
  return largest;
}

TEST(CutCells, WallsOfBodiesThatStandInEachOtherCloseTheFluidBesideThem) {
  const int n = 24;
  const double h = 1.0 / n;
  for (const double shift : {0.0, 0.1, 0.23, 0.37, 0.51, 0.68, 0.82, 0.94}) {
    // A four-sided rod, turned by some angle, that sticks out of a cylinder.
    BodySurface rod = cylinder_surface({0.5 + shift * h, 0.5 + 0.7 * shift * h, 0}, 0.35, 4, h);
    for (Point& p : rod.position) p[1] = 0.5 + 0.2 * (p[1] - 0.5) + 0.3 * (p[0] - 0.5);
    const CutGrid flat(uniform_box({n, n, 1}, h, 2), box_of({n, n, 1}), 0,
                       {cylinder_surface({0.5, 0.5, 0}, 0.2, 90, h), rod});
    EXPECT_LT(largest_open_rim(flat), 1e-14) << shift;  // round-off of areas of h^2
    const CutGrid spheres(uniform_box({n, n, n}, h), box_of({n, n, n}), 0,
                          {sphere_surface({0.41, 0.48 + shift * h, 0.5}, 0.23, 5),
                           sphere_surface({0.64, 0.53, 0.47 + shift * h}, 0.18, 5)});
    EXPECT_LT(largest_open_rim(spheres), 1e-14) << shift;
  }
}

TEST(CutCells, ASheetThatStandsInABodyDoesNotOpenTowardsIt) {
  const int n = 8;
  const StretchedGrid box = uniform_box({n, n, n}, 1.0 / n);
  BodySurface open = flat_sheet({0.2, -0.5, -0.5}, {0.6, 2, 0}, {0.1, 0, 2}, 10);
  open.opening.assign(open.position.size(), 1.0);
  const CutGrid grid(box, box_of({n, n, n}), 0, {sphere_surface({0.5, 0.47, 0.52}, 0.31, 5), open});
  const auto is_fluid = [&](int part) {
    return part < 0 || grid.cut().parts()[static_cast<std::size_t>(part)].is_fluid;
  };
  int n_open = 0, n_beside_body = 0;
  for (const WallTriangle& wall : grid.cut().walls()) {
    if (wall.surface == 0) continue;
    const bool is_between_fluid = is_fluid(wall.outer_part) && is_fluid(wall.inner_part);
    EXPECT_NEAR(wall.opening, is_between_fluid ? 1 : 0, 1e-12);  // round-off of a mean of ones
    is_between_fluid ? ++n_open : ++n_beside_body;
  }
  EXPECT_GT(n_open, 0);
  EXPECT_GT(n_beside_body, 0);
  int n_open_pieces = 0;
  for (const FacePiece& piece : grid.cut().pieces()) {
    if (!is_fluid(piece.lower_part) || !is_fluid(piece.upper_part)) {
      EXPECT_EQ(piece.opening, 0);
    }
    if (piece.opening > 0) ++n_open_pieces;
  }
  EXPECT_GT(n_open_pieces, 0);
}

}  // namespace
}  // namespace couplet::flow
