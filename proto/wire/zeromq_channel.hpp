#pragma once
// A channel over ZeroMQ sockets: between processes of one machine (ipc, tcp) or of several (tcp).

#include <memory>
#include <optional>
#include <string>

#include "proto/wire/channel.hpp"
#include "proto/wire/curve_keys.hpp"

namespace couplet::wire {

struct ZeromqOptions {
  double heartbeat_deadline = 8;  // [s] a peer without sign of life for this time is lost
  double connect_deadline = 60;   // [s] a peer that has not appeared after this time will not come
  std::optional<CurveKeys> keys;  // with them the link is encrypted, and each end knows that the other is the right one
};

/// The server's end: a ROUTER that binds. The first program that sends a message is the peer; messages of others are
/// dropped with one line on standard error; with keys only the program with the right key can send one. describe() is
/// the bound address with its port. Throws SceneError when the address is malformed, or reachable from other machines
/// without keys, PeerError when it cannot be bound.
std::unique_ptr<Channel> listen_zeromq(const std::string& address, const ZeromqOptions& options);

/// The coupler's end: a DEALER that connects. It returns at once; the server may appear up to the connect deadline
/// later. Throws SceneError when the address is malformed, or on another machine without keys.
std::unique_ptr<Channel> connect_zeromq(const std::string& address, const ZeromqOptions& options);

}  // namespace couplet::wire
