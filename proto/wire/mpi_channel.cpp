#include "proto/wire/mpi_channel.hpp"

#include <cstdint>
#include <cstdio>
#include <list>
#include <utility>

#include "proto/report/failure.hpp"
#include "proto/wire/back_off.hpp"
#include "proto/wire/keep_memory.hpp"
#include "proto/wire/mpi_heartbeat.hpp"
#include "proto/wire/mpi_tags.hpp"

namespace couplet::wire {

namespace {

using Clock = std::chrono::steady_clock;

constexpr double longest_wait = 2;    // [s] that a channel's end waits for what is still unsent
constexpr std::int64_t the_end = -1;  // a head that says that no message follows
constexpr std::int64_t head_limit = 1 + static_cast<std::int64_t>(frame_count_limit);

// A message on its way: everything MPI may still read from.
struct Outgoing {
  Frames frames;
  std::vector<std::int64_t> head;
  std::vector<MPI_Request> requests;
};

class MpiChannel : public Channel {
 public:
  MpiChannel(MPI_Comm intercommunicator, const std::string& peer, const MpiOptions& options)
      : intercommunicator_(intercommunicator),
        name_("mpi, " + peer),
        deadline_(options.heartbeat_deadline),
        heartbeat_(with_error_codes(intercommunicator), options.heartbeat_deadline) {}

  ~MpiChannel() override {
    const Deadline until = deadline_in(heartbeat_.is_lost() ? 0 : longest_wait);
    BackOff back_off;
    std::vector<std::int64_t> head{the_end};
    post(Outgoing{{}, std::move(head), {}});
    while (!is_all_sent() && Clock::now() < until) back_off.pause();
    for (Outgoing& left : outgoing_) forget(left);
  }

  void send(Frames message) override {
    throw_if_lost();
    Outgoing out;
    for (const Frame& frame : message) out.head.push_back(static_cast<std::int64_t>(frame.size()));
    out.frames = std::move(message);
    post(std::move(out));
    is_all_sent();
  }

  std::optional<Frames> receive(Deadline deadline) override {
    BackOff back_off;
    while (true) {
      is_all_sent();
      if (auto head = take_head()) return take_frames(*head);
      throw_if_lost();
      if (Clock::now() >= deadline) return std::nullopt;
      back_off.pause();
    }
  }

  std::string describe() const override { return name_; }

 private:
  static MPI_Comm with_error_codes(MPI_Comm communicator) {
    MPI_Comm_set_errhandler(communicator, MPI_ERRORS_RETURN);
    return communicator;
  }

  void check(int code) const {
    if (code == MPI_SUCCESS) return;
    char text[MPI_MAX_ERROR_STRING];
    int length = 0;
    MPI_Error_string(code, text, &length);
    throw report::PeerError(name_, "MPI reports: " + std::string(text, static_cast<std::size_t>(length)),
                            "the last checkpoint can be resumed");
  }

  void throw_if_lost() const {
    const std::string advice = "its own last line says why; the last checkpoint can be resumed";
    if (has_ended_) throw report::PeerError(name_, "the program at the other end has ended", advice);
    if (!heartbeat_.is_lost()) return;
    char seconds[32];
    std::snprintf(seconds, sizeof seconds, "%g s", deadline_);
    throw report::PeerError(name_, std::string("the program at the other end gave no sign of life for ") + seconds,
                            advice);
  }

  // Sends are started and not waited for: were both ends to wait for the other to receive, they would wait forever.
  void post(Outgoing message) {
    outgoing_.push_back(std::move(message));
    Outgoing& out = outgoing_.back();
    out.requests.resize(1 + out.frames.size());
    check(MPI_Isend(out.head.data(), static_cast<int>(out.head.size()), MPI_INT64_T, 0, mpi_head_tag,
                    intercommunicator_, &out.requests[0]));
    for (std::size_t i = 0; i < out.frames.size(); ++i) {
      check(MPI_Isend(out.frames[i].data(), static_cast<int>(out.frames[i].size()), MPI_BYTE, 0, mpi_frame_tag,
                      intercommunicator_, &out.requests[1 + i]));
    }
  }

  // Lets go of what has left.
  bool is_all_sent() {
    while (!outgoing_.empty()) {
      Outgoing& first = outgoing_.front();
      int is_done = 0;
      MPI_Testall(static_cast<int>(first.requests.size()), first.requests.data(), &is_done, MPI_STATUSES_IGNORE);
      if (is_done == 0) return false;
      outgoing_.pop_front();
    }
    return true;
  }

  // MPI may read an unsent message at any time later, so its memory is never given back.
  static void forget(Outgoing& left) { new Outgoing(std::move(left)); }

  std::optional<std::vector<std::int64_t>> take_head() {
    int is_there = 0;
    MPI_Message message;
    MPI_Status status;
    check(MPI_Improbe(0, mpi_head_tag, intercommunicator_, &is_there, &message, &status));
    if (is_there == 0) return std::nullopt;
    int size = 0;
    MPI_Get_count(&status, MPI_INT64_T, &size);
    std::vector<std::int64_t> head(static_cast<std::size_t>(size));
    check(MPI_Mrecv(head.data(), size, MPI_INT64_T, &message, MPI_STATUS_IGNORE));
    if (size == 1 && head.front() == the_end) {
      has_ended_ = true;
      throw_if_lost();
    }
    bool is_credible = size <= head_limit;
    for (const std::int64_t frame_size : head)
      is_credible = is_credible && frame_size >= 0 && frame_size <= static_cast<std::int64_t>(frame_size_limit);
    if (!is_credible) throw report::PeerError(name_, "announces an impossible message", "mend that program");
    return head;
  }

  Frames take_frames(const std::vector<std::int64_t>& head) {
    Frames frames;
    std::vector<MPI_Request> requests(head.size());
    for (std::size_t i = 0; i < head.size(); ++i) {
      frames.emplace_back(static_cast<std::size_t>(head[i]));
      check(MPI_Irecv(frames[i].data(), static_cast<int>(head[i]), MPI_BYTE, 0, mpi_frame_tag, intercommunicator_,
                      &requests[i]));
    }
    BackOff back_off;
    int is_done = 0;
    while (true) {
      check(MPI_Testall(static_cast<int>(requests.size()), requests.data(), &is_done, MPI_STATUSES_IGNORE));
      if (is_done != 0) return frames;
      if (heartbeat_.is_lost()) {
        Outgoing kept{std::move(frames), {}, std::move(requests)};
        forget(kept);
        throw_if_lost();
      }
      back_off.pause();
    }
  }

  MPI_Comm intercommunicator_;
  std::string name_;
  double deadline_;  // [s] of the heartbeat
  std::list<Outgoing> outgoing_;
  bool has_ended_ = false;  // the other end said so
  MpiHeartbeat heartbeat_;
};

}  // namespace

std::unique_ptr<Channel> make_mpi_channel(MPI_Comm intercommunicator, const std::string& peer,
                                          const MpiOptions& options) {
  keep_freed_memory();
  return std::make_unique<MpiChannel>(intercommunicator, peer, options);
}

}  // namespace couplet::wire
