#include <gtest/gtest.h>

#include <cmath>

#include "coupler/predictor/fitted_predictor.hpp"
#include "coupler/predictor/polynomial_predictor.hpp"

namespace couplet::coupling {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

Vector2d polynomial(int order, double t) {
  return {1 + std::pow(t, order), 2 - 3 * std::pow(t, order)};
}

TEST(PolynomialPredictor, IsExactForItsOrderAndStepsOfAnySize) {
  for (int order = 0; order <= 2; ++order) {
    PolynomialPredictor predictor(order);
    for (const double t : {0., 0.1, 0.15, 0.4}) predictor.accept(t, polynomial(order, t));
    EXPECT_LT((predictor.predict(0.9) - polynomial(order, 0.9)).norm(), 1e-13) << order;  // round-off
  }
}

TEST(PolynomialPredictor, FallsBackToLowerOrderWhileTheHistoryIsShort) {
  PolynomialPredictor predictor(2);
  predictor.accept(0, polynomial(1, 0));
  EXPECT_EQ(predictor.predict(1), VectorXd(polynomial(1, 0)));
  predictor.accept(1, polynomial(1, 1));
  EXPECT_LT((predictor.predict(3) - polynomial(1, 3)).norm(), 1e-14);
}

TEST(PolynomialPredictor, ForgetsWhatItDoesNotNeed) {
  PolynomialPredictor predictor(1);
  predictor.accept(0, Vector2d(100, -100));
  predictor.accept(1, Vector2d(1, 1));
  predictor.accept(2, Vector2d(2, 2));
  EXPECT_LT((predictor.predict(3) - Vector2d(3, 3)).norm(), 1e-14);
}

/// Two oscillations about a mean, different in every entry.
VectorXd oscillation(double t) {
  VectorXd x(50);
  for (Eigen::Index i = 0; i < 50; ++i) {
    const double s = static_cast<double>(i) / 50;
    x(i) = s + std::sin(7 * t + s) + 0.3 * std::cos(19 * t - 2 * s);
  }
  return x;
}

TEST(FittedPredictor, ContinuesTwoOscillationsExactly) {
  FittedPredictor fitted(50);
  PolynomialPredictor quadratic(2);
  const double dt = 0.05;
  for (int n = 0; n <= 12; ++n) {
    fitted.accept(n * dt, oscillation(n * dt));
    quadratic.accept(n * dt, oscillation(n * dt));
  }
  const VectorXd truth = oscillation(13 * dt);
  const double error = (fitted.predict(13 * dt) - truth).norm();
  EXPECT_LT(error, 1e-8);  // normal equations: half the digits of a double
  EXPECT_LT(error, 1e-5 * (quadratic.predict(13 * dt) - truth).norm());
}

TEST(FittedPredictor, IsNoWorseThanTheBestPolynomialOnAParabola) {
  FittedPredictor fitted(2);
  for (int n = 0; n <= 12; ++n) {
    if (n >= 3) {
      EXPECT_LT((fitted.predict(0.1 * n) - polynomial(2, 0.1 * n)).norm(), 1e-7) << n;
    }
    fitted.accept(0.1 * n, polynomial(2, 0.1 * n));
  }
}

TEST(FittedPredictor, LeavesTheFitToEqualSteps) {
  FittedPredictor fitted(50);
  for (int n = 0; n <= 12; ++n) fitted.accept(0.01 * n, oscillation(0.01 * n));
  // Half the step: the fit would land a whole step ahead.
  const VectorXd truth = oscillation(0.125);
  EXPECT_LT((fitted.predict(0.125) - truth).norm(), 0.1 * (oscillation(0.13) - truth).norm());
}

TEST(FittedPredictor, HoldsAStateThatDoesNotMove) {
  FittedPredictor fitted(3);
  const VectorXd x = Eigen::Vector3d(1, 2, 3);
  for (int n = 0; n <= 12; ++n) fitted.accept(n, x);
  EXPECT_EQ(fitted.predict(13), x);
}

TEST(FittedPredictor, LetsSecondaryEntriesFollowWithTheSameWeights) {
  FittedPredictor fitted(25);
  for (int n = 0; n <= 12; ++n) {
    VectorXd x = oscillation(0.05 * n);
    x.tail(25) = 4 * x.head(25);
    fitted.accept(0.05 * n, x);
  }
  const VectorXd predicted = fitted.predict(0.65);
  EXPECT_LT((predicted.tail(25) - 4 * predicted.head(25)).norm(), 1e-12);  // round-off
}

TEST(FittedPredictor, ContinuesWithEqualBitsAfterRestore) {
  FittedPredictor straight(50), resumed(50);
  for (int n = 0; n <= 9; ++n) straight.accept(0.05 * n, oscillation(0.05 * n));
  SavedState state;
  straight.save(state, "motion");
  resumed.restore(state, "motion");
  for (int n = 10; n <= 13; ++n) {
    EXPECT_EQ(straight.predict(0.05 * n), resumed.predict(0.05 * n));
    straight.accept(0.05 * n, oscillation(0.05 * n));
    resumed.accept(0.05 * n, oscillation(0.05 * n));
  }
}

}  // namespace
}  // namespace couplet::coupling
