#include "solid-server/service/mesh_size.hpp"

#include <gtest/gtest.h>

#include "proto/report/failure.hpp"
#include "solid-server/service/make_setup.hpp"
#include "tests/unit/solid-server/service/fold_scene.hpp"

namespace couplet::solid {
namespace {

TEST(MeshSize, RefusesWhatCannotBeNumberedOrHeld) {
  auto large = request(solid_text).scene.solid();
  auto& fold = *large.mutable_body(0)->mutable_vocal_fold();
  EXPECT_NO_THROW(refuse_too_many_elements(large, 1e9));
  EXPECT_EQ(n_elements_wanted(large.body(0)), 24);
  EXPECT_EQ(make_setup(large, ".").mesh.n_elements(), 24);
  fold.set_elements_x(100);
  fold.set_elements_y(100);
  fold.set_elements_z(100);
  const auto message = [&](double memory) -> std::string {
    try {
      refuse_too_many_elements(large, memory);
    } catch (const report::SceneError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message(1e9), "");
  EXPECT_EQ(message(5e8),
            "solid.body[0].vocal_fold: 500000 elements need at least 1 GB of memory, but this machine has 0 GB; give "
            "fewer elements");
  fold.set_elements_x(1000);
  fold.set_elements_y(1000);
  fold.set_elements_z(1000);
  EXPECT_EQ(message(1e15),
            "solid.body[0].vocal_fold: 5e+08 elements are more than the 107 million that can be numbered; give fewer "
            "elements");
}

}  // namespace
}  // namespace couplet::solid
