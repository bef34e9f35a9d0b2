// The same numbers on any number of ranks, from any state twice, and with the memory of a state that was stored.

#include <gtest/gtest.h>

#include <cstring>

#include "tests/verification/moving_bodies.hpp"

namespace couplet::flow {
namespace {

const double pi = std::numbers::pi;

struct FlowRun {
  FlowRun(const NavierStokesSetup& setup, MPI_Comm communicator, const Triple& shape, int n_steps, double step)
      : blocks(decompose(setup.grid, shape, communicator)), flow(setup, blocks) {
    state = flow.initial_state();
    FlowState next;
    for (int n = 0; n < n_steps; ++n) {
      report = flow.advance(state, step, next);
      std::swap(state, next);
    }
  }
  BlockDecomposition blocks;
  FractionalStep flow;
  FlowState state;
  AdvanceReport report;
};

/// Every kind of border at once, sizes that no number of parts divides, strong stretching.
NavierStokesSetup everything(TimeScheme scheme, int n_dimensions) {
  const auto x = symmetrically_stretched_faces(0, 2, 22, 4), y = symmetrically_stretched_faces(0, 1, 19, 3);
  const auto z = n_dimensions == 3 ? uniform_faces(0, 1, 22) : uniform_faces(0, 1, 1);
  NavierStokesSetup setup = setup_on(box_grid({x, y, z}, {false, false, n_dimensions == 3}, n_dimensions), scheme);
  setup.viscosity = 0.01;
  setup.pressure.relative_tolerance = 1e-12;
  setup.pressure.divergence_tolerance = 1e-15;
  PrescribedVelocity inlet;
  inlet.velocity[0] =
      SpaceTimeValue([](const Point& p, double t) { return p[1] * (1 - p[1]) * (4 + std::sin(9 * t)); });
  setup.border[0][0] = {FacePatch{.name = "inlet", .condition = inlet}};
  setup.border[0][1] = {FacePatch{.name = "outflow", .condition = ConvectiveOutflow{}}};
  PrescribedVelocity lid;
  lid.velocity[0] = 1.0;
  lid.velocity[2] = 0.3;
  setup.border[1][0] = {FacePatch{.name = "lid", .condition = lid}};
  setup.border[1][1] = {FacePatch{.name = "symmetry", .condition = SlipWall{}}};
  for (int c = 0; c < n_dimensions; ++c)
    setup.initial_velocity[c] = SpaceTimeValue([c](const Point& p, double) {
      return 0.5 + 0.3 * std::sin(3 * p[0] + c) * std::cos(4 * p[1] - c) * std::cos(2 * pi * p[2]);
    });
  setup.body_force[1] = SpaceTimeValue([](const Point& p, double t) { return std::sin(p[0]) * std::cos(t); });
  return setup;
}

/// Openings in part of a border, driven to and fro, and an obstacle.
NavierStokesSetup openings(TimeScheme scheme, int n_dimensions) {
  NavierStokesSetup setup = everything(scheme, n_dimensions);
  const auto pressure = [](double amplitude) {
    return PressureOpening{
        SpaceTimeValue([amplitude](const Point&, double t) { return amplitude * std::cos(40 * t); })};
  };
  setup.border[0][0] = {FacePatch{.name = "in", .from = {0, 0.2, -1}, .to = {0, 0.9, 2}, .condition = pressure(2)}};
  setup.border[0][1] = {FacePatch{.name = "out", .condition = pressure(-1)}};
  setup.border[1][0] = {FacePatch{.name = "side", .from = {0.5, 0, -1}, .to = {1.2, 0, 2}, .condition = pressure(0)}};
  setup.is_fluid = [](const Point& p) { return std::hypot(p[0] - 1, p[1] - 0.6) > 0.15; };
  return setup;
}

/// Cylinders that slide along two borders, gaps of about a cell between them. Between two of them, at a border, images
/// stand between faces inside the grid and ones beyond it.
NavierStokesSetup sliding_bodies(TimeScheme scheme, int n_dimensions) {
  NavierStokesSetup setup = everything(scheme, n_dimensions);
  const bool is_spatial = n_dimensions == 3;
  setup.grid = box_grid({uniform_faces(0, 2, 33), uniform_faces(0, 1, 17), uniform_faces(0, 1, is_spatial ? 17 : 1)},
                        {false, false, false}, n_dimensions);
  if (is_spatial) setup.border[2][0] = setup.border[2][1] = {FacePatch{.name = "side", .condition = SlipWall{}}};
  setup.bodies = [](double t) {
    std::vector<BodySurface> bodies;
    for (const auto& [x, y, radius] : std::array<std::array<double, 3>, 4>{
             {{0.8, 0.9, 0.22}, {1.29, 0.92, 0.2}, {1.05, 0.52, 0.2}, {1.1, 0.08, 0.2}}}) {
      bodies.push_back(circle({x + 0.4 * t, y}, radius, 60, 2, [](double, double) { return std::array{0.4, 0.0}; }));
      for (Point& corner : bodies.back().position) corner[2] -= 0.5;
    }
    return bodies;
  };
  return setup;
}

enum class Case { borders, openings, bodies };

NavierStokesSetup setup_of(Case which, TimeScheme scheme, int n_dimensions) {
  switch (which) {
    case Case::borders:
      return everything(scheme, n_dimensions);
    case Case::openings:
      return openings(scheme, n_dimensions);
    default:
      return sliding_bodies(scheme, n_dimensions);
  }
}

/// Of four ranks one may be left without cells.
std::vector<Triple> shapes_of(int n_ranks, int n_dimensions) {
  switch (n_ranks) {
    case 1:
      return {{1, 1, 1}};
    case 2:
      return {{2, 1, 1}, {1, 2, 1}};
    case 4:
      return n_dimensions == 3 ? std::vector<Triple>{{1, 2, 2}, {3, 1, 1}} : std::vector<Triple>{{2, 2, 1}, {3, 1, 1}};
    default:
      return n_dimensions == 3 ? std::vector<Triple>{{1, 2, 4}} : std::vector<Triple>{{2, 4, 1}};
  }
}

class FlowOnRanks : public testing::TestWithParam<std::tuple<TimeScheme, int, Case>> {};

TEST_P(FlowOnRanks, GivesTheNumbersOfOneRank) {
  const auto [scheme, n_dimensions, which] = GetParam();
  const NavierStokesSetup setup = setup_of(which, scheme, n_dimensions);
  int n_ranks = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &n_ranks);
  const int n_steps = 3;
  const double step = 0.01;
  const FlowRun alone(setup, MPI_COMM_SELF, {1, 1, 1}, n_steps, step);
  for (const Triple& shape : shapes_of(n_ranks, n_dimensions)) {
    const FlowRun together(setup, MPI_COMM_WORLD, shape, n_steps, step);
    const Box mine = together.blocks.mine();
    double largest_pressure = 0;
    for (std::size_t i = 0; i < alone.state.pressure.n_values(); ++i)
      largest_pressure = std::max(largest_pressure, std::abs(alone.state.pressure.data()[i]));
    double velocity = 0, pressure = 0;
    for (int k = 0; k < mine.size(2); ++k)
      for (int j = 0; j < mine.size(1); ++j)
        for (int i = 0; i < mine.size(0); ++i) {
          const int x = mine.begin[0] + i, y = mine.begin[1] + j, z = mine.begin[2] + k;
          for (int c = 0; c < n_dimensions; ++c)
            velocity =
                std::max(velocity, std::abs(alone.state.velocity[c](x, y, z) - together.state.velocity[c](i, j, k)));
          pressure = std::max(pressure, std::abs(alone.state.pressure(x, y, z) - together.state.pressure(i, j, k)));
        }
    // Sums over ranks differ by round-off, and the pressure solver stops at 1e-12 of its source.
    EXPECT_LE(velocity, 1e-10 * alone.report.largest_speed) << shape[0] << shape[1] << shape[2];
    EXPECT_LE(pressure, 1e-10 * largest_pressure) << shape[0] << shape[1] << shape[2];
    EXPECT_EQ(together.report.n_steps, alone.report.n_steps);
    EXPECT_EQ(together.report.scheme, alone.report.scheme);
    EXPECT_GT(alone.report.largest_speed, 0.5);
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, FlowOnRanks,
                         testing::Combine(testing::Values(TimeScheme::adams_bashforth, TimeScheme::runge_kutta,
                                                          TimeScheme::crank_nicolson),
                                          testing::Values(2, 3), testing::Values(Case::borders, Case::openings)));
INSTANTIATE_TEST_SUITE_P(BesideWalls, FlowOnRanks,
                         testing::Combine(testing::Values(TimeScheme::adams_bashforth, TimeScheme::runge_kutta),
                                          testing::Values(2, 3), testing::Values(Case::bodies)));

bool same_bits(const Field<double>& a, const Field<double>& b) {
  for (int k = 0; k < a.sizes()[2]; ++k)
    for (int j = 0; j < a.sizes()[1]; ++j)
      if (std::memcmp(a.row(j, k), b.row(j, k), static_cast<std::size_t>(a.sizes()[0]) * sizeof(double)) != 0)
        return false;
  return true;
}

class FlowRepeated : public testing::TestWithParam<std::tuple<TimeScheme, bool>> {};

TEST_P(FlowRepeated, IsTheSameToTheBitFromTheSameStartAndAfterARestart) {
  const auto [scheme, has_openings] = GetParam();
  const NavierStokesSetup setup = has_openings ? openings(scheme, 2) : everything(scheme, 2);
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  FlowState before = flow.initial_state(), start, first, second;
  flow.advance(before, 0.02, start);
  flow.advance(start, 0.03, first);  // several steps
  flow.advance(first, 0.01, second);
  flow.advance(start, 0.03, second);
  // What a file keeps: the numbers of the block, and the border's own faces.
  FractionalStep again(setup, blocks);
  FlowState stored;
  stored.time = start.time, stored.pressure_time = start.pressure_time, stored.last_step = start.last_step;
  stored.rate_kind = start.rate_kind;
  const Triple sizes = blocks.mine().sizes();
  const auto copy = [&](const Field<double>& field, int component) {
    Field<double> kept(field.sizes(), field.ghosts());
    for (int k = 0; k < sizes[2]; ++k)
      for (int j = component == 1 ? -1 : 0; j < sizes[1]; ++j)
        for (int i = component == 0 ? -1 : 0; i < sizes[0]; ++i) kept(i, j, k) = field(i, j, k);
    return kept;
  };
  for (int c = 0; c < 2; ++c) {
    stored.velocity[c] = copy(start.velocity[c], c);
    if (!start.rate[c].is_empty()) stored.rate[c] = copy(start.rate[c], c);
  }
  stored.pressure = copy(start.pressure, -1);
  again.fill_ghosts(stored);
  FlowState third;
  again.advance(stored, 0.03, third);
  for (int c = 0; c < 2; ++c) {
    EXPECT_TRUE(same_bits(first.velocity[c], second.velocity[c]));
    EXPECT_TRUE(same_bits(first.velocity[c], third.velocity[c]));
  }
  EXPECT_TRUE(same_bits(first.pressure, second.pressure));
  EXPECT_TRUE(same_bits(first.pressure, third.pressure));
}

INSTANTIATE_TEST_SUITE_P(Schemes, FlowRepeated,
                         testing::Combine(testing::Values(TimeScheme::automatic, TimeScheme::adams_bashforth,
                                                          TimeScheme::runge_kutta, TimeScheme::crank_nicolson),
                                          testing::Bool()));

TEST(FlowRepeated, IsTheSameBesideWallsWhateverTheEndStateHeldBefore) {
  for (const TimeScheme scheme : {TimeScheme::adams_bashforth, TimeScheme::runge_kutta}) {
    const NavierStokesSetup setup = sliding_bodies(scheme, 2);
    const BlockDecomposition blocks = decompose(setup.grid);
    FractionalStep flow(setup, blocks);
    FlowState before = flow.initial_state(), start, first, second;
    flow.advance(before, 0.01, start);
    flow.advance(start, 0.01, first);
    flow.advance(first, 0.01, second);
    flow.advance(start, 0.01, second);
    for (int c = 0; c < 2; ++c) EXPECT_TRUE(same_bits(first.velocity[c], second.velocity[c]));
    EXPECT_TRUE(same_bits(first.pressure, second.pressure));
  }
}

}  // namespace
}  // namespace couplet::flow
