// Laws against states of uniform strain whose stress is known in another way.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <utility>

#include "solid-server/material/material.hpp"
#include "tests/unit/solid-server/material/material_examples.hpp"

namespace couplet::solid {
namespace {

using Vector = Eigen::Vector3d;

// Computed independently from W by root finding: axial stretch, lateral stretch, nominal stress [Pa].
struct UniaxialState {
  double stretch, lateral, stress;
};

template <class M>
void expect_uniaxial(const M& material, const UniaxialState& state) {
  const Matrix F = Vector(state.stretch, state.lateral, state.lateral).asDiagonal();
  const Matrix P = matrix(material.stress(tensor(F)));
  // The lateral stretch is given to 8 digits: the bulk modulus turns 5e-8 of it into stress.
  EXPECT_NEAR(P(0, 0), state.stress, 1e-7 * material.pressure_wave_modulus());
  EXPECT_NEAR(P(1, 1), 0, 1e-7 * material.pressure_wave_modulus());
}

template <class M>
double confined_stress(const M& material, double stretch) {
  const Matrix F = Vector(stretch, 1, 1).asDiagonal();
  return material.stress(tensor(F)).at[0][0];
}

template <class M>
double shear_stress(const M& material, double angle) {
  Matrix F = Matrix::Identity();
  F(0, 1) = angle;
  return material.stress(tensor(F)).at[0][1];
}

TEST(MooneyRivlin, StretchesAsComputedIndependently) {
  // a10 = 2.29 kPa, a01 = 0.25 kPa, K = 100 kPa.
  for (const UniaxialState& state :
       {UniaxialState{0.8, 1.1121292, -3908.9929}, UniaxialState{0.9, 1.0514012, -1691.3023},
        UniaxialState{1.1, 0.95581218, 1352.4424}, UniaxialState{1.2, 0.91733763, 2476.5598},
        UniaxialState{1.5, 0.82650068, 5052.5851}, UniaxialState{2, 0.72508283, 8121.2186}})
    expect_uniaxial(example<MooneyRivlin>(), state);
}

TEST(MooneyRivlin, StretchesInAConfinedTubeAsComputedIndependently) {
  for (const auto& [stretch, stress] :
       {std::pair{0.8, -21796.364}, std::pair{0.9, -10772.481}, std::pair{1.1, 10603.065}, std::pair{1.2, 21087.267}})
    EXPECT_NEAR(confined_stress(example<MooneyRivlin>(), stretch), stress, 1e-3);  // the digits given
}

TEST(MooneyRivlin, ShearsInProportionToTheAngle) {
  // Simple shear keeps the volume: P12 = 2 (a10 + a01) gamma.
  for (const double gamma : {0.1, 0.5, 1.0})
    EXPECT_NEAR(shear_stress(example<MooneyRivlin>(), gamma), 5080 * gamma, 1e-9);
}

TEST(NeoHookean, IsMooneyRivlinWithoutItsSecondCoefficient) {
  const NeoHookean neo_hookean{4580, 100e3};
  const MooneyRivlin mooney_rivlin{2290, 0, 100e3};
  const Tensor<double> F = tensor((Matrix() << 1.2, 0.3, -0.1, 0.05, 0.85, 0.2, -0.15, 0.1, 1.1).finished());
  const double round_off = 1e-14 * neo_hookean.pressure_wave_modulus();
  EXPECT_NEAR(neo_hookean.energy(F), mooney_rivlin.energy(F), round_off);
  EXPECT_LE((matrix(neo_hookean.stress(F)) - matrix(mooney_rivlin.stress(F))).cwiseAbs().maxCoeff(), round_off);
  EXPECT_LE((as_matrix(neo_hookean.tangent(F)) - as_matrix(mooney_rivlin.tangent(F))).cwiseAbs().maxCoeff(),
            10 * round_off);
}

TEST(NeoHookean, TakesYoungModulusAndPoissonRatio) {
  // Both appear in a uniaxial test of small strain: sides free of load at -nu times the strain, stress E times the
  // strain.
  const NeoHookean material = NeoHookean::from_young(17e6, 0.45);
  const double strain = 1e-6;
  const Matrix F = Vector(1 + strain, 1 - 0.45 * strain, 1 - 0.45 * strain).asDiagonal();
  const Matrix P = matrix(material.stress(tensor(F)));
  const double second_order = 100 * strain * strain * 17e6;  // (K/E of 3.3 times a few strains squared)
  EXPECT_NEAR(P(0, 0), 17e6 * strain, second_order);
  EXPECT_NEAR(P(1, 1), 0, second_order);
}

TEST(SaintVenantKirchhoff, StretchesAsItsClosedForm) {
  // P11 = E/2 (stretch^3 - stretch), lateral^2 = 1 - nu (stretch^2 - 1).
  for (const double stretch : {0.8, 0.9, 1.1, 1.2, 1.5})
    expect_uniaxial(example<SaintVenantKirchhoff>(), {stretch, std::sqrt(1 - 0.475 * (stretch * stretch - 1)),
                                                      7500 * stretch * (stretch * stretch - 1)});
}

TEST(SaintVenantKirchhoff, StretchesInAConfinedTubeAndShearsAsItsClosedForms) {
  // P11 = (lambda + 2 mu)/2 (stretch^3 - stretch);  P12 = mu gamma + (lambda/2 + mu) gamma^3. Young 15 kPa, nu 0.475.
  for (const auto& [stretch, stress] :
       {std::pair{0.8, -15376.271}, std::pair{0.9, -9129.661}, std::pair{1.1, 12333.051}, std::pair{1.2, 28189.831}})
    EXPECT_NEAR(confined_stress(example<SaintVenantKirchhoff>(), stretch), stress, 1e-3);  // the digits given
  for (const auto& [gamma, stress] :
       {std::pair{0.1, 561.86441}, std::pair{0.25, 2105.4025}, std::pair{0.5, 9216.1017}, std::pair{1.0, 58474.576}})
    EXPECT_NEAR(shear_stress(example<SaintVenantKirchhoff>(), gamma), stress, 1e-3);
}

/// dP11/dF11 with the sides free of load, by elimination of the lateral stretches.
double uniaxial_slope(const SaintVenantKirchhoff& material, double stretch, double poisson_ratio) {
  const double lateral = std::sqrt(1 - poisson_ratio * (stretch * stretch - 1));
  const Tangent T = as_matrix(material.tangent(tensor(Vector(stretch, lateral, lateral).asDiagonal())));
  return T(0, 0) - 2 * T(0, 4) * T(4, 0) / (T(4, 4) + T(4, 8));
}

TEST(SaintVenantKirchhoff, SaysWhereItsUniaxialStressStopsRising) {
  const Matrix Q = Eigen::AngleAxisd(0.7, Vector(1, -2, 3).normalized()).toRotationMatrix();
  const Matrix R = Eigen::AngleAxisd(1.3, Vector(2, 2, -1).normalized()).toRotationMatrix();
  for (const double poisson_ratio : {0.0, 0.3, 0.475}) {
    const auto material = SaintVenantKirchhoff::from_young(15e3, poisson_ratio);
    for (const double stretch : {0.3, 0.57, 0.5773, 0.5774, 0.59, 1.0, 1.4}) {
      const double lateral = std::sqrt(1 - poisson_ratio * (stretch * stretch - 1));
      const Matrix F = R * Vector(stretch, lateral, lateral).asDiagonal() * Q;
      EXPECT_EQ(material.loses_stiffness(tensor(F)), uniaxial_slope(material, stretch, poisson_ratio) < 0) << stretch;
      Tensor<Pack> packed;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) packed.at[i][j] = Pack{} + F(i, j);
      EXPECT_EQ(all_true(material.loses_stiffness(packed)), stretch < 1 / std::sqrt(3.0));
    }
  }
}

// Laws with fibres, in the form of principal stretches l: the fibres lie symmetric to the principal axes, so that
// P_i = dW/dl_i with W(l1, l2, l3). Written out for each law without its tensors.

/// mu (J^(-2/3) (l_i - I1/(3 l_i))) + K (J - 1) J/l_i.
Vector matrix_stress(double mu, double K, const Vector& l) {
  const double J = l.prod();
  Vector P;
  for (int i = 0; i < 3; ++i)
    P[i] = mu * std::pow(J, -2.0 / 3) * (l[i] - l.squaredNorm() / (3 * l[i])) + K * (J - 1) * J / l[i];
  return P;
}

/// Two families in the plane of l1 and l2 at +- angle from the first axis.
Vector principal_stress(const HolzapfelGasserOgden& law, double angle, const Vector& l) {
  const Vector weight =
      Vector::Constant(law.dispersion) +
      (1 - 3 * law.dispersion) * Vector(std::pow(std::cos(angle), 2), std::pow(std::sin(angle), 2), 0);
  const double E = weight.dot(l.cwiseProduct(l)) - 1;
  Vector P = matrix_stress(law.mu, law.bulk_modulus, l);
  if (E > 0) P += 2 * law.k1 * E * std::exp(law.k2 * E * E) * 2 * weight.cwiseProduct(l);
  return P;
}

Vector principal_stress(const MayNewman& law, const Vector& l) {
  const double I1 = std::pow(l.prod(), -2.0 / 3) * l.squaredNorm();
  const double whole = law.c0 * std::exp(law.c1 * std::pow(I1 - 3, 2) + law.c2 * std::pow(l[0] - 1, 4));
  Vector P = matrix_stress(law.matrix_shear_modulus + 4 * law.c1 * (I1 - 3) * whole, law.bulk_modulus, l);
  P[0] += 4 * law.c2 * std::pow(l[0] - 1, 3) * whole;
  return P;
}

/// The lateral stretches that leave the sides free of load, by Newton's method with slopes from differences.
template <class Stress>
Vector uniaxial_stretches(double stretch, const Stress& stress) {
  Vector l(stretch, 1 / std::sqrt(stretch), 1 / std::sqrt(stretch));
  for (int n = 0; n < 30; ++n) {
    const Vector P = stress(l);
    Eigen::Matrix2d slope;
    for (int j = 0; j < 2; ++j) {
      Vector up = l;
      up[j + 1] += 1e-7;
      const Vector change = (stress(up) - P) / 1e-7;
      slope.col(j) = Eigen::Vector2d(change[1], change[2]);
    }
    const Eigen::Vector2d correction = slope.inverse() * Eigen::Vector2d(P[1], P[2]);
    l -= Vector(0, correction[0], correction[1]);
  }
  return l;
}

/// The law itself with the same stretches along turned axes.
template <class M>
void expect_principal_stress(const M& law, const Vector& l, const Vector& expected) {
  const Matrix Q = Eigen::AngleAxisd(0.7, Vector(1, -2, 3).normalized()).toRotationMatrix();
  const Matrix P = matrix(law.stress(tensor(Q * l.asDiagonal() * Q.transpose()), axes_of(Q)));
  const Matrix along_axes = Q.transpose() * P * Q;
  EXPECT_LE((along_axes - Matrix(expected.asDiagonal())).cwiseAbs().maxCoeff(),
            1e-13 * (law.pressure_wave_modulus() + expected.norm()))
      << l.transpose();
}

TEST(HolzapfelGasserOgden, AnswersUniaxialLoadAsItsFormInPrincipalStretches) {
  for (const double dispersion : {0.0, 0.1, 1.0 / 3})
    for (const double angle : {0.0, 0.5, 1.2}) {
      const auto law = HolzapfelGasserOgden{3000, 100e3, 2363, 0.84, dispersion}.with_fibres_at(angle);
      for (const double stretch : {0.8, 1.1, 1.4}) {
        const auto stress = [&](const Vector& l) { return principal_stress(law, angle, l); };
        const Vector l = uniaxial_stretches(stretch, stress);
        EXPECT_LE(std::hypot(stress(l)[1], stress(l)[2]), 1e-9 * law.pressure_wave_modulus());  // Newton has converged
        expect_principal_stress(law, l, stress(l));
      }
    }
}

TEST(HolzapfelGasserOgden, FibresPullButNeverPush) {
  // Along aligned fibres, on both sides of rest: slack, the body is its matrix; tight, it is stiffer by 8 k1.
  const HolzapfelGasserOgden law{3000, 100e3, 2363, 0.84, 0};
  const NeoHookean matrix_law{3000, 100e3};
  const LocalAxes<double> axes = axes_of(Matrix::Identity());
  for (const double strain : {-0.2, -1e-6, 1e-6, 0.2}) {
    const Tensor<double> F = tensor(Vector(1 + strain, 1, 1).asDiagonal());
    const double extra = law.stress(F, axes).at[0][0] - matrix_law.stress(F).at[0][0];
    const double extra_stiffness = law.tangent(F, axes).at[0][0] - matrix_law.tangent(F).at[0][0];
    if (strain < 0) {
      EXPECT_NEAR(extra, 0, 1e-12 * law.k1);  // round-off
      EXPECT_NEAR(extra_stiffness, 0, 1e-10 * law.k1);
    } else {
      const double E = strain * (2 + strain);
      EXPECT_NEAR(extra, 2 * law.k1 * E * std::exp(law.k2 * E * E) * 2 * (1 + strain), 1e-9 * law.k1);
      EXPECT_GE(extra_stiffness, 8 * law.k1);
    }
  }
  // At rest itself they pull, whatever round-off the axes carry.
  const LocalAxes<double> shortened{{{1 - 1e-15, 0, 0}, {0, 1, 0}}};
  EXPECT_NEAR(law.tangent(tensor(Matrix::Identity()), shortened).at[0][0], law.pressure_wave_modulus(),
              1e-9 * law.pressure_wave_modulus());
}

TEST(HolzapfelGasserOgden, FullDispersionIsIsotropic) {
  const auto law = HolzapfelGasserOgden{3000, 100e3, 2363, 0.84, 1.0 / 3}.with_fibres_at(0.5);
  const Tensor<double> F = tensor((Matrix() << 1.2, 0.3, -0.1, 0.05, 0.95, 0.2, -0.15, 0.1, 1.1).finished());
  const Matrix Q = Eigen::AngleAxisd(0.7, Vector(1, -2, 3).normalized()).toRotationMatrix();
  EXPECT_LE((matrix(law.stress(F, axes_of(Q))) - matrix(law.stress(F, axes_of(Matrix::Identity())))).norm(),
            1e-13 * law.pressure_wave_modulus());
}

TEST(MayNewman, AnswersUniaxialLoadAsItsFormInPrincipalStretches) {
  // Anterior mitral leaflet [May-Newman, Yin 1998], and without the matrix term, which the paper does not have.
  for (const double matrix_shear_modulus : {0.0, 500.0}) {
    const MayNewman law{399, 4.325, 1446.5, matrix_shear_modulus, 1e6};
    for (const double stretch : {0.85, 1.1, 1.25}) {
      const auto stress = [&](const Vector& l) { return principal_stress(law, l); };
      const Vector l = uniaxial_stretches(stretch, stress);
      EXPECT_LE(std::hypot(stress(l)[1], stress(l)[2]), 1e-9 * law.pressure_wave_modulus());  // Newton has converged
      expect_principal_stress(law, l, stress(l));
    }
  }
}

TEST(MayNewman, HasTheShearStiffnessOfItsMatrixAtRest) {
  const LocalAxes<double> axes = axes_of(Matrix::Identity());
  for (const double matrix_shear_modulus : {0.0, 500.0}) {
    const MayNewman law{399, 4.325, 1446.5, matrix_shear_modulus, 1e6};
    EXPECT_NEAR(law.tangent(tensor(Matrix::Identity()), axes).at[1][1], matrix_shear_modulus, 1e-9);
  }
}

}  // namespace
}  // namespace couplet::solid
