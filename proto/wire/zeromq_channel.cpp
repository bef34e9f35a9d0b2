#include "proto/wire/zeromq_channel.hpp"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstdio>
#include <utility>
#include <zmq.hpp>

#include "proto/report/failure.hpp"
#include "proto/wire/back_off.hpp"
#include "proto/wire/connection_watch.hpp"
#include "proto/wire/curve_gate.hpp"
#include "proto/wire/keep_memory.hpp"
#include "proto/wire/zeromq_address.hpp"

namespace couplet::wire {

namespace {

using Clock = std::chrono::steady_clock;
using Parts = std::vector<zmq::message_t>;

// A frame of this size or more is handed to ZeroMQ as it is; a smaller one is cheaper to copy.
constexpr std::size_t handed_over = 4096;  // [bytes]

// What is still unsent when a channel ends may take this long to leave; a program's exit never hangs longer.
constexpr int linger = 2000;  // [ms]

// One request is unanswered at any time; more than a few messages that wait can only come from somebody who means no
// good.
constexpr int messages_waiting = 4;

// Of programs that are turned away; whoever knocks for days must not fill the disk.
constexpr int lines_at_most = 20;

// A blocking receive is several times quicker than a poll of socket and watch together, so the watch is asked this
// often.
constexpr std::chrono::milliseconds glance(50);

zmq::message_t make_part(Frame frame) {
  if (frame.size() < handed_over) return {frame.data(), frame.size()};
  auto* kept = new Frame(std::move(frame));  // given back by ZeroMQ's own thread when the bytes have left
  return {kept->data(), kept->size(), [](void*, void* owner) { delete static_cast<Frame*>(owner); }, kept};
}

Frame make_frame(zmq::message_t part) {
  if (part.size() < handed_over) return Frame::copy_of(part.data(), part.size());
  const auto owner = std::make_shared<zmq::message_t>(std::move(part));
  return Frame::inside(owner, owner->data(), owner->size());
}

std::string seconds_text(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%g s", seconds);
  return text;
}

// What both ends have in common: whole messages, and waiting with one eye on the connection.
class ZeromqChannel : public Channel {
 public:
  ZeromqChannel(zmq::socket_type type, const ZeromqOptions& options)
      : options_(options),
        socket_(context_, type),
        watch_(context_, socket_),
        connect_deadline_(deadline_in(options.connect_deadline)) {
    keep_freed_memory();
    // A silent peer is found after interval + timeout, three quarters of the deadline.
    const int quarter = std::clamp(static_cast<int>(250 * options.heartbeat_deadline), 1, 1600000);  // [ms]
    socket_.set(zmq::sockopt::heartbeat_ivl, quarter);
    socket_.set(zmq::sockopt::heartbeat_timeout, 2 * quarter);
    socket_.set(zmq::sockopt::heartbeat_ttl, std::max(100, 4 * quarter));
    socket_.set(zmq::sockopt::linger, linger);
    socket_.set(zmq::sockopt::sndtimeo, static_cast<int>(glance.count()));
    socket_.set(zmq::sockopt::maxmsgsize, static_cast<std::int64_t>(frame_size_limit));
    socket_.set(zmq::sockopt::rcvhwm, messages_waiting);
    if (!options.keys) return;
    socket_.set(zmq::sockopt::curve_secretkey, options.keys->secret_key);
    socket_.set(zmq::sockopt::curve_publickey, options.keys->public_key);
  }

  void send(Frames message) override {
    assert(!message.empty());
    if (is_lost()) throw lost();  // a quick exchange never waits, so that this is where news of connections is heard
    for (zmq::message_t& part : envelope()) send_part(part, true);
    for (std::size_t i = 0; i < message.size(); ++i) {
      zmq::message_t part = make_part(std::move(message[i]));
      send_part(part, i + 1 < message.size());
    }
  }

