// The frequencies of the idealised vocal fold against an independent code (CalculiX 2.20, C3D20R, the same counts of
// elements, consistent mass): SVK, E = 15 kPa, nu = 0.475, 1040 kg/m^3.

#include <gtest/gtest.h>

#include "solid-server/mesh/vocal_fold_mesh.hpp"
#include "tests/verification/solid_modes.hpp"

namespace couplet::solid {
namespace {

FreeVibration fold_vibration(double medial_thickness, std::array<int, 3> n_elements, bool half_length) {
  VocalFoldShape shape;
  shape.section.medial_thickness = medial_thickness;
  shape.n_elements = n_elements;
  shape.half_length = half_length;
  Supports supports{{"lateral", "anterior"}, {}};
  if (half_length)
    supports.symmetry = {{"posterior", 2}};
  else
    supports.fixed.push_back("posterior");
  return free_vibration(make_vocal_fold_mesh(shape), {SaintVenantKirchhoff::from_young(15e3, 0.475), 1040, 8},
                        supports);
}

void expect_frequencies(const std::vector<double>& found, const std::vector<double>& reference, double tolerance) {
  for (std::size_t n = 0; n < reference.size(); ++n)
    EXPECT_NEAR(found[n] / reference[n], 1, tolerance) << found[n] << " Hz, not " << reference[n];
}

// The two meshes differ in where nodes stand along the section: at equal counts that is worth a tenth of the distance
// to the converged frequencies (0.6 % for the first).
constexpr double other_mesh = 3e-3;

TEST(VocalFoldModes, AgreeWithAnIndependentCodeForTheThinFold) {
  const FreeVibration fold = fold_vibration(1.75e-3, {6, 9, 12}, false);
  expect_frequencies(lowest_frequencies(fold.stiffness, fold.consistent_mass, 4), {73.28, 103.58, 120.78, 126.37},
                     other_mesh);
}

TEST(VocalFoldModes, AgreeWithAnIndependentCodeForTheThickFold) {
  const FreeVibration fold = fold_vibration(3.5e-3, {6, 9, 12}, false);
  expect_frequencies(lowest_frequencies(fold.stiffness, fold.consistent_mass, 4), {72.35, 104.70, 119.36, 124.35},
                     other_mesh);
}

TEST(VocalFoldModes, OfTheHalfAreTheSymmetricOnesOfTheWhole) {
  const FreeVibration half = fold_vibration(1.75e-3, {4, 6, 8}, true),
                      whole = fold_vibration(1.75e-3, {4, 6, 8}, false);
  const auto symmetric = lowest_frequencies(half.stiffness, half.lumped_mass, 2);
  const auto all = lowest_frequencies(whole.stiffness, whole.lumped_mass, 4);
  EXPECT_NEAR(symmetric[0], all[0], 1e-8 * all[0]);
  EXPECT_NEAR(symmetric[1], all[3], 1e-8 * all[3]);
}

TEST(VocalFoldModes, OfTheLumpedMassApproachTheConvergedOnesFromBelow) {
  // Converged: 72.8 and 126.15 Hz (first and second symmetric mode).
  const std::vector<double> converged = {72.8, 126.15};
  const auto error = [&](std::array<int, 3> n_elements, std::size_t mode) {
    const FreeVibration half = fold_vibration(1.75e-3, n_elements, true);
    return 1 - lowest_frequencies(half.stiffness, half.lumped_mass, 2)[mode] / converged[mode];
  };
  for (const std::size_t mode : {std::size_t{0}, std::size_t{1}}) {
    const double coarse = error({4, 6, 8}, mode), fine = error({6, 9, 12}, mode);
    EXPECT_GT(coarse, fine);
    EXPECT_LT(fine, 0.015);
    EXPECT_GT(fine, -0.002);  // the accuracy of the converged figures
  }
}

}  // namespace
}  // namespace couplet::solid
