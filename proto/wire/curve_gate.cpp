#include "proto/wire/curve_gate.hpp"

#include <zmq.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <vector>

#include "proto/wire/curve_keys.hpp"

namespace couplet::wire {

namespace {

// Frames of a request: version, request id, domain, address, identity, mechanism, then the key (ZAP).
enum : std::size_t { request_id = 1, mechanism = 5, key = 6, n_frames = 7 };

std::vector<std::string> take(zmq::socket_t& socket) {
  std::vector<std::string> frames;
  zmq::message_t part;
  do {
    if (!socket.recv(part, zmq::recv_flags::none)) return {};
    frames.push_back(part.to_string());
  } while (part.more());
  return frames;
}

}  // namespace

CurveGate::CurveGate(zmq::context_t& context, const std::string& peer_public_key)
    : peer_key_(curve_key_bytes, '\0'),
      requests_(context, ZMQ_REP),
      end_(context, ZMQ_PAIR),
      told_to_end_(context, ZMQ_PAIR) {
  zmq_z85_decode(reinterpret_cast<std::uint8_t*>(peer_key_.data()), peer_public_key.c_str());
  requests_.set(zmq::sockopt::linger, 0);
  requests_.bind("inproc://zeromq.zap.01");
  told_to_end_.bind("inproc://curve-gate-end");
  end_.connect("inproc://curve-gate-end");
  sigset_t all, before;  // signals are for the thread that computes
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::thread([this] { answer_all(); });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

CurveGate::~CurveGate() {
  end_.send(zmq::message_t(), zmq::send_flags::none);
  thread_.join();
}

void CurveGate::answer_all() {
  std::array<zmq::pollitem_t, 2> looked_at{{{requests_, 0, ZMQ_POLLIN, 0}, {told_to_end_, 0, ZMQ_POLLIN, 0}}};
  while (true) {
    zmq::poll(looked_at.data(), looked_at.size(), std::chrono::milliseconds(-1));
    if (looked_at[1].revents != 0) return;
    const std::vector<std::string> request = take(requests_);
    const bool is_whole = request.size() >= n_frames && request[mechanism] == "CURVE";
    const bool is_known = is_whole && request[key] == peer_key_;
    const std::string id = request.size() > request_id ? request[request_id] : "";
    for (const std::string& text : {std::string("1.0"), id, std::string(is_known ? "200" : "400"),
                                    std::string(is_known ? "OK" : "unknown key"), std::string()})
      requests_.send(zmq::buffer(text), zmq::send_flags::sndmore);
    requests_.send(zmq::message_t(), zmq::send_flags::none);  // no metadata
  }
}

}  // namespace couplet::wire
