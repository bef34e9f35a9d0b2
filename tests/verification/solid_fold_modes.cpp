// The frequencies of the idealised vocal fold against an independent code (CalculiX 2.20, C3D20R, the same counts of
// elements, consistent mass): SVK, E = 15 kPa, nu = 0.475, 1040 kg/m^3.

#include <gtest/gtest.h>

#include "solid-server/dynamics/work_team.hpp"
#include "solid-server/element/mass.hpp"
#include "solid-server/mesh/parametric/vocal_fold_mesh.hpp"
#include "solid-server/modal/mirror_symmetry.hpp"
#include "solid-server/support/supports.hpp"

namespace couplet::solid {
namespace {

struct FoldModes {
  std::vector<Mode> modes;
  std::vector<Symmetry> along_z;  // about the plane across the middle of the length; empty of the half
};

FoldModes fold_modes(double medial_thickness, std::array<int, 3> n_elements, bool half_length, MassForm mass_form,
                     int n_modes) {
  VocalFoldShape shape;
  shape.section.medial_thickness = medial_thickness;
  shape.n_elements = n_elements;
  shape.half_length = half_length;
  Supports supports{{"lateral", "anterior"}, {}, {}};
  if (half_length)
    supports.symmetry = {{"posterior", 2}};
  else
    supports.fixed.push_back("posterior");
  const SolidMesh mesh = make_vocal_fold_mesh(shape);
  WorkTeam team(1);
  TangentSolver solver(mesh, {{SaintVenantKirchhoff::from_young(15e3, 0.475), 1040, 8}},
                       free_components(inverse_mass(mesh, lumped_mass(mesh, {1040}), supports)), team, mass_form);
  FoldModes found{modal_analysis(solver, NodeVectors::Zero(mesh.n_nodes(), 4), n_modes), {}};
  const MirrorPlane middle = middle_plane(mesh, 2);
  if (const auto mirrored = mirrored_nodes(mesh, middle); mirrored && !half_length)
    for (const Mode& mode : found.modes) found.along_z.push_back(symmetry_of(solver, mode, middle, *mirrored));
  return found;
}

void expect_frequencies(const std::vector<Mode>& found, const std::vector<double>& reference, double tolerance) {
  for (std::size_t n = 0; n < reference.size(); ++n)
    EXPECT_NEAR(found[n].frequency / reference[n], 1, tolerance) << found[n].frequency << " Hz, not " << reference[n];
}

// The two meshes differ in where nodes stand along the section: at equal counts that is worth a twelfth of the distance
// to the converged frequencies (0.6 % for the first); the reference has four or five digits.
constexpr double other_mesh = 6e-4;

TEST(VocalFoldModes, AgreeWithAnIndependentCodeForTheThinFold) {
  const FoldModes fold = fold_modes(1.75e-3, {6, 9, 12}, false, MassForm::consistent, 4);
  expect_frequencies(fold.modes, {73.28, 103.58, 120.78, 126.37}, other_mesh);
  EXPECT_EQ(fold.along_z,
            (std::vector{Symmetry::symmetric, Symmetry::antisymmetric, Symmetry::antisymmetric, Symmetry::symmetric}));
  // Shares of the kinetic energy along x, y, z of another code, given to two digits.
  const double share[4][3] = {{.92, .07, .01}, {.82, .10, .07}, {.05, .07, .88}, {.41, .58, .02}};
  for (std::size_t mode = 0; mode < 4; ++mode)
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(fold.modes[mode].direction_share[axis], share[mode][axis], 0.015) << mode << " " << axis;
}

TEST(VocalFoldModes, AgreeWithAnIndependentCodeForTheThickFold) {
  const FoldModes fold = fold_modes(3.5e-3, {6, 9, 12}, false, MassForm::consistent, 4);
  expect_frequencies(fold.modes, {72.35, 104.70, 119.36, 124.35}, other_mesh);
}

TEST(VocalFoldModes, OfTheHalfAreTheSymmetricOnesOfTheWhole) {
  const FoldModes half = fold_modes(1.75e-3, {4, 6, 8}, true, MassForm::lumped, 2),
                  whole = fold_modes(1.75e-3, {4, 6, 8}, false, MassForm::lumped, 4);
  EXPECT_NEAR(half.modes[0].frequency, whole.modes[0].frequency, 1e-8 * whole.modes[0].frequency);
  EXPECT_NEAR(half.modes[1].frequency, whole.modes[3].frequency, 1e-8 * whole.modes[3].frequency);
}

TEST(VocalFoldModes, OfTheLumpedMassApproachTheConvergedOnesFromBelow) {
  // Converged: 72.8 and 126.15 Hz (first and second symmetric mode).
  const std::vector<double> converged = {72.8, 126.15};
  const auto errors = [&](std::array<int, 3> n_elements) {
    const FoldModes half = fold_modes(1.75e-3, n_elements, true, MassForm::lumped, 2);
    return std::vector{1 - half.modes[0].frequency / converged[0], 1 - half.modes[1].frequency / converged[1]};
  };
  const auto coarse = errors({4, 6, 8}), fine = errors({6, 9, 12});
  for (const std::size_t mode : {std::size_t{0}, std::size_t{1}}) {
    EXPECT_GT(coarse[mode], fine[mode]);
    EXPECT_LT(fine[mode], 0.015);
    EXPECT_GT(fine[mode], -0.002);  // the accuracy of the converged figures
  }
}

}  // namespace
}  // namespace couplet::solid
