#include "flow-server/momentum/explicit_momentum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "flow-server/boundary/flow_border.hpp"
#include "flow-server/grid/halo_exchange.hpp"
#include "flow-server/momentum/implicit_momentum.hpp"
#include "flow-server/navier_stokes/flow_domain.hpp"
#include "flow-server/navier_stokes/projection.hpp"

namespace couplet::flow {
namespace {

/// A periodic, stretched box with some velocity.
struct PeriodicBox {
  explicit PeriodicBox(int n_dimensions)
      : setup{{{StretchedAxis(symmetrically_stretched_faces(0, 1, 8, 4), true),
                StretchedAxis(symmetrically_stretched_faces(0, 2, 10, 0.2), true),
                StretchedAxis(
                    n_dimensions == 3 ? symmetrically_stretched_faces(0, 1.5, 12, 2) : uniform_faces(0, 1.5, 1),
                    n_dimensions == 3)},
               n_dimensions},
              1,
              0,
              {},
              {},
              {},
              {},
              {},
              TimeScheme::automatic,
              {},
              {},
              false},
        blocks(MPI_COMM_SELF,
               {equal_parts(setup.grid.axis[0].n_cells(), 1, 1), equal_parts(setup.grid.axis[1].n_cells(), 1, 1),
                equal_parts(setup.grid.axis[2].n_cells(), 1, 1)},
               setup.grid.is_periodic()),
        border(setup.grid, blocks, {}, {}, false),
        block(make_flow_block(setup, blocks, border)),
        exchange(blocks),
        velocity(block.new_vector_field()),
        result(block.new_vector_field()),
        pressure(block.new_field()) {}

  /// The discrete curl of a potential on the edges: free of divergence to round-off.
  void set_curl() {
    const auto potential = [&](int component, int i, int j, int k) {
      const Triple n = block.sizes;
      const Triple cell{(i + n[0]) % n[0], (j + n[1]) % n[1], n[2] == 1 ? 0 : (k + n[2]) % n[2]};
      return std::sin(1.7 * cell[0] * cell[0] + 2.3 * cell[1] + 0.9 * cell[2] * cell[1] + component);
    };
    const bool three = block.n_dimensions == 3;
    for (int k = 0; k < block.sizes[2]; ++k)
      for (int j = 0; j < block.sizes[1]; ++j)
        for (int i = 0; i < block.sizes[0]; ++i) {
          const double x = block.axis[0].width[i], y = block.axis[1].width[j], z = block.axis[2].width[k];
          const double a = three ? (potential(1, i, j, k) - potential(1, i, j, k - 1)) / z : 0;
          const double b = three ? (potential(0, i, j, k) - potential(0, i, j, k - 1)) / z : 0;
          velocity[0](i, j, k) = (potential(2, i, j, k) - potential(2, i, j - 1, k)) / y - a;
          velocity[1](i, j, k) = b - (potential(2, i, j, k) - potential(2, i - 1, j, k)) / x;
          if (three)
            velocity[2](i, j, k) = (potential(1, i, j, k) - potential(1, i - 1, j, k)) / x -
                                   (potential(0, i, j, k) - potential(0, i, j - 1, k)) / y;
        }
    fill(velocity);
  }
  void fill(VectorField& fields) {
    std::vector<Field<double>*> all;
    for (int d = 0; d < block.n_dimensions; ++d) all.push_back(&fields[d]);
    exchange.exchange(all, 1);
  }
  Box everything() const { return box_of(block.sizes).grown({1, 1, 1}); }
  /// Sum over all faces of (volume around the face) * value(component, i, j, k).
  double sum(const std::function<double(int, int, int, int)>& value) const {
    double total = 0;
    for (int c = 0; c < block.n_dimensions; ++c)
      for (int k = 0; k < block.sizes[2]; ++k)
        for (int j = 0; j < block.sizes[1]; ++j)
          for (int i = 0; i < block.sizes[0]; ++i) {
            const Triple cell{i, j, k};
            double volume = 1;
            for (int d = 0; d < 3; ++d)
              volume *= d == c ? 1 / block.axis[d].inverse_control_width[cell[d]] : block.axis[d].width[cell[d]];
            total += volume * value(c, i, j, k);
          }
    return total;
  }

