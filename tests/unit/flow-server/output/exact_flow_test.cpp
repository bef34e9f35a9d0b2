#include "flow-server/output/exact_flow.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace couplet::flow {
namespace {

constexpr double density = 1.3, viscosity = 0.2;
// Central differences of fourth order: truncation h^4 times fifth derivatives of order one, round-off 1e-16 / h^2.
constexpr double h = 2e-3, tolerance = 2e-8;

template <class Function>
double first(const Function& f, double x) {
  return (f(x - 2 * h) - 8 * f(x - h) + 8 * f(x + h) - f(x + 2 * h)) / (12 * h);
}

template <class Function>
double second(const Function& f, double x) {
  return (-f(x - 2 * h) + 16 * f(x - h) - 30 * f(x) + 16 * f(x + h) - f(x + 2 * h)) / (12 * h * h);
}

/// rho (du/dt + u . grad u) + grad p - mu laplace u, and div u, by differences.
void expect_solution(const ExactFlow& flow, const Point& at, double t, int n_dimensions) {
  const Point u = flow.velocity(at, t);
  const auto along = [&](int b, double x) {
    Point moved = at;
    moved[static_cast<std::size_t>(b)] = x;
    return moved;
  };
  double divergence = 0;
  for (std::size_t a = 0; a < static_cast<std::size_t>(n_dimensions); ++a) {
    double residual = density * first([&](double time) { return flow.velocity(at, time)[a]; }, t);
    for (int b = 0; b < n_dimensions; ++b) {
      const auto component = [&](double x) { return flow.velocity(along(b, x), t)[a]; };
      const double here = at[static_cast<std::size_t>(b)];
      residual +=
          density * u[static_cast<std::size_t>(b)] * first(component, here) - viscosity * second(component, here);
    }
    residual += first([&](double x) { return flow.pressure(along(static_cast<int>(a), x), t); }, at[a]);
    EXPECT_NEAR(residual, 0, tolerance) << "component " << a;
    divergence += first([&](double x) { return flow.velocity(along(static_cast<int>(a), x), t)[a]; }, at[a]);
  }
  EXPECT_NEAR(divergence, 0, tolerance);
}

TEST(ExactFlow, EthierSteinmanSolvesTheEquations) {
  const ExactFlow flow(EthierSteinmanFlow{0.8, 1.4}, density, viscosity);
  expect_solution(flow, {0.1, -0.3, 0.4}, 0.2, 3);
  expect_solution(flow, {-0.5, 0.2, 0.6}, 0.0, 3);
}

TEST(ExactFlow, TaylorGreenSolvesTheEquationsInTwoDimensions) {
  const ExactFlow flow(TaylorGreenVortices{1.5, 0.7, 2}, density, viscosity);
  expect_solution(flow, {0.1, -0.3, 0}, 0.2, 2);
}

TEST(ExactFlow, TaylorGreenStartsInThreeDimensionsWithThePressureThatKeepsItFreeOfDivergence) {
  // laplace p = -rho (grad u : grad u^T) for the flow at t = 0.
  const ExactFlow flow(TaylorGreenVortices{1.5, 0.7, 3}, density, viscosity);
  const Point at{0.3, 0.8, -0.4};
  const auto along = [&](std::size_t b, double x) {
    Point moved = at;
    moved[b] = x;
    return moved;
  };
  double laplacian = 0, product = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    laplacian += second([&](double x) { return flow.pressure(along(a, x), 0); }, at[a]);
    for (std::size_t b = 0; b < 3; ++b) {
      product += first([&](double x) { return flow.velocity(along(b, x), 0)[a]; }, at[b]) *
                 first([&](double x) { return flow.velocity(along(a, x), 0)[b]; }, at[a]);
    }
  }
  EXPECT_NEAR(laplacian, -density * product, tolerance * 100);  // second differences of waves of length 4
}

}  // namespace
}  // namespace couplet::flow
