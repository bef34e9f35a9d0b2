#include "proto/surface/surface_field.hpp"

#include <gtest/gtest.h>

#include "proto/report/failure.hpp"

namespace couplet::surface {
namespace {

TEST(SurfaceField, IsFoundByName) {
  const FieldSet fields{{"force", "N", NodeArray::Ones(2, 3)}, {"velocity", "m/s", NodeArray::Zero(2, 3)}};
  EXPECT_EQ(find_field(fields, "velocity").unit, "m/s");
}

TEST(SurfaceField, MissingOneIsNamedBesideThosePresent) {
  const auto message = [](const FieldSet& fields) -> std::string {
    try {
      find_field(fields, "displacement");
    } catch (const report::PeerError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(
      message({{"force", "N", NodeArray(0, 3)}, {"velocity", "m/s", NodeArray(0, 3)}}),
      "the field 'displacement' is missing; present: force, velocity; check that flow and solid offer what the other "
      "needs");
  EXPECT_EQ(message({}),
            "the field 'displacement' is missing; present: none; check that flow and solid offer what the other needs");
}

}  // namespace
}  // namespace couplet::surface