  NavierStokesSetup setup;
  BlockDecomposition blocks;
  FlowBorder border;
  FlowBlock block;
  HaloExchange exchange;
  VectorField velocity, result;
  Field<double> pressure;
};

class Momentum : public testing::TestWithParam<int> {};

TEST_P(Momentum, OfConvectionNeitherMakesNorTakesKineticEnergyOrMomentum) {
  PeriodicBox box(GetParam());
  box.set_curl();
  Field<double> divergence = box.block.new_field();
  take_divergence(box.block, box.everything(), 1, box.velocity, divergence);
  for (std::size_t i = 0; i < divergence.n_values(); ++i) ASSERT_NEAR(divergence.data()[i], 0, 1e-9);
  auto rate = box.block.new_vector_field();
  MomentumWeights weights;
  weights.now = 1;
  advance_momentum(box.block, box.everything(), weights, box.velocity, box.velocity, box.pressure, nullptr, &rate,
                   box.result);
  const double size =
      box.sum([&](int c, int i, int j, int k) { return std::abs(box.velocity[c](i, j, k) * rate[c](i, j, k)); });
  EXPECT_GT(size, 1);
  EXPECT_NEAR(box.sum([&](int c, int i, int j, int k) { return box.velocity[c](i, j, k) * rate[c](i, j, k); }), 0,
              1e-13 * size);  // round-off of the sum
  for (int d = 0; d < GetParam(); ++d)
    EXPECT_NEAR(box.sum([&](int c, int i, int j, int k) { return c == d ? rate[c](i, j, k) : 0.0; }), 0, 1e-12 * size);
}

TEST_P(Momentum, OfDiffusionOnlyTakesEnergy) {
  PeriodicBox box(GetParam());
  box.set_curl();
  auto still = box.block.new_vector_field();
  MomentumWeights weights;
  weights.now = 1, weights.viscosity = 0.3;
  advance_momentum(box.block, box.everything(), weights, still, box.velocity, box.pressure, nullptr, nullptr,
                   box.result);
  EXPECT_LT(box.sum([&](int c, int i, int j, int k) {
    return box.velocity[c](i, j, k) * (box.result[c](i, j, k) - box.velocity[c](i, j, k));
  }),
            -1);
}

TEST_P(Momentum, OfAnyPartsIsThatOfTheWhole) {
  PeriodicBox box(GetParam());
  box.set_curl();
  MomentumWeights weights;
  weights.now = 0.1, weights.viscosity = 0.01, weights.pressure = 1, weights.impulse = {0.1, 0.2, 0.3};
  auto pieces = box.block.new_vector_field();
  advance_momentum(box.block, box.everything(), weights, box.velocity, box.velocity, box.pressure, nullptr, nullptr,
                   box.result);
  for (const auto& [begin, end] : {std::pair{-1, 3}, std::pair{3, 4}, std::pair{4, 11}}) {
    Box part = box.everything();
    part.begin[0] = begin, part.end[0] = end;
    advance_momentum(box.block, part, weights, box.velocity, box.velocity, box.pressure, nullptr, nullptr, pieces);
  }
  // The same formula, in vectors of other lengths: fused operations may differ in the last place.
  for (int c = 0; c < GetParam(); ++c)
    for (std::size_t i = 0; i < pieces[c].n_values(); ++i)
      ASSERT_NEAR(pieces[c].data()[i], box.result[c].data()[i], 1e-12 * (1 + std::abs(pieces[c].data()[i])));
}

TEST_P(Momentum, SolvedOnLinesIsInvertedByItsOwnFactors) {
  // Along one direction the factor is that of the explicit kernel: with a carrier and viscosity that only act along it,
  // (1 + dt/2 L) change = right side, and L change is what the kernel says.
  for (int direction = 0; direction < GetParam(); ++direction) {
    PeriodicBox box(GetParam());
    box.set_curl();
    auto carrier = box.block.new_vector_field(), change = box.block.new_vector_field();
    for (std::size_t i = 0; i < carrier[direction].n_values(); ++i)
      carrier[direction].data()[i] = std::sin(static_cast<double>(i));
    box.fill(carrier);
    for (int c = 0; c < GetParam(); ++c)
      std::copy(box.velocity[c].data(), box.velocity[c].data() + box.velocity[c].n_values(), change[c].data());
    const double half_step = 0.02;
    ImplicitMomentum(box.block, box.border).solve(half_step, 0, carrier, change);
    box.fill(change);
    MomentumWeights weights;
    weights.now = -half_step;
    advance_momentum(box.block, box.everything(), weights, carrier, change, box.pressure, nullptr, nullptr, box.result);
    for (int c = 0; c < GetParam(); ++c)
      for (int k = 0; k < box.block.sizes[2]; ++k)
        for (int j = 0; j < box.block.sizes[1]; ++j)
          for (int i = 0; i < box.block.sizes[0]; ++i)
            ASSERT_NEAR(box.result[c](i, j, k), box.velocity[c](i, j, k), 1e-10) << direction << c;
  }
}

INSTANTIATE_TEST_SUITE_P(Dimensions, Momentum, testing::Values(2, 3));

}  // namespace
}  // namespace couplet::flow
