#pragma once
// A scene without fault, and what is complained about when a part of it is replaced.

#include <string>
#include <vector>

namespace couplet::scene {

extern const std::string good_scene;

/// The good scene with a part, that stands there exactly once, replaced.
std::string with(const std::string& part, const std::string& replacement, const std::string& scene = good_scene);

/// Every complaint about a scene that is called scene.txtpb.
std::vector<std::string> complaints_about(const std::string& text, const std::vector<std::string>& settings = {});

}  // namespace couplet::scene
