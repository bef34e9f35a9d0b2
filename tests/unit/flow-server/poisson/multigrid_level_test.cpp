// Started on 1 rank.
#include "flow-server/poisson/multigrid_level.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "flow-server/grid/stretched_axis.hpp"

namespace couplet::flow {
namespace {

/// A level of 24 x 18 x 20 stretched cells, joined to the next one.
struct TwoLevels {
  LevelPlan plan;
  BlockDecomposition blocks;
  MultigridLevel level;

  /// `share`: of all faces; 0: borders are whole.
  explicit TwoLevels(bool is_open, float share = 0)
      : plan(plan_levels({axis(24, 4, is_open), axis(18, 1, is_open), axis(20, 2, is_open)})),
        blocks(MPI_COMM_SELF, {Partition{{0, 24}}, Partition{{0, 18}}, Partition{{0, 20}}}, {}),
        level(plan.axes[0], blocks, share > 0 ? MultigridLevel::Faces::with_shares : MultigridLevel::Faces::whole) {
    level.join(plan.merging[0], plan.axes[1]);
    if (share == 0) return;
    for (int d = 0; d < 3; ++d)
      for (int k = -(d == 2); k < 20; ++k)
        for (int j = -(d == 1); j < 18; ++j)
          for (int i = -(d == 0); i < 24; ++i) level.set_share(d, {i, j, k}, share);
    level.update(nullptr);
  }
  static LevelAxis axis(int n, double stretching, bool is_open) {
    LevelAxis axis;
    const std::vector<double> faces = symmetrically_stretched_faces(0, 1, n, stretching);
    for (int i = 0; i < n; ++i) axis.width.push_back(faces[i + 1] - faces[i]);
    axis.border_is_open = {is_open, is_open};
    return axis;
  }
  double centre(int l, int d, int i) const {
    double x = 0;
    const auto& width = plan.axes[static_cast<std::size_t>(l)][d].width;
    for (int c = 0; c < i; ++c) x += width[c];
    return x + 0.5 * width[i];
  }
  /// Values of a function at the centres of level 1, ghosts 0.
  Field<float> coarse(const std::function<double(double, double, double)>& f) const {
    Field<float> field(plan.n_cells(1), {4, 4, 4});
    for (int k = 0; k < plan.n_cells(1)[2]; ++k)
      for (int j = 0; j < plan.n_cells(1)[1]; ++j)
        for (int i = 0; i < plan.n_cells(1)[0]; ++i)
          field(i, j, k) = static_cast<float>(f(centre(1, 0, i), centre(1, 1, j), centre(1, 2, k)));
    return field;
  }
  double volume(int l, int i, int j, int k) const {
    const auto& axes = plan.axes[static_cast<std::size_t>(l)];
    return axes[0].width[i] * axes[1].width[j] * axes[2].width[k];
  }
};

constexpr double float_round_off = 4e-6;  // of sums of a few terms of the size of 1 in single precision

TEST(MultigridLevel, InterpolationKeepsConstantsAtClosedBorders) {
  TwoLevels both(false);
  both.level.add_correction(both.coarse([](double, double, double) { return 3.0; }), nullptr);
  for (int k = 0; k < 20; ++k)
    for (int j = 0; j < 18; ++j)
      for (int i = 0; i < 24; ++i) ASSERT_NEAR(both.level.phi(i, j, k), 3, float_round_off);
}

TEST(MultigridLevel, InterpolationKeepsLinearFunctionsAwayFromBorders) {
  TwoLevels both(false);
  const auto linear = [](double x, double y, double z) { return 1 + x - 2 * y + 0.5 * z; };
  both.level.add_correction(both.coarse(linear), nullptr);
  for (int k = 3; k < 17; ++k)
    for (int j = 3; j < 15; ++j)
      for (int i = 3; i < 21; ++i) {
        ASSERT_NEAR(both.level.phi(i, j, k), linear(both.centre(0, 0, i), both.centre(0, 1, j), both.centre(0, 2, k)),
                    float_round_off);
      }
}

TEST(MultigridLevel, InterpolationFallsToZeroAtOpenBorders) {
  TwoLevels both(true);
  // A roof over x: 0 at both borders, linear in between; constant along y and z but for their own open borders.
  const auto roof = [](double x, double, double) { return std::min(x, 1 - x); };
  both.level.add_correction(both.coarse(roof), nullptr);
  for (int i = 0; i < 6; ++i) ASSERT_NEAR(both.level.phi(i, 9, 10), both.centre(0, 0, i), float_round_off) << i;
}

TEST(MultigridLevel, RestrictionKeepsTheIntegralOfTheResidual) {
  TwoLevels both(false);
  double integral = 0;
  for (int k = 0; k < 20; ++k)
    for (int j = 0; j < 18; ++j)
      for (int i = 0; i < 24; ++i) {
        both.level.rhs(i, j, k) = static_cast<float>(std::sin(3.0 * i + 5.0 * j * k) + 0.25);
        integral += both.volume(0, i, j, k) * both.level.rhs(i, j, k);
      }
  Field<float> coarse(both.plan.n_cells(1), {4, 4, 4});
  both.level.smooth_and_restrict(coarse);
  // With closed borders div grad of anything has the integral 0, so that the residual has that of the right-hand side.
  double restricted = 0;
  const Triple n = both.plan.n_cells(1);
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) restricted += both.volume(1, i, j, k) * coarse(i, j, k);
  EXPECT_NEAR(restricted, integral, 1e-5);  // 8640 residuals of the size of 1, each with the round-off of its terms
}

TEST(MultigridLevel, SmoothingOfTheSolutionLeavesIt) {
  TwoLevels both(true);
  const auto& axes = both.plan.axes[0];
  auto& phi = both.level.phi;
  for (int k = 0; k < 20; ++k)
    for (int j = 0; j < 18; ++j)
      for (int i = 0; i < 24; ++i) phi(i, j, k) = static_cast<float>(std::cos(0.3 * i) * std::sin(0.2 * j + 0.1 * k));
  Field<float> start(phi.sizes(), {0, 0, 0});
  for (int k = 0; k < 20; ++k)
    for (int j = 0; j < 18; ++j)
      for (int i = 0; i < 24; ++i) {
        const double c = phi(i, j, k);
        start(i, j, k) = phi(i, j, k);
        both.level.rhs(i, j, k) =
            static_cast<float>(axes[0].lower(i) * (phi(i - 1, j, k) - c) + axes[0].upper(i) * (phi(i + 1, j, k) - c) +
                               axes[1].lower(j) * (phi(i, j - 1, k) - c) + axes[1].upper(j) * (phi(i, j + 1, k) - c) +
                               axes[2].lower(k) * (phi(i, j, k - 1) - c) + axes[2].upper(k) * (phi(i, j, k + 1) - c));
      }
  both.level.smooth();
  for (int k = 0; k < 20; ++k)
    for (int j = 0; j < 18; ++j)
      for (int i = 0; i < 24; ++i) ASSERT_NEAR(phi(i, j, k), start(i, j, k), float_round_off);
}

TEST(MultigridLevel, CoarseSharesAreAreaWeightedMeans) {
  TwoLevels both(true, 0.5f);
  const Triple n = both.plan.n_cells(1);
  std::int64_t n_faces = 0;
  both.level.transfer().coarse_shares([&](int, const Triple&, float share) {
    EXPECT_NEAR(share, 0.5, 1e-6);  // single precision
    ++n_faces;
  });
  EXPECT_EQ(n_faces, (n[0] + 1) * n[1] * n[2] + n[0] * (n[1] + 1) * n[2] + n[0] * n[1] * (n[2] + 1));
}

}  // namespace
}  // namespace couplet::flow