  std::optional<Frames> receive(Deadline deadline) override {
    for (BackOff back_off; back_off.is_brisk() && Clock::now() < deadline; back_off.pause()) {
      if (auto message = take_message(zmq::recv_flags::dontwait)) return message;
    }
    while (true) {
      if (auto message = take_message(std::min(deadline, Clock::now() + glance))) return message;
      if (is_lost()) {
        // What arrived between the two looks still counts.
        if (auto message = take_message(Clock::now())) return message;
        throw lost();
      }
      const auto now = Clock::now();
      if (now >= deadline) return std::nullopt;
      if (!watch_.has_followed() && now >= connect_deadline_) {
        socket_.set(zmq::sockopt::linger, 0);
        throw never_came();
      }
    }
  }

  std::string describe() const override { return address_; }

 protected:
  // Parts that go before the frames.
  virtual Parts envelope() const = 0;
  // Takes the envelope off; false when the message is not for us.
  virtual bool open_envelope(Parts& parts) = 0;
  virtual bool follows_first_connection() const = 0;
  // So many connections have come to nothing since the last call.
  virtual void note_failed(int n_failed) = 0;
  virtual report::PeerError never_came() const = 0;

  const ZeromqOptions options_;
  std::string address_;
  zmq::context_t context_;
  zmq::socket_t socket_;
  ConnectionWatch watch_;

 private:
  report::PeerError lost() const {
    return {address_,
            "the program at the other end is lost: it ended, was killed, or gave no sign of life for " +
                seconds_text(options_.heartbeat_deadline),
            "its own last line says why; the last checkpoint can be resumed"};
  }

  bool is_lost() {
    watch_.read(follows_first_connection());
    const int n_failed = watch_.n_failed() - n_failed_;
    n_failed_ = watch_.n_failed();
    if (n_failed > 0) note_failed(n_failed);
    if (watch_.is_lost()) socket_.set(zmq::sockopt::linger, 0);  // nobody will take what is left
    return watch_.is_lost();
  }

  void send_part(zmq::message_t& part, bool more) {
    const auto flags = more ? zmq::send_flags::sndmore : zmq::send_flags::none;
    while (true) {
      try {
        if (socket_.send(part, flags)) return;
      } catch (const zmq::error_t& error) {
        if (error.num() == EHOSTUNREACH) throw lost();
        if (error.num() != EINTR) throw;
      }
      if (is_lost()) throw lost();
    }
  }

  // The next message for us, if it comes until then.
  std::optional<Frames> take_message(Deadline until) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
    set_timeout(std::max(0, static_cast<int>(left.count())));
    return take_message(zmq::recv_flags::none);
  }

  std::optional<Frames> take_message(zmq::recv_flags flags) {
    Parts parts;
    while (take_parts(parts, flags)) {
      if (!open_envelope(parts)) continue;
      Frames message;
      for (zmq::message_t& part : parts) message.push_back(make_frame(std::move(part)));
      return message;
    }
    return std::nullopt;
  }

  // ZeroMQ delivers all parts of a message at once or none.
  bool take_parts(Parts& parts, zmq::recv_flags flags) {
    parts.clear();
    bool more = true;
    while (more) {
      zmq::message_t part;
      if (!take_part(part, flags)) {
        if (parts.empty()) return false;
        continue;
      }
      more = part.more();
      if (parts.size() <= frame_count_limit) parts.push_back(std::move(part));
    }
    return true;
  }

  bool take_part(zmq::message_t& part, zmq::recv_flags flags) {
    try {
      return socket_.recv(part, flags).has_value();
    } catch (const zmq::error_t& error) {
      if (error.num() == EINTR) return false;
      throw;
    }
  }

  void set_timeout(int milliseconds) {
    if (milliseconds == timeout_) return;
    socket_.set(zmq::sockopt::rcvtimeo, milliseconds);
    timeout_ = milliseconds;
  }

  Deadline connect_deadline_;
  int n_failed_ = 0;
  int timeout_ = -1;  // [ms] of the socket's receive, as it is set
};

class ZeromqServer : public ZeromqChannel {
 public:
  ZeromqServer(const std::string& address, const ZeromqOptions& options)
      : ZeromqChannel(zmq::socket_type::router, options) {
    address_ = address;
    socket_.set(zmq::sockopt::router_mandatory, true);
    if (options.keys) {
      gate_.emplace(context_, options.keys->peer_public_key);
      socket_.set(zmq::sockopt::curve_server, true);
      socket_.set(zmq::sockopt::zap_domain, "couplet");
    }
    try {
      socket_.bind(address);
    } catch (const zmq::error_t& error) {
      throw report::PeerError(address, std::string("cannot bind: ") + error.what(),
                              "choose a free address of this machine, for example tcp://127.0.0.1:*");
    }
    address_ = socket_.get(zmq::sockopt::last_endpoint);
  }

