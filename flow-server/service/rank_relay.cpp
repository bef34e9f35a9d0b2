#include "flow-server/service/rank_relay.hpp"

#include <chrono>
#include <cstdio>
#include <exception>
#include <limits>
#include <optional>
#include <utility>

#include "proto/report/failure.hpp"
#include "proto/wire/back_off.hpp"
#include "proto/wire/failure_message.hpp"
#include "proto/wire/message.hpp"

namespace couplet::flow {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::int64_t the_end = -1;  // in place of a number of frames: no call follows
constexpr int nobody = std::numeric_limits<int>::max();
/// How long a rank that has failed waits for the others, which may wait for it somewhere in the same call.
constexpr std::chrono::seconds patience{5};

int rank_in(MPI_Comm communicator) {
  int rank = 0;
  MPI_Comm_rank(communicator, &rank);
  return rank;
}

/// Without using its core, however long it takes; false when it was not over by `until`.
bool wait_for(MPI_Request& request, std::optional<Clock::time_point> until) {
  wire::BackOff back_off;
  int is_done = 0;
  while (true) {
    MPI_Test(&request, &is_done, MPI_STATUS_IGNORE);
    if (is_done != 0) return true;
    if (until && Clock::now() > *until) return false;
    back_off.pause();
  }
}

/// A request as a coupler would send it: number of frames, their sizes, their bytes.
void send_call(const wire::Frames& call, MPI_Comm relay) {
  std::int64_t n_frames = static_cast<std::int64_t>(call.size());
  MPI_Request request;
  MPI_Ibcast(&n_frames, 1, MPI_INT64_T, 0, relay, &request);
  MPI_Wait(&request, MPI_STATUS_IGNORE);
  std::vector<std::int64_t> sizes;
  for (const wire::Frame& frame : call) sizes.push_back(static_cast<std::int64_t>(frame.size()));
  MPI_Bcast(sizes.data(), static_cast<int>(sizes.size()), MPI_INT64_T, 0, relay);
  for (const wire::Frame& frame : call)
    MPI_Bcast(const_cast<std::byte*>(frame.data()), static_cast<int>(frame.size()), MPI_BYTE, 0, relay);
}

/// Nothing when rank 0 lets go.
std::optional<wire::Frames> receive_call(MPI_Comm relay) {
  std::int64_t n_frames = 0;
  MPI_Request request;
  MPI_Ibcast(&n_frames, 1, MPI_INT64_T, 0, relay, &request);
  wait_for(request, {});
  if (n_frames == the_end) return std::nullopt;
  std::vector<std::int64_t> sizes(static_cast<std::size_t>(n_frames));
  MPI_Bcast(sizes.data(), static_cast<int>(n_frames), MPI_INT64_T, 0, relay);
  wire::Frames call;
  for (const std::int64_t size : sizes) {
    call.emplace_back(static_cast<std::size_t>(size));
    MPI_Bcast(call.back().data(), static_cast<int>(size), MPI_BYTE, 0, relay);
  }
  return call;
}

report::FailureKind kind_of(v1::Failure::Kind kind) {
  switch (kind) {
    case v1::Failure::SCENE:
      return report::FailureKind::scene;
    case v1::Failure::NUMERICS:
      return report::FailureKind::numerics;
    case v1::Failure::PEER:
      return report::FailureKind::peer;
    case v1::Failure::FILE:
      return report::FailureKind::file;
    default:
      return report::FailureKind::bug;
  }
}

/// The others are somewhere inside the call and wait for this rank, which will never come.
[[noreturn]] void end_job(const v1::Failure& failure) {
  const report::Failure end(kind_of(failure.kind()), failure.where(), failure.sentence(), failure.advice());
  std::fprintf(stderr, "flow-server: %s\n", end.what());
  std::fflush(nullptr);
  MPI_Abort(MPI_COMM_WORLD, report::exit_code(end.kind()));
  std::abort();
}

/// Collective: whether the call has failed somewhere. `mine`: the failure of this rank. The failure of the first rank
/// that has one is thrown on rank 0.
void agree(const std::exception_ptr& mine, MPI_Comm relay) {
  const int rank = rank_in(relay);
  int first = mine ? rank : nobody;
  MPI_Request request;
  MPI_Iallreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, relay, &request);
  const auto until = mine ? std::optional(Clock::now() + patience) : std::nullopt;
  if (!wait_for(request, until)) end_job(wire::describe_failure(mine));
  if (first == nobody) return;
  if (first == 0) {
    if (rank == 0) std::rethrow_exception(mine);
    return;
  }
  if (rank == first) {
    const std::string text = wire::describe_failure(mine).SerializeAsString();
    MPI_Send(text.data(), static_cast<int>(text.size()), MPI_BYTE, 0, 0, relay);
  } else if (rank == 0) {
    MPI_Status status;
    MPI_Probe(first, 0, relay, &status);
    int size = 0;
    MPI_Get_count(&status, MPI_BYTE, &size);
    std::string text(static_cast<std::size_t>(size), '\0');
    MPI_Recv(text.data(), size, MPI_BYTE, first, 0, relay, MPI_STATUS_IGNORE);
    v1::Failure failure;
    failure.ParseFromString(text);
    wire::throw_failure(failure, "flow-server");
  }
}

