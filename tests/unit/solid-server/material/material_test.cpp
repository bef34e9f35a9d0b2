// Every member of Material is tested against what any hyperelastic law must satisfy; then against closed-form states.

#include "solid-server/material/material.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

namespace couplet::solid {
namespace {

using Matrix = Eigen::Matrix3d;

Tensor<double> tensor(const Matrix& m) {
  Tensor<double> t;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) t.at[i][j] = m(i, j);
  return t;
}

Matrix matrix(const Tensor<double>& t) {
  Matrix m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = t.at[i][j];
  return m;
}

template <class M>
M example();
template <>
SaintVenantKirchhoff example() {
  return SaintVenantKirchhoff::from_young(15e3, 0.475);
}
template <>
NeoHookean example() {
  return {5080, 100e3};
}
template <>
MooneyRivlin example() {
  return {2290, 250, 100e3};
}

template <class Variant>
struct TestTypes;
template <class... Members>
struct TestTypes<std::variant<Members...>> {
  using Type = testing::Types<Members...>;
};

template <class M>
class AnyMaterial : public testing::Test {
 protected:
  const M material = example<M>();
  const double stiffness = material.pressure_wave_modulus();  // what stresses are compared with
  const Matrix strained = (Matrix() << 1.2, 0.3, -0.1, 0.05, 0.85, 0.2, -0.15, 0.1, 1.1).finished();

  Matrix stress(const Matrix& F) const { return matrix(material.stress(tensor(F))); }
};
TYPED_TEST_SUITE(AnyMaterial, TestTypes<Material>::Type);

TYPED_TEST(AnyMaterial, StressIsTheDerivativeOfTheEnergy) {
  const double h = 1e-5;  // error of the difference: h^2 of truncation and 1e-16 / h of round-off, times the stiffness
  const Matrix P = this->stress(this->strained);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      Matrix up = this->strained, down = this->strained;
      up(i, j) += h;
      down(i, j) -= h;
      const double slope = (this->material.energy(tensor(up)) - this->material.energy(tensor(down))) / (2 * h);
      EXPECT_NEAR(P(i, j), slope, 1e-8 * this->stiffness);
    }
}

TYPED_TEST(AnyMaterial, TangentIsTheDerivativeOfTheStress) {
  const double h = 1e-5;
  const Tangent tangent = as_matrix(this->material.tangent(tensor(this->strained)));
  for (int column = 0; column < 9; ++column) {
    Matrix up = this->strained, down = this->strained;
    up(column / 3, column % 3) += h;
    down(column / 3, column % 3) -= h;
    const Matrix slope = (this->stress(up) - this->stress(down)) / (2 * h);
    for (int row = 0; row < 9; ++row)
      EXPECT_NEAR(tangent(row, column), slope(row / 3, row % 3), 1e-8 * this->stiffness) << row << ", " << column;
  }
}

TYPED_TEST(AnyMaterial, TangentIsSymmetric) {
  const Tangent tangent = as_matrix(this->material.tangent(tensor(this->strained)));
  EXPECT_LE((tangent - tangent.transpose()).cwiseAbs().maxCoeff(), 1e-12 * this->stiffness);  // round-off
}

TYPED_TEST(AnyMaterial, DoesNotFeelARotationOfTheObserver) {
  const Matrix Q = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 3).normalized()).toRotationMatrix();
  EXPECT_NEAR(this->material.energy(tensor(Q * this->strained)), this->material.energy(tensor(this->strained)),
              1e-12 * this->stiffness);
  EXPECT_LE((this->stress(Q * this->strained) - Q * this->stress(this->strained)).cwiseAbs().maxCoeff(),
            1e-12 * this->stiffness);
}

TYPED_TEST(AnyMaterial, IsFreeOfStressAndEnergyAtRest) {
  EXPECT_LE(this->stress(Matrix::Identity()).cwiseAbs().maxCoeff(), 1e-14 * this->stiffness);
  EXPECT_NEAR(this->material.energy(tensor(Matrix::Identity())), 0, 1e-14 * this->stiffness);
}

TYPED_TEST(AnyMaterial, RisesFromRestWithThePressureWaveModulus) {
  // One-dimensional strain: dP11/dF11 = rho c_p^2.
  EXPECT_NEAR(as_matrix(this->material.tangent(tensor(Matrix::Identity())))(0, 0), this->stiffness,
              1e-10 * this->stiffness);
}

