#include "proto/wire/connection_watch.hpp"

#include <cstdint>
#include <cstring>
#include <string>

namespace couplet::wire {

namespace {

constexpr int failures =
    ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL | ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL | ZMQ_EVENT_HANDSHAKE_FAILED_AUTH;
constexpr int what_is_reported =
    ZMQ_EVENT_ACCEPTED | ZMQ_EVENT_CONNECTED | ZMQ_EVENT_HANDSHAKE_SUCCEEDED | ZMQ_EVENT_DISCONNECTED | failures;

}  // namespace

ConnectionWatch::ConnectionWatch(zmq::context_t& context, zmq::socket_t& watched)
    : watched_(watched), events_(context, ZMQ_PAIR) {
  const std::string address = "inproc://connection-watch";  // one socket a context, so one name is enough
  if (zmq_socket_monitor(watched.handle(), address.c_str(), what_is_reported) != 0) throw zmq::error_t();
  events_.set(zmq::sockopt::linger, 0);
  events_.connect(address);
}

ConnectionWatch::~ConnectionWatch() {
  zmq_socket_monitor(watched_.handle(), nullptr, 0);
}

void ConnectionWatch::read(bool follow_first) {
  zmq::message_t event, address;
  while (events_.recv(event, zmq::recv_flags::dontwait)) {
    if (event.more()) (void)events_.recv(address, zmq::recv_flags::none);
    std::uint16_t what;  // layout of an event: zmq_socket_monitor(3)
    std::int32_t connection;
    if (event.size() < sizeof what + sizeof connection) continue;
    std::memcpy(&what, event.data(), sizeof what);
    std::memcpy(&connection, static_cast<const char*>(event.data()) + sizeof what, sizeof connection);
    if (what == ZMQ_EVENT_ACCEPTED || what == ZMQ_EVENT_CONNECTED) {
      alive_.insert(connection);
    } else if (what == ZMQ_EVENT_DISCONNECTED) {
      alive_.erase(connection);
      followed_.erase(connection);
    } else if ((what & failures) != 0) {
      ++n_failed_;
    } else if (follow_first && !has_followed_) {
      // The first handshake: whoever answers there speaks ZeroMQ. The event does not say on which connection.
      followed_ = alive_;
      has_followed_ = true;
    }
  }
}

void ConnectionWatch::follow_sender(const zmq::message_t& message) {
  read(false);
  followed_ = alive_;
  has_followed_ = true;
  const int connection = zmq_msg_get(message.handle(), ZMQ_SRCFD);
  if (connection < 0) return;
  followed_.clear();
  if (alive_.count(connection) > 0) followed_.insert(connection);
}

}  // namespace couplet::wire
