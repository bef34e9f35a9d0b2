#pragma once
// The reference of the scene language, from the schema itself.

#include <string>

namespace couplet::scene {

/// Every field of a message (Scene when empty) with type, unit, default, limits and meaning, messages it is made of
/// included. Throws SceneError naming the nearest message when there is none of that name.
std::string describe_schema(const std::string& message);

}  // namespace couplet::scene