TYPED_TEST(AnyMaterial, AnswersEightPointsAsItAnswersOne) {
  // Volume ratios from a tenth to five: inside and outside the range of the fast cube root.
  Tensor<Pack> packed;
  std::array<Matrix, n_lanes> single;
  for (int lane = 0; lane < n_lanes; ++lane) {
    single[static_cast<std::size_t>(lane)] = this->strained * std::cbrt(0.1 + 0.7 * lane);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) packed.at[i][j][lane] = single[static_cast<std::size_t>(lane)](i, j);
  }
  const Tensor<Pack> P = this->material.stress(packed);
  const Pack W = this->material.energy(packed);
  for (int lane = 0; lane < n_lanes; ++lane) {
    const Matrix& F = single[static_cast<std::size_t>(lane)];
    const double scale = this->stiffness * std::pow(F.norm(), 3);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(P.at[i][j][lane], this->stress(F)(i, j), 1e-14 * scale);
    EXPECT_NEAR(W[lane], this->material.energy(tensor(F)), 1e-14 * scale);
  }
}

// Homogeneous states, computed independently from W by root finding: axial stretch, lateral stretch, nominal stress
// [Pa].
struct UniaxialState {
  double stretch, lateral, stress;
};

template <class M>
void expect_uniaxial(const M& material, const UniaxialState& state) {
  const Eigen::Vector3d stretches(state.stretch, state.lateral, state.lateral);
  const Matrix P = matrix(material.stress(tensor(stretches.asDiagonal())));
  // The lateral stretch is given to 8 digits: the bulk modulus turns 5e-8 of it into stress.
  EXPECT_NEAR(P(0, 0), state.stress, 1e-7 * material.pressure_wave_modulus());
  EXPECT_NEAR(P(1, 1), 0, 1e-7 * material.pressure_wave_modulus());
}

TEST(MooneyRivlin, StretchesAsComputedIndependently) {
  // a10 = 2.29 kPa, a01 = 0.25 kPa, K = 100 kPa.
  for (const UniaxialState& state :
       {UniaxialState{0.8, 1.1121292, -3908.9929}, UniaxialState{1.2, 0.91733763, 2476.5598},
        UniaxialState{1.5, 0.82650068, 5052.5851}, UniaxialState{2, 0.72508283, 8121.2186}})
    expect_uniaxial(example<MooneyRivlin>(), state);
}

TEST(SaintVenantKirchhoff, StretchesAsItsClosedForm) {
  // P11 = E/2 (stretch^3 - stretch), lateral^2 = 1 - nu (stretch^2 - 1).
  for (const double stretch : {0.8, 1.1, 1.5})
    expect_uniaxial(example<SaintVenantKirchhoff>(), {stretch, std::sqrt(1 - 0.475 * (stretch * stretch - 1)),
                                                      7500 * stretch * (stretch * stretch - 1)});
}

TEST(MooneyRivlin, StretchesInAConfinedTubeAsComputedIndependently) {
  for (const auto& [stretch, stress] :
       {std::pair{0.8, -21796.364}, std::pair{0.9, -10772.481}, std::pair{1.1, 10603.065}}) {
    const Matrix F = Eigen::Vector3d(stretch, 1, 1).asDiagonal();
    EXPECT_NEAR(matrix(example<MooneyRivlin>().stress(tensor(F)))(0, 0), stress, 1e-3);  // the digits given
  }
}

TEST(MooneyRivlin, ShearsInProportionToTheAngle) {
  // Simple shear keeps the volume: P12 = 2 (a10 + a01) gamma.
  for (const double gamma : {0.1, 0.5, 1.0}) {
    Matrix F = Matrix::Identity();
    F(0, 1) = gamma;
    EXPECT_NEAR(matrix(example<MooneyRivlin>().stress(tensor(F)))(0, 1), 5080 * gamma, 1e-9);
  }
}

TEST(InverseCubeRoot, IsExactToRoundOffForAnyPositiveNumber) {
  for (double x = 1e-6; x < 1e6; x *= 1.01) {
    Pack packed{};
    for (int lane = 0; lane < n_lanes; ++lane) packed[lane] = x * (1 + 1e-3 * lane);
    const Pack root = inverse_cube_root(packed);
    for (int lane = 0; lane < n_lanes; ++lane)
      EXPECT_NEAR(root[lane] * std::cbrt(packed[lane]), 1, 1e-15) << packed[lane];
  }
}

}  // namespace
}  // namespace couplet::solid
