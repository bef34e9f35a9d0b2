#pragma once
// Whether the point that a scene names is a point of the solid.

#include "couplet/v1/scene.pb.h"
#include "proto/scene/review.hpp"

namespace couplet::scene {

/// Complains when the marker is none of the solid's meshes. A scene without a solid has no markers to compare with.
void check_marker(const v1::MaterialPoint& point, const std::string& path, const v1::Solid& solid, Review& review);

}  // namespace couplet::scene
