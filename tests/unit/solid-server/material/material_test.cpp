// Every member of Material is tested against what any hyperelastic law must satisfy.

#include "solid-server/material/material.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>

#include "tests/unit/solid-server/material/material_examples.hpp"

namespace couplet::solid {
namespace {

template <class Variant>
struct TestTypes;
template <class... Members>
struct TestTypes<std::variant<Members...>> {
  using Type = testing::Types<Members...>;
};

Matrix rotation(double angle, const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

template <class M>
class AnyMaterial : public testing::Test {
 protected:
  const M material = example<M>();
  const double stiffness = material.pressure_wave_modulus();  // what stresses are compared with
  const Matrix directions = rotation(0.4, {1, 2, -1});        // of the tissue, at rest
  const Matrix strained = (Matrix() << 1.2, 0.3, -0.1, 0.05, 0.85, 0.2, -0.15, 0.1, 1.1).finished();
  /// Fibres pulled, partly pulled and slack: along the axes, and not.
  const std::array<Matrix, 4> states = {
      strained, directions* Eigen::Vector3d(1.3, 0.9, 0.8).asDiagonal() * directions.transpose(),
      directions* Eigen::Vector3d(0.8, 0.9, 1.3).asDiagonal() * directions.transpose(), 0.8 * strained};

  double energy(const Matrix& F) const { return energy_of(material, tensor(F), axes_of(directions)); }
  Matrix stress(const Matrix& F) const { return matrix(stress_of(material, tensor(F), axes_of(directions))); }
  Tangent tangent(const Matrix& F) const { return as_matrix(tangent_of(material, tensor(F), axes_of(directions))); }

  /// Central differences over h = 1e-5 leave h^2 of truncation and 1e-16 / h of round-off, times the size of
  /// derivatives.
  double difference_error(const Matrix& F) const { return 1e-8 * (stiffness + tangent(F).cwiseAbs().maxCoeff()); }
  static constexpr double h = 1e-5;
};
TYPED_TEST_SUITE(AnyMaterial, TestTypes<Material>::Type);

TYPED_TEST(AnyMaterial, StressIsTheDerivativeOfTheEnergy) {
  for (const Matrix& F : this->states) {
    const Matrix P = this->stress(F);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        Matrix up = F, down = F;
        up(i, j) += this->h;
        down(i, j) -= this->h;
        EXPECT_NEAR(P(i, j), (this->energy(up) - this->energy(down)) / (2 * this->h), this->difference_error(F));
      }
  }
}

TYPED_TEST(AnyMaterial, TangentIsTheDerivativeOfTheStress) {
  for (const Matrix& F : this->states) {
    const Tangent tangent = this->tangent(F);
    for (int column = 0; column < 9; ++column) {
      Matrix up = F, down = F;
      up(column / 3, column % 3) += this->h;
      down(column / 3, column % 3) -= this->h;
      const Matrix slope = (this->stress(up) - this->stress(down)) / (2 * this->h);
      for (int row = 0; row < 9; ++row)
        EXPECT_NEAR(tangent(row, column), slope(row / 3, row % 3), this->difference_error(F)) << row << ", " << column;
    }
  }
}

TYPED_TEST(AnyMaterial, TangentIsSymmetric) {
  for (const Matrix& F : this->states) {
    const Tangent tangent = this->tangent(F);
    EXPECT_EQ(tangent, tangent.transpose());  // one half is copied to the other
  }
}

TYPED_TEST(AnyMaterial, DoesNotFeelARotationOfTheObserver) {
  const Matrix Q = rotation(0.7, {1, -2, 3});
  for (const Matrix& F : this->states) {
    const double round_off = 1e-13 * (this->stiffness + this->tangent(F).cwiseAbs().maxCoeff());
    EXPECT_NEAR(this->energy(Q * F), this->energy(F), round_off);
    EXPECT_LE((this->stress(Q * F) - Q * this->stress(F)).cwiseAbs().maxCoeff(), round_off);
  }
}

TYPED_TEST(AnyMaterial, DoesNotFeelARotationOfTheBodyAtRestWithItsAxes) {
  // Isotropic laws are not told the axes: for them this is a rotation of the body alone.
  const Matrix Q = rotation(1.9, {3, 1, 2});
  const LocalAxes<double> turned = axes_of(Q * this->directions);
  for (const Matrix& F : this->states) {
    const Tensor<double> G = tensor(F * Q.transpose());
    const double round_off = 1e-13 * (this->stiffness + this->tangent(F).cwiseAbs().maxCoeff());
    EXPECT_NEAR(energy_of(this->material, G, turned), this->energy(F), round_off);
    EXPECT_LE((matrix(stress_of(this->material, G, turned)) - this->stress(F) * Q.transpose()).cwiseAbs().maxCoeff(),
              round_off);
  }
}

TYPED_TEST(AnyMaterial, FeelsARotationOfTheBodyAloneIfAndOnlyIfItIsAnisotropic) {
  const Matrix Q = rotation(1.9, {3, 1, 2});
  const Matrix change = this->stress(this->strained * Q.transpose()) - this->stress(this->strained) * Q.transpose();
  EXPECT_EQ(change.cwiseAbs().maxCoeff() > 1e-3 * this->material.shear_modulus(), TypeParam::is_anisotropic);
}

TYPED_TEST(AnyMaterial, IsFreeOfStressAndEnergyAtRest) {
  EXPECT_LE(this->stress(Matrix::Identity()).cwiseAbs().maxCoeff(), 1e-14 * this->stiffness);
  EXPECT_NEAR(this->energy(Matrix::Identity()), 0, 1e-14 * this->stiffness);
}

TYPED_TEST(AnyMaterial, WavesAtRestAreNotFasterThanThePressureWaveModulusSays) {
  // rho c^2 of the waves along N are the eigenvalues of T_iJkL N_J N_L.
  const Tangent T = this->tangent(Matrix::Identity());
  double fastest = 0;
  for (double height = -1; height <= 1; height += 0.05)
    for (double angle = 0; angle < 2 * M_PI; angle += 0.05) {
      const double radius = std::sqrt(std::max(0.0, 1 - height * height));
      const Eigen::Vector3d N =
          this->directions * Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), height);
      Matrix acoustic = Matrix::Zero();
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) acoustic(i, k) = N.dot(T.block<3, 3>(3 * i, 3 * k) * N);
      const double largest = Eigen::SelfAdjointEigenSolver<Matrix>(acoustic).eigenvalues()[2];
      if (!TypeParam::is_anisotropic) {
        EXPECT_NEAR(largest, this->stiffness, 1e-12 * this->stiffness);
      }
      fastest = std::max(fastest, largest);
    }
  EXPECT_LE(fastest, (1 + 1e-12) * this->stiffness);
  EXPECT_GE(fastest, 0.95 * this->stiffness);  // a bound, but not one that halves the stable step
}

