#pragma once

#include "couplet/v1/geometry.pb.h"
#include "proto/scene/time_table.hpp"

namespace couplet::scene {

TimeTable make_time_table(const v1::TimeTable& table);

}  // namespace couplet::scene
