#pragma once
// Who may connect to a server whose links are encrypted.

#include <string>
#include <thread>
#include <zmq.hpp>

namespace couplet::wire {

/// CURVE alone keeps a link secret, and lets everybody in who knows the public key of the server. ZeroMQ asks this gate
/// about each that has proved to hold a key, and it lets in the one that holds the expected key. It must stand before
/// the server binds. Protocol: ZAP, https://rfc.zeromq.org/spec/27/
class CurveGate {
 public:
  CurveGate(zmq::context_t& context, const std::string& peer_public_key);
  CurveGate(const CurveGate&) = delete;
  CurveGate& operator=(const CurveGate&) = delete;
  ~CurveGate();

 private:
  void answer_all();

  std::string peer_key_;  // 32 bytes
  zmq::socket_t requests_, end_, told_to_end_;
  std::thread thread_;
};

}  // namespace couplet::wire