TYPED_TEST(AnyMaterial, StartsWithTheModuliThatItNames) {
  // Just compressed, so that fibres are slack: dP11/dF22 = K - 2/3 mu, dP12/dF12 = mu, up to the strain of 1e-6 itself.
  const Tangent T = this->tangent((1 - 1e-6) * Matrix::Identity());
  const double K = this->material.bulk_modulus_at_rest(), mu = this->material.shear_modulus();
  EXPECT_NEAR(T(0, 4), K - 2.0 / 3 * mu, 1e-5 * K);
  EXPECT_NEAR(T(1, 1), mu, 1e-5 * K);
  EXPECT_NEAR(T(0, 0), K + 4.0 / 3 * mu, 1e-5 * K);
}

TYPED_TEST(AnyMaterial, VolumetricPartAndTheRestAddUp) {
  if constexpr (TypeParam::has_volumetric_part) {
    const TypeParam whole = this->material, rest = whole.without_volumetric_part();
    for (const Matrix& F : this->states) {
      const double J = F.determinant(), p = whole.volumetric_part().pressure(J), round_off = 1e-13 * this->stiffness;
      EXPECT_NEAR(whole.volumetric_part().energy(J + this->h) - whole.volumetric_part().energy(J - this->h),
                  2 * this->h * p, 1e-12 * this->stiffness);
      EXPECT_NEAR(whole.volumetric_part().pressure(J + this->h) - whole.volumetric_part().pressure(J - this->h),
                  2 * this->h * whole.volumetric_part().stiffness(J), 1e-12 * this->stiffness);

      const Matrix cof = J * F.inverse().transpose();
      const LocalAxes<double> axes = axes_of(this->directions);
      EXPECT_NEAR(energy_of(rest, tensor(F), axes) + whole.volumetric_part().energy(J), this->energy(F), round_off);
      EXPECT_LE((matrix(stress_of(rest, tensor(F), axes)) + p * cof - this->stress(F)).cwiseAbs().maxCoeff(),
                round_off);
      Tangent T = as_matrix(tangent_of(rest, tensor(F), axes));
      for (int row = 0; row < 9; ++row)
        for (int column = 0; column < 9; ++column) {
          const int i = row / 3, A = row % 3, k = column / 3, B = column % 3;
          // d cof_iA / dF_kB = (cof_iA cof_kB - cof_iB cof_kA) / J
          T(row, column) += whole.volumetric_part().stiffness(J) * cof(i, A) * cof(k, B) +
                            p * (cof(i, A) * cof(k, B) - cof(i, B) * cof(k, A)) / J;
        }
      EXPECT_LE((T - this->tangent(F)).cwiseAbs().maxCoeff(), 1e-13 * this->tangent(F).cwiseAbs().maxCoeff());
    }
    EXPECT_EQ(rest.volumetric_part().stiffness(1.0), 0);
  }
}