 private:
  Parts envelope() const override {
    assert(!peer_.empty());  // a server speaks when it is spoken to
    Parts parts;
    parts.emplace_back(peer_);
    return parts;
  }

  bool open_envelope(Parts& parts) override {
    const std::string sender = parts.front().to_string();
    if (peer_.empty()) {
      peer_ = sender;
      watch_.follow_sender(parts.front());
    }
    if (sender != peer_) {
      if (!has_warned_)
        std::fprintf(stderr, "%s: a second program tries to connect and is ignored\n", address_.c_str());
      has_warned_ = true;
      return false;
    }
    parts.erase(parts.begin());
    return true;
  }

  bool follows_first_connection() const override { return false; }  // it follows who speaks first

  void note_failed(int n_failed) override {
    for (; n_failed > 0 && n_lines_ < lines_at_most; --n_failed, ++n_lines_) {
      std::fprintf(stderr, "%s: a program that %s was turned away%s\n", address_.c_str(),
                   options_.keys ? "has another key, or none," : "does not speak ZeroMQ",
                   n_lines_ + 1 < lines_at_most ? "" : "; no more of them will be reported");
    }
  }

  report::PeerError never_came() const override {
    return {address_, "no coupler has come within " + seconds_text(options_.connect_deadline),
            "start the coupler with this address, or wait longer with --wait"};
  }

  std::optional<CurveGate> gate_;
  int n_lines_ = 0;
  std::string peer_;  // routing id; empty until the first message
  bool has_warned_ = false;
};

class ZeromqClient : public ZeromqChannel {
 public:
  ZeromqClient(const std::string& address, const ZeromqOptions& options)
      : ZeromqChannel(zmq::socket_type::dealer, options) {
    address_ = address;
    if (options.keys) socket_.set(zmq::sockopt::curve_serverkey, options.keys->peer_public_key);
    socket_.set(zmq::sockopt::reconnect_ivl, 20);  // [ms] between attempts until the server is there
    socket_.connect(address);
  }

 private:
  Parts envelope() const override { return {}; }
  bool open_envelope(Parts&) override { return true; }
  bool follows_first_connection() const override { return true; }

  void note_failed(int) override {
    if (watch_.has_followed()) return;  // it had come, and is lost
    socket_.set(zmq::sockopt::linger, 0);
    throw report::PeerError(address_,
                            options_.keys ? "the program there has other keys, or none"
                                          : "the program there asks for a key, or is no server",
                            options_.keys ? "make the keys of both ends with one call of `couplet keys`"
                                          : "give --keys DIR if it was started with them; check the address");
  }

  report::PeerError never_came() const override {
    return {address_, "no server has answered there within " + seconds_text(options_.connect_deadline),
            "check that it runs and that it prints this address"};
  }
};

void refuse_open_link(const std::string& address, const ZeromqOptions& options) {
  if (options.keys || is_local_address(address)) return;
  throw report::SceneError(
      address, "leaves this machine, and without keys anybody there can read and send what he likes",
      "make keys with `couplet keys DIR` and give --keys DIR, or stay on this machine: tcp://127.0.0.1:*");
}

}  // namespace

std::unique_ptr<Channel> listen_zeromq(const std::string& address, const ZeromqOptions& options) {
  check_zeromq_address(address);
  refuse_open_link(address, options);
  return std::make_unique<ZeromqServer>(address, options);
}

std::unique_ptr<Channel> connect_zeromq(const std::string& address, const ZeromqOptions& options) {
  check_zeromq_address(address);
  refuse_open_link(address, options);
  return std::make_unique<ZeromqClient>(address, options);
}

}  // namespace couplet::wire
