#pragma once
// The accepted state of a body on disk.

#include <cstdint>
#include <string>

#include "couplet/v1/scene.pb.h"
#include "solid-server/solid_model.hpp"

namespace couplet::solid {

/// What a state belongs to, as checksums.
struct SolidIdentity {
  std::uint32_t mesh = 0;   // positions of nodes, elements
  std::uint32_t scene = 0;  // the solid of the scene: materials, supports, contact, loads, method
};

SolidIdentity identity_of(const SolidMesh& mesh, const v1::Solid& solid);

/// Every number that the next step depends on. Throws FileError.
void write_checkpoint(const std::string& path, const SolidState& state, const SolidIdentity& identity);

struct StoredState {
  SolidState state;
  bool is_of_this_scene = true;  // false: no estimate of the stable step and no factors, which are of another solid
};

/// Throws FileError when the file belongs to another mesh than `identity`, to another wetted surface than that of
/// `like`, or is no checkpoint.
StoredState read_checkpoint(const std::string& path, const SolidState& like, const SolidIdentity& identity);

}  // namespace couplet::solid