/// Executes a call and agrees on how it went.
template <class Call>
auto together(MPI_Comm relay, Call call) {
  std::optional<decltype(call())> answer;
  std::exception_ptr failure;
  try {
    answer = call();
  } catch (...) {
    failure = std::current_exception();
  }
  agree(failure, relay);
  return answer;  // empty only on a rank whose call failed
}

participant::OpenRequest make_open_request(v1::OpenScene&& open, wire::Arrays&& arrays) {
  participant::OpenRequest request;
  request.scene.Swap(open.mutable_scene());
  request.scene_folder = open.scene_folder();
  request.run_folder = open.run_folder();
  request.resume_from = open.resume_from();
  request.peer_surface = std::move(arrays.surface);
  return request;
}

void execute(participant::Participant& participant, const wire::Frames& message, MPI_Comm relay) {
  v1::Request request = wire::decode_request(message, "rank 0");
  wire::Arrays arrays = wire::decode_arrays(request, message, "rank 0");
  switch (request.body_case()) {
    case v1::Request::kOpenScene: {
      const auto open = make_open_request(std::move(*request.mutable_open_scene()), std::move(arrays));
      together(relay, [&] { return participant.open(open); });
      break;
    }
    case v1::Request::kSolveStep: {
      const v1::SolveStep& step = request.solve_step();
      const participant::StepInterval interval{step.step(), step.iteration(), step.start(), step.duration()};
      together(relay, [&] { return participant.solve_step(interval, arrays.fields); });
      break;
    }
    case v1::Request::kAcceptStep:
      together(relay, [&] { return participant.accept_step(request.accept_step().step()); });
      break;
    case v1::Request::kWriteCheckpoint:
      together(relay, [&] { return participant.write_checkpoint(request.write_checkpoint().path()); });
      break;
    case v1::Request::kClose:
      together(relay, [&] { return participant.close(request.close().reason()); });
      break;
    case v1::Request::kHello:
    case v1::Request::BODY_NOT_SET:
      break;
  }
}

}  // namespace

RelayedParticipant::RelayedParticipant(std::unique_ptr<participant::Participant> own, MPI_Comm ranks)
    : own_(std::move(own)) {
  MPI_Comm_dup(ranks, &relay_);
}

RelayedParticipant::~RelayedParticipant() {
  std::int64_t end = the_end;
  MPI_Request request;
  MPI_Ibcast(&end, 1, MPI_INT64_T, 0, relay_, &request);
  MPI_Wait(&request, MPI_STATUS_IGNORE);
  own_.reset();  // while the others let go of theirs: files are closed together
  MPI_Comm_free(&relay_);
}

participant::Opened RelayedParticipant::open(const participant::OpenRequest& request) {
  v1::Request call;
  v1::OpenScene* open = call.mutable_open_scene();
  *open->mutable_scene() = request.scene;
  open->set_scene_folder(request.scene_folder);
  open->set_run_folder(request.run_folder);
  open->set_resume_from(request.resume_from);
  send_call(wire::encode_request(std::move(call), {}, request.peer_surface ? &*request.peer_surface : nullptr), relay_);
  return *together(relay_, [&] { return own_->open(request); });
}

participant::StepSolved RelayedParticipant::solve_step(const participant::StepInterval& interval,
                                                       const surface::FieldSet& fields) {
  v1::Request call;
  v1::SolveStep* step = call.mutable_solve_step();
  step->set_step(interval.step);
  step->set_iteration(interval.iteration);
  step->set_start(interval.start);
  step->set_duration(interval.duration);
  send_call(wire::encode_request(std::move(call), fields, nullptr), relay_);
  return *together(relay_, [&] { return own_->solve_step(interval, fields); });
}

std::vector<participant::NamedNumber> RelayedParticipant::accept_step(std::int64_t step) {
  v1::Request call;
  call.mutable_accept_step()->set_step(step);
  send_call(wire::encode_request(std::move(call), {}, nullptr), relay_);
  return *together(relay_, [&] { return own_->accept_step(step); });
}

std::uint64_t RelayedParticipant::write_checkpoint(const std::string& path) {
  v1::Request call;
  call.mutable_write_checkpoint()->set_path(path);
  send_call(wire::encode_request(std::move(call), {}, nullptr), relay_);
  return *together(relay_, [&] { return own_->write_checkpoint(path); });
}

std::vector<participant::NamedNumber> RelayedParticipant::close(const std::string& reason) {
  v1::Request call;
  call.mutable_close()->set_reason(reason);
  send_call(wire::encode_request(std::move(call), {}, nullptr), relay_);
  return *together(relay_, [&] { return own_->close(reason); });
}

void follow_calls(participant::Participant& participant, MPI_Comm ranks) {
  MPI_Comm relay;
  MPI_Comm_dup(ranks, &relay);
  while (const auto call = receive_call(relay)) execute(participant, *call, relay);
  MPI_Comm_free(&relay);
}

}  // namespace couplet::flow
