// Where the slopes come from that walls impose. Started on 2 ranks.

#include "flow-server/immersed/wall_forcing.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "flow-server/immersed/immersed_bodies.hpp"
#include "tests/unit/flow-server/immersed/placed_bodies.hpp"
#include "tests/unit/flow-server/immersed/test_surfaces.hpp"

namespace couplet::flow {
namespace {

constexpr int n = 10;
constexpr double h = 1.0 / n;

/// A sheet through the plane z = 0 from `from` to `to`.
BodySurface sheet_between(const Point& from, const Point& to) {
  return flat_sheet({from[0], from[1], -h}, {to[0] - from[0], to[1] - from[1], 0}, {0, 0, 3 * h}, 5);
}

/// Divergence of the forced velocity in the cells of this rank, by their index in the whole.
std::map<std::array<int, 2>, double> forced_divergence(const BodySurface& sheet, MPI_Comm communicator,
                                                       const Triple& shape) {
  PlacedBodies placed(uniform_box({2 * n, n, 1}, h, 2), {sheet}, communicator, shape);
  // From face to face as different as can be: so a slope taken elsewhere shows.
  const auto rough = [](const Point& p) { return std::sin(37 * p[0] / h) + std::cos(53 * p[1] / h); };
  placed.set_velocity([&](const Point& p, int) { return rough(p); });
  placed.set_pressure(rough);
  ImmersedBodies bodies(placed.block, BodyFlowSettings{});
  bodies.forcing().force(*placed.bodies, *placed.bodies, placed.pressure, placed.fill_from_neighbours(),
                         placed.velocity);
  bodies.forcing().take_slopes_of(*placed.bodies, h, placed.pressure, placed.velocity);
  std::vector<Field<double>*> fields;
  for (int d = 0; d < 2; ++d) fields.push_back(&placed.velocity[d]);
  placed.halo.exchange(fields, 1);
  Field<double> source = placed.block.new_field();
  std::vector<double> piece_source;
  bodies.take_divergence(*placed.bodies, h, placed.velocity, bodies.forcing().piece_velocity(), source, piece_source);
  std::map<std::array<int, 2>, double> divergence;
  const Triple& start = placed.blocks.mine().begin;
  for (const CutCell& cut : placed.bodies->cut().cells()) {
    const auto& [i, j, k] = cut.cell;
    if (box_of(placed.block.sizes).contains(cut.cell)) divergence[{start[0] + i, start[1] + j}] = source(i, j, k);
  }
  return divergence;
}

TEST(WallForcing, SlopesOfImagesAreTheSameOnAnyNumberOfRanks) {
  // Short sheets across the border between both ranks, at many places and angles.
  int n_cells = 0;
  for (int n_th = 0; n_th < 400; ++n_th) {
    const double angle = 2 * std::numbers::pi * std::fmod(0.618 * n_th, 1.0);
    const Point middle{1 + 0.2 * std::fmod(0.755 * n_th, 1.0), 0.1 + 0.8 * std::fmod(0.57 * n_th, 1.0), 0};
    const double half = 0.2 + 0.4 * std::fmod(0.413 * n_th, 1.0);
    const Point along{half * std::cos(angle), half * std::sin(angle), 0};
    const BodySurface sheet =
        sheet_between({middle[0] - along[0], middle[1] - along[1], 0}, {middle[0] + along[0], middle[1] + along[1], 0});
    const auto alone = forced_divergence(sheet, MPI_COMM_SELF, {1, 1, 1});
    for (const auto& [cell, divergence] : forced_divergence(sheet, MPI_COMM_WORLD, {2, 1, 1})) {
      EXPECT_NEAR(divergence, alone.at(cell), 1e-12) <<  // sums of numbers of order 1
          n_th << " " << cell[0] << " " << cell[1];
      ++n_cells;
    }
  }
  EXPECT_GT(n_cells, 400);
}

TEST(WallForcing, KeepsToThePressureThatIsKnown) {
  // The image of a ghost of this sheet, found among thousands, stands in the last layer of faces; there is no cell
  // behind it: with the sanitize preset this test stops at what is read there.
  PlacedBodies placed(uniform_box({n, n, 1}, h, 2, true), {sheet_between({0.1154, 1.2507, 0}, {1.3320, 0.9157, 0})});
  const auto& images = placed.bodies->layer().image_faces(1);
  ASSERT_TRUE(std::any_of(images.begin(), images.end(), [](const Triple& face) { return face[1] == n + 3; }));
  placed.set_velocity([](const Point&, int) { return 0.0; });
  WallForcing forcing(placed.block);
  forcing.force(*placed.bodies, *placed.bodies, placed.pressure, placed.fill_from_neighbours(), placed.velocity);
  forcing.take_slopes_of(*placed.bodies, h, placed.pressure, placed.velocity);
  ASSERT_FALSE(forcing.piece_velocity().empty());
  for (const double velocity : forcing.piece_velocity()) EXPECT_EQ(velocity, 0);  // all is at rest without pressure
}

}  // namespace
}  // namespace couplet::flow