TYPED_TEST(AnyMaterial, AnswersEightPointsAsItAnswersOne) {
  // Volume ratios from a tenth to five: inside and outside the range of the fast cube root; each lane with axes of its
  // own.
  Tensor<Pack> packed;
  LocalAxes<Pack> packed_axes;
  std::array<Tensor<double>, n_lanes> single;
  std::array<LocalAxes<double>, n_lanes> axes;
  for (int lane = 0; lane < n_lanes; ++lane) {
    const auto n = static_cast<std::size_t>(lane);
    single[n] = tensor(this->strained * std::cbrt(0.1 + 0.7 * lane));
    axes[n] = axes_of(rotation(0.3 * lane, {1, 2, -1}));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) packed.at[i][j][lane] = single[n].at[i][j];
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 3; ++j) packed_axes.at[i][j][lane] = axes[n].at[i][j];
  }
  const Pack W = energy_of(this->material, packed, packed_axes);
  const Tensor<Pack> P = stress_of(this->material, packed, packed_axes);
  const BasicTangent<Pack> T = tangent_of(this->material, packed, packed_axes);
  for (int lane = 0; lane < n_lanes; ++lane) {
    const auto n = static_cast<std::size_t>(lane);
    const Matrix stress = matrix(stress_of(this->material, single[n], axes[n]));
    const Tangent tangent = as_matrix(tangent_of(this->material, single[n], axes[n]));
    const double energy = energy_of(this->material, single[n], axes[n]);
    // Round-off of the terms, which cancel each other, and of exponents of 20 or so, which turn it into 20 times as
    // much.
    const double scale = 1e-14 * this->stiffness * std::pow(matrix(single[n]).norm(), 3);
    EXPECT_NEAR(W[lane], energy, scale + 1e-13 * energy);
    for (int row = 0; row < 9; ++row)
      EXPECT_NEAR(P.at[row / 3][row % 3][lane], stress(row / 3, row % 3), scale + 1e-13 * stress.norm());
    for (int row = 0; row < 9; ++row)
      for (int column = 0; column < 9; ++column)
        EXPECT_NEAR(T.at[row][column][lane], tangent(row, column), 10 * scale + 1e-13 * tangent.norm());
  }
}

}  // namespace
}  // namespace couplet::solid
