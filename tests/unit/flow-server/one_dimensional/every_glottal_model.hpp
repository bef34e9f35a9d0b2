#pragma once
// The laws of flow through a glottis, for tests that hold for each of them.

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "flow-server/one_dimensional/glottal_flow.hpp"

namespace couplet::flow {

inline const auto every_model =
    ::testing::Values(GlottalModel::b1, GlottalModel::b2, GlottalModel::m1, GlottalModel::m2);

inline std::string name_of_model(const ::testing::TestParamInfo<GlottalModel>& model) {
  const std::array<std::string, 4> names{"B1", "B2", "M1", "M2"};
  return names[static_cast<std::size_t>(model.param)];
}

}  // namespace couplet::flow
