#pragma once
// Which connections of a ZeroMQ socket live: the socket's own thread reports each that comes and goes.

#include <set>
#include <zmq.hpp>

namespace couplet::wire {

class ConnectionWatch {
 public:
  ConnectionWatch(zmq::context_t& context, zmq::socket_t& watched);
  ConnectionWatch(const ConnectionWatch&) = delete;
  ConnectionWatch& operator=(const ConnectionWatch&) = delete;
  ~ConnectionWatch();

  /// For poll: readable when something was reported.
  zmq::socket_t& socket() { return events_; }

  /// Takes in what was reported since the last call. With `follow_first` the first connection
  /// that speaks ZeroMQ is followed.
  void read(bool follow_first);

  /// From now on is_lost() speaks of the connection that this message came by. ZeroMQ tells which one that is for tcp
  /// only; for ipc it speaks of all that are open now, of which there is one unless a stranger is there as well.
  void follow_sender(const zmq::message_t& message);

  bool has_followed() const { return has_followed_; }
  /// Connections that came to nothing: the program there has other keys, or none, or does not speak ZeroMQ.
  int n_failed() const { return n_failed_; }
  bool is_lost() const { return has_followed_ && followed_.empty(); }

 private:
  zmq::socket_t& watched_;
  zmq::socket_t events_;
  std::set<int> alive_;     // file descriptors
  std::set<int> followed_;  // never grows again: a peer that comes back has forgotten the session
  bool has_followed_ = false;
  int n_failed_ = 0;
};

}  // namespace couplet::wire
