// Claim: steady flow through a channel of any shape is Bernoulli's without losses, to round-off, and that of the
// friction law to second order in the spacing of the stations.

#include <gtest/gtest.h>

#include <cmath>

#include "flow-server/one_dimensional/glottal_flow.hpp"

namespace couplet::flow {
namespace {

constexpr double width = 0.02;    // [m]
constexpr double length = 0.012;  // [m]
constexpr double density = 1.13;  // [kg/m^3]

template <typename Height>
SectionProfile channel(const StationAxis& axis, const Height& height) {
  SectionProfile profile;
  profile.exit = length;
  const Eigen::ArrayXd h = (axis.fraction() * length).unaryExpr(height);
  profile.area = width * h;
  profile.perimeter = 2 * (width + h);
  return profile;
}

TEST(SteadyChannel, AVenturiWithoutLossesIsBernoulliToRoundOff) {
  for (const int n : {20, 140}) {
    const StationAxis axis(n);
    const auto height = [](double x) { return 1e-3 + 15 * (x - 0.009) * (x - 0.009); };
    GlottalFlow flow(axis, {.model = GlottalModel::b2, .density = density});
    const SectionProfile profile = channel(axis, height);
    flow.start(profile, {1000, -50});
    const GlottalSolution& now = flow.history().accepted;
    const double first = profile.area[0], last = profile.area[n - 1];
    const double Q = std::sqrt(2 * 1050 / density / (1 / (last * last) - 1 / (first * first)));
    EXPECT_NEAR(now.inlet_rate, Q, 1e-14 * Q);
    for (int k = 0; k < n; ++k) {
      const double exact =
          1000 - 0.5 * density * Q * Q * (1 / (profile.area[k] * profile.area[k]) - 1 / (first * first));
      EXPECT_NEAR(now.pressure[k], exact, 1e-11);  // sums of up to 140 drops of kPa
    }
  }
}

TEST(SteadyChannel, DownstreamOfTheThroatOnlyTheGivenShareIsRecovered) {
  const StationAxis axis(140);
  const auto height = [](double x) { return 1e-3 + 15 * (x - 0.009) * (x - 0.009); };
  GlottalFlow flow(axis, {.model = GlottalModel::m1, .density = density, .smallest_recovery = 0.4});
  flow.start(channel(axis, height), {1000, 0});
  const GlottalSolution& now = flow.history().accepted;
  const auto dynamic = [&](int k) { return 0.5 * density * now.velocity[k] * now.velocity[k]; };
  const double recovered = now.pressure[139] - now.pressure[now.throat];
  EXPECT_NEAR(recovered, 0.4 * (dynamic(now.throat) - dynamic(139)), 1e-10);
  EXPECT_NEAR(now.pressure[0] - now.pressure[now.throat], dynamic(now.throat) - dynamic(0), 1e-10);
}

TEST(SteadyChannel, AStraightSlitHasThePressureGradientOfItsFrictionLaw) {
  const StationAxis axis(140);
  const double h = 4e-4, C0 = 3, mu = 1.8e-5;
  GlottalFlow flow(axis, {.model = GlottalModel::m1, .density = density, .viscosity = mu, .friction_coefficient = C0});
  flow.start(channel(axis, [&](double) { return h; }), {100, 0});
  const GlottalSolution& now = flow.history().accepted;
  const double s_over_A = 2 * (width + h) / (width * h);
  const double u = 100 / length / (C0 * mu * s_over_A * s_over_A);  // plane Poiseuille: 12 mu u / h^2 for h << width
  EXPECT_NEAR(now.velocity[70], u, 1e-13 * u);
  for (int k = 0; k < 140; ++k) EXPECT_NEAR(now.pressure[k], 100 * (1 - now.position[k] / length), 1e-11);
}

TEST(SteadyChannel, AConvergingSlitConvergesWithTheSquareOfTheSpacing) {
  // h falls linearly from h0 to h1, so that the friction integral is elementary:
  // integral of C0 mu (s/A)^2 / A dx = 4 C0 mu / (w^3 h') integral of (w + h)^2 / h^3 dh
  const double h0 = 2e-3, h1 = 4e-4, C0 = 2, mu = 2.27e-4;
  const double slope = (h1 - h0) / length;
  const auto primitive = [&](double h) { return -0.5 * width * width / (h * h) - 2 * width / h + std::log(h); };
  const auto friction = [&](double x) {
    return 4 * C0 * mu / (width * width * width * slope) * (primitive(h0 + slope * x) - primitive(h0));
  };
  const auto dynamic = [&](double x) {
    return 0.5 * density / (width * width) * (std::pow(h0 + slope * x, -2) - std::pow(h0, -2));
  };
  const double c2 = dynamic(length), c1 = friction(length), drop = 1000;
  const double Q = 2 * drop / (c1 + std::sqrt(c1 * c1 + 4 * c2 * drop));
  double last_flow_error = 0, last_pressure_error = 0;
  for (const int n : {35, 70, 140, 280}) {
    const StationAxis axis(n);
    GlottalFlow flow(axis,
                     {.model = GlottalModel::m1, .density = density, .viscosity = mu, .friction_coefficient = C0});
    flow.start(channel(axis, [&](double x) { return h0 + slope * x; }), {drop, 0});
    const GlottalSolution& now = flow.history().accepted;
    const double flow_error = std::abs(now.inlet_rate - Q);
    double pressure_error = 0;
    for (int k = 0; k < n; ++k) {
      const double exact = drop - friction(now.position[k]) * Q - dynamic(now.position[k]) * Q * Q;
      pressure_error = std::max(pressure_error, std::abs(now.pressure[k] - exact));
    }
    RecordProperty("flow_error_" + std::to_string(n), std::to_string(flow_error / Q));
    if (last_flow_error > 0) {  // 4 in the limit; (n - 1) doubles only nearly
      EXPECT_GT(last_flow_error / flow_error, 3.8) << n;
      EXPECT_GT(last_pressure_error / pressure_error, 3.8) << n;
    }
    last_flow_error = flow_error;
    last_pressure_error = pressure_error;
  }
  EXPECT_LT(last_flow_error, 1e-4 * Q);  // it converges to this flow and to no other
}

}  // namespace
}  // namespace couplet::flow
