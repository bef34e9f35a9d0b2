#pragma once
// Addresses of ZeroMQ end points, as a user writes them: tcp://HOST:PORT, ipc://PATH, ipc://@NAME.

#include <string>

namespace couplet::wire {

/// Throws SceneError when it is none of these. PORT may be * (or 0), HOST may be *, for a server that binds.
void check_zeromq_address(const std::string& address);

/// Whether only programs of this machine can reach a server that binds there: ipc, or tcp on 127.0.0.0/8, ::1,
/// localhost.
bool is_local_address(const std::string& address);

}  // namespace couplet::wire
