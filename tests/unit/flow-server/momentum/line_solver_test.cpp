// Started on 1, 2, 4 and 8 ranks.
#include "flow-server/momentum/line_solver.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace couplet::flow {
namespace {

constexpr Triple n_cells{17, 21, 33};

int n_ranks() {
  int n = 0;
  MPI_Comm_size(MPI_COMM_WORLD, &n);
  return n;
}

std::vector<Triple> shapes() {
  std::vector<Triple> all;
  for (const Triple shape : {Triple{1, 1, 1}, Triple{2, 1, 1}, Triple{1, 2, 1}, Triple{1, 1, 2}, Triple{4, 1, 1},
                             Triple{2, 2, 1}, Triple{1, 1, 8}, Triple{2, 2, 2}, Triple{1, 2, 4}})
    if (shape[0] * shape[1] * shape[2] == n_ranks()) all.push_back(shape);
  return all;
}

BlockDecomposition decompose(const Triple& shape, bool is_periodic) {
  return {MPI_COMM_WORLD,
          {equal_parts(n_cells[0], shape[0], 1), equal_parts(n_cells[1], shape[1], 1),
           equal_parts(n_cells[2], shape[2], 1)},
          {is_periodic, is_periodic, is_periodic}};
}

/// Numbers in -1 ... 1 without a pattern, the same for a cell whoever owns it.
double noise(const Triple& cell, unsigned seed) {
  unsigned bits = seed * 2654435761u + static_cast<unsigned>(cell[0] + 100 * cell[1] + 10000 * cell[2]) * 2246822519u;
  for (int round = 0; round < 3; ++round) bits = (bits ^ (bits >> 15)) * 3266489917u;
  return 2.0 * bits / 4294967295.0 - 1.0;
}

struct System {
  Field<double> lower, diagonal, upper, right_side, solution;
};

/// A solution is chosen, the right side follows from it.
System make_system(const BlockDecomposition& blocks, int direction) {
  const Triple sizes = blocks.mine().sizes();
  const auto field = [&] { return Field<double>(sizes, {1, 1, 1}); };
  System system{field(), field(), field(), field(), field()};
  const auto& origin = blocks.mine().begin;
  const int n = n_cells[direction];
  for (int k = 0; k < sizes[2]; ++k)
    for (int j = 0; j < sizes[1]; ++j)
      for (int i = 0; i < sizes[0]; ++i) {
        const Triple cell{i + origin[0], j + origin[1], k + origin[2]};
        Triple before = cell, after = cell;
        before[direction] = (cell[direction] + n - 1) % n;
        after[direction] = (cell[direction] + 1) % n;
        const double a = noise(cell, 1), c = noise(cell, 2);
        const double b = 1.05 * (std::abs(a) + std::abs(c)) + 0.1;  // barely dominant: a hard case
        const bool is_first = cell[direction] == 0 && !blocks.is_periodic()[direction];
        const bool is_last = cell[direction] == n - 1 && !blocks.is_periodic()[direction];
        system.lower(i, j, k) = a;
        system.diagonal(i, j, k) = b;
        system.upper(i, j, k) = c;
        system.solution(i, j, k) = noise(cell, 3);
        system.right_side(i, j, k) =
            b * noise(cell, 3) + (is_first ? 0 : a * noise(before, 3)) + (is_last ? 0 : c * noise(after, 3));
      }
  return system;
}

class LineSolverTest : public testing::TestWithParam<std::tuple<int, bool>> {};

TEST_P(LineSolverTest, FindsTheSolutionOnAnyBlocks) {
  const auto [direction, is_periodic] = GetParam();
  for (const Triple& shape : shapes()) {
    const BlockDecomposition blocks = decompose(shape, is_periodic);
    LineSolver solver(blocks, direction);
    for (int repetition = 0; repetition < 2; ++repetition) {
      System system = make_system(blocks, direction);
      solver.solve(system.lower, system.diagonal, system.upper, system.right_side);
      double largest_error = 0;
      const Triple sizes = blocks.mine().sizes();
      for (int k = 0; k < sizes[2]; ++k)
        for (int j = 0; j < sizes[1]; ++j)
          for (int i = 0; i < sizes[0]; ++i)
            largest_error = std::max(largest_error, std::abs(system.right_side(i, j, k) - system.solution(i, j, k)));
      // Round-off of 1e-16 in 33 rows; rows are dominant by at least 0.1 in about 1: it grows at most tenfold.
      EXPECT_LT(largest_error, 1e-13) << shape[0] << shape[1] << shape[2];
    }
  }
}

TEST_P(LineSolverTest, LeavesRowsThatAreNoUnknownsAlone) {
  const auto [direction, is_periodic] = GetParam();
  for (const Triple& shape : shapes()) {
    const BlockDecomposition blocks = decompose(shape, is_periodic);
    System system = make_system(blocks, direction);
    const Triple sizes = blocks.mine().sizes();
    for (int k = 0; k < sizes[2]; ++k)
      for (int j = 0; j < sizes[1]; ++j)
        for (int i = 0; i < sizes[0]; i += 2) {
          system.lower(i, j, k) = system.upper(i, j, k) = 0;
          system.diagonal(i, j, k) = 1;
          system.right_side(i, j, k) = 7;
        }
    LineSolver(blocks, direction).solve(system.lower, system.diagonal, system.upper, system.right_side);
    for (int k = 0; k < sizes[2]; ++k)
      for (int j = 0; j < sizes[1]; ++j)
        for (int i = 0; i < sizes[0]; i += 2) EXPECT_DOUBLE_EQ(system.right_side(i, j, k), 7);
  }
}

INSTANTIATE_TEST_SUITE_P(Directions, LineSolverTest, testing::Combine(testing::Values(0, 1, 2), testing::Bool()));

}  // namespace
}  // namespace couplet::flow
