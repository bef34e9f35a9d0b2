#include "solid-server/service/estimate_solid.hpp"

#include <gmock/gmock.h>

#include "tests/unit/solid-server/service/fold_scene.hpp"

namespace couplet::solid {
namespace {

TEST(Estimate, SaysHowBigAndHowLong) {
  const auto numbers = estimate_solid(request(solid_text), 1);
  EXPECT_THAT(names(numbers),
              testing::IsSupersetOf({"elements", "nodes", "degrees_of_freedom", "memory_bytes", "stable_step",
                                     "substeps_per_step", "seconds_per_substep", "seconds"}));
  for (const auto& number : numbers) EXPECT_NE(number.value > 0, !number.text.empty()) << number.name;
  EXPECT_EQ(text_of(numbers, "time_integration"), "CENTRAL_DIFFERENCE");
  EXPECT_EQ(text_of(numbers, "elements_of_body"), "24 of hexahedron20, 27 points, standard");
  EXPECT_GT(value_of(numbers, "degrees_of_freedom"), value_of(numbers, "nodes"));
  EXPECT_LT(value_of(numbers, "degrees_of_freedom"), 3 * value_of(numbers, "nodes"));  // supports hold some
}

TEST(Estimate, MeasuresImplicitAndStaticStepsByAFactorisation) {
  for (const char* const method : {"GENERALIZED_ALPHA", "STATIC"}) {
    auto implicit = request(solid_text);
    implicit.scene.mutable_solid()->clear_kick();
    v1::TimeIntegration::Method value{};
    ASSERT_TRUE(v1::TimeIntegration::Method_Parse(method, &value));
    implicit.scene.mutable_solid()->mutable_time_integration()->set_method(value);
    const auto numbers = estimate_solid(implicit, 1);
    EXPECT_EQ(text_of(numbers, "time_integration"), method);
    EXPECT_EQ(value_of(numbers, "substeps_per_step"), 1);
    EXPECT_NEAR(value_of(numbers, "seconds") / value_of(numbers, "seconds_per_step"), 50000, 1);  // 1 s of 2e-5 s
    EXPECT_GT(value_of(numbers, "memory_bytes"), value_of(estimate_solid(request(solid_text), 1), "memory_bytes"));
  }
}

TEST(Estimate, WarnsOfALongRunWithoutNumericalDissipation) {
  const auto warns = [](double spectral_radius, double end) {
    auto open = request(solid_text);
    open.scene.mutable_time()->set_end(end);
    auto* integration = open.scene.mutable_solid()->mutable_time_integration();
    integration->set_method(v1::TimeIntegration::GENERALIZED_ALPHA);
    integration->set_spectral_radius(spectral_radius);
    const auto found = names(estimate_solid(open, 1));
    return std::count(found.begin(), found.end(), "warning") == 1;
  };
  EXPECT_TRUE(warns(1, 1));
  EXPECT_FALSE(warns(0.99, 1));
  EXPECT_FALSE(warns(1, 100 * coupling_step));
}

}  // namespace
}  // namespace couplet::solid
