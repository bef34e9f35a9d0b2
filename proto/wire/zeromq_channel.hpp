#pragma once
// A channel over ZeroMQ sockets: between processes of one machine (ipc, tcp) or of several (tcp).

#include <memory>
#include <string>

#include "proto/wire/channel.hpp"

namespace couplet::wire {

struct ZeromqOptions {
  double heartbeat_deadline = 8;  // [s] a peer without sign of life for this time is lost
  double connect_deadline = 60;   // [s] a peer that has not appeared after this time will not come
  bool allow_remote = false;      // a server may bind to an address that other machines reach
};

/// The server's end: a ROUTER that binds. The first program that sends a message is the peer; messages of others are
/// dropped with one line on standard error. describe() is the bound address with its port. Throws SceneError when the
/// address is malformed or reachable from other machines without allow_remote, PeerError when it cannot be bound.
std::unique_ptr<Channel> listen_zeromq(const std::string& address, const ZeromqOptions& options);

/// The coupler's end: a DEALER that connects. It returns at once; the server may appear up to the connect deadline
/// later. Throws SceneError when the address is malformed.
std::unique_ptr<Channel> connect_zeromq(const std::string& address, const ZeromqOptions& options);

}  // namespace couplet::wire
