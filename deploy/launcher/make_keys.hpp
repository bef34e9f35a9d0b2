#pragma once
// The verb `keys`: key pairs for encrypted, authenticated runs across hosts.

#include <filesystem>

namespace couplet::launcher {

/// Writes coupler.key, coupler.pub, flow-server.key, flow-server.pub, solid-server.key and solid-server.pub into the
/// folder, which is made if needed. Secret keys can be read by their owner only. Existing keys are never replaced:
/// throws SceneError.
void make_keys(const std::filesystem::path& folder);

}  // namespace couplet::launcher
