#include "proto/participant/remote_participant.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "proto/report/failure.hpp"
#include "proto/report/version.hpp"
#include "proto/wire/failure_message.hpp"
#include "proto/wire/message.hpp"
#include "proto/wire/session_rules.hpp"

namespace couplet::participant {

namespace {

using report::PeerError;
using wire::Frames;

constexpr double farewell = 2;  // [s] that an unplanned end waits for the server

std::vector<NamedNumber> read(const google::protobuf::RepeatedPtrField<v1::NamedNumber>& list) {
  std::vector<NamedNumber> numbers;
  for (const auto& item : list) numbers.push_back({item.name(), item.value(), item.unit(), item.text()});
  return numbers;
}

std::string seconds_text(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%g s", seconds);
  return text;
}

}  // namespace

// The client's end of a session: numbers the requests, waits for the reply that carries the same number.
struct RemoteParticipant::Session {
  Session(std::unique_ptr<wire::Channel> its_channel, RemoteOptions its_options)
      : channel(std::move(its_channel)), options(std::move(its_options)) {}

  void send(v1::Request request, const surface::FieldSet& fields, const surface::SurfaceMesh* surface) {
    request.set_sequence(++sequence);
    body = request.body_case();
    Frames message = wire::encode_request(std::move(request), fields, surface);
    unanswered = wire::share(message);
    deadline =
        body == v1::Request::kHello ? std::min(options.hello_deadline, options.reply_deadline) : options.reply_deadline;
    give_up = wire::deadline_in(deadline);
    deliver(std::move(message));
  }

  // The reply to the last request, which must be of that type. A Failure is thrown.
  std::pair<v1::Reply, Frames> await(v1::Reply::BodyCase expected) {
    auto answer = await_any();
    const v1::Reply& reply = answer.first;
    if (reply.has_failure()) wire::throw_failure(reply.failure(), options.name);
    if (reply.body_case() != expected)
      throw PeerError(options.name, "answers " + wire::name(body) + " by a reply of another kind", "mend that program");
    return answer;
  }

  std::pair<v1::Reply, Frames> call(v1::Request request, v1::Reply::BodyCase expected,
                                    const surface::SurfaceMesh* surface = nullptr) {
    send(std::move(request), {}, surface);
    return await(expected);
  }

  void greet() {
    v1::Request request;
    auto* hello = request.mutable_hello();
    hello->set_protocol(wire::protocol_version);
    hello->set_run(options.run);
    hello->set_commit(report::commit());
    const v1::Welcome welcome = call(std::move(request), v1::Reply::kWelcome).first.welcome();
    if (welcome.protocol() != wire::protocol_version) {
      throw PeerError(options.name,
                      welcome.program() + " (commit " + welcome.commit() + ") speaks protocol " +
                          std::to_string(welcome.protocol()) + ", this program (commit " + report::commit() +
                          ") speaks " + std::to_string(wire::protocol_version),
                      "build all programs from the same sources");
    }
  }

  // The offered fields of a reply, all of them and each with one row a node.
  surface::FieldSet take_fields(wire::Arrays arrays) const {
    for (const auto& name : offers) {
      const auto& field = surface::find_field(arrays.fields, name);
      if (field.values.rows() != n_nodes) {
        throw PeerError(options.name,
                        "field " + name + " has " + std::to_string(field.values.rows()) + " rows for " +
                            std::to_string(n_nodes) + " nodes",
                        "mend that program");
      }
    }
    return std::move(arrays.fields);
  }

  // Ends a session that nobody closed, without making an unhappy end longer than it must be.
  void abandon() {
    if (sequence == 0 || is_lost || is_closed) return;
    try {
      options.reply_deadline = farewell;
      v1::Request request;
      request.mutable_close()->set_reason("the coupler ends early");
      send(std::move(request), {}, nullptr);
      await_any();
    } catch (const std::exception&) {
      // The run ends for another reason already; nothing can be added to it here.
    }
  }

  std::unique_ptr<wire::Channel> channel;
  RemoteOptions options;
  std::uint64_t sequence = 0;
  v1::Request::BodyCase body = v1::Request::BODY_NOT_SET;  // of the last request
  Frames unanswered;                                       // the last request
  wire::Deadline give_up{};
  double deadline = 0;  // [s] from request to give_up, for people
  bool is_lost = false, is_closed = false;
  std::vector<std::string> offers;
  std::int64_t n_nodes = 0;

 private:
  void deliver(Frames message) {
    try {
      channel->send(std::move(message));
    } catch (const PeerError& fault) {
      lose(fault);
    }
  }

  std::optional<Frames> receive(wire::Deadline until) {
    try {
      return channel->receive(until);
    } catch (const PeerError& fault) {
      lose(fault);
    }
  }

  // The same failure, with the participant's name in front of the channel's address.
  [[noreturn]] void lose(const PeerError& fault) {
    is_lost = true;
    throw PeerError(options.name + " at " + fault.where(), fault.sentence(), fault.advice());
  }

  std::pair<v1::Reply, Frames> await_any() {
    while (true) {
      const auto repeat = std::min(give_up, wire::deadline_in(options.repeat_interval));
      auto message = receive(repeat);
      if (message) {
        v1::Reply reply = wire::decode_reply(*message, options.name);
        // Number 0 answers a request that could not be read; an older number belongs to a request that was sent twice.
        if (reply.sequence() == sequence || (reply.sequence() == 0 && reply.has_failure())) {
          unanswered.clear();
          return {std::move(reply), std::move(*message)};
        }
      } else if (std::chrono::steady_clock::now() >= give_up) {
        is_lost = true;
        throw PeerError(options.name + " at " + channel->describe(),
                        "has not answered " + wire::name(body) + " within " + seconds_text(deadline),
                        body == v1::Request::kHello ? "it may be serving another coupler"
                                                    : "if it was still computing, raise coupling.peer_deadline");
      } else {
        deliver(wire::share(unanswered));
      }
    }
  }
};

RemoteParticipant::RemoteParticipant(std::unique_ptr<wire::Channel> channel, RemoteOptions options)
    : session_(std::make_unique<Session>(std::move(channel), std::move(options))) {}

RemoteParticipant::~RemoteParticipant() {
  session_->abandon();
}

Opened RemoteParticipant::open(const OpenRequest& request) {
  session_->greet();
  v1::Request message;
  auto* scene = message.mutable_open_scene();
  *scene->mutable_scene() = request.scene;
  scene->set_scene_folder(request.scene_folder);
  scene->set_run_folder(request.run_folder);
  scene->set_resume_from(request.resume_from);
  const auto [reply, frames] = session_->call(std::move(message), v1::Reply::kSceneReady,
                                              request.peer_surface ? &*request.peer_surface : nullptr);
  wire::Arrays arrays = wire::decode_arrays(reply, frames, session_->options.name);
  Opened opened;
  opened.time = reply.scene_ready().time();
  opened.needs.assign(reply.scene_ready().needs().begin(), reply.scene_ready().needs().end());
  opened.offers.assign(reply.scene_ready().offers().begin(), reply.scene_ready().offers().end());
  if (arrays.surface) opened.surface = std::move(*arrays.surface);
  surface::check_surface(opened.surface, session_->options.name);
  session_->offers = opened.offers;
  session_->n_nodes = opened.surface.n_nodes();
  opened.fields = session_->take_fields(std::move(arrays));
  return opened;
}

StepSolved RemoteParticipant::solve_step(const StepInterval& interval, const surface::FieldSet& fields) {
  start_step(interval, fields);
  return finish_step();
}

void RemoteParticipant::start_step(const StepInterval& interval, const surface::FieldSet& fields) {
  v1::Request message;
  auto* step = message.mutable_solve_step();
  step->set_step(interval.step);
  step->set_iteration(interval.iteration);
  step->set_start(interval.start);
  step->set_duration(interval.duration);
  session_->send(std::move(message), fields, nullptr);
}

StepSolved RemoteParticipant::finish_step() {
  const auto [reply, frames] = session_->await(v1::Reply::kStepSolved);
  StepSolved solved;
  solved.fields = session_->take_fields(wire::decode_arrays(reply, frames, session_->options.name));
  solved.seconds = reply.step_solved().seconds();
  solved.inner_iterations = reply.step_solved().inner_iterations();
  solved.residual = reply.step_solved().residual();
  return solved;
}

std::vector<NamedNumber> RemoteParticipant::accept_step(std::int64_t step) {
  start_accept(step);
  return finish_accept();
}

void RemoteParticipant::start_accept(std::int64_t step) {
  v1::Request message;
  message.mutable_accept_step()->set_step(step);
  session_->send(std::move(message), {}, nullptr);
}

std::vector<NamedNumber> RemoteParticipant::finish_accept() {
  return read(session_->await(v1::Reply::kStepAccepted).first.step_accepted().quantity());
}

std::uint64_t RemoteParticipant::write_checkpoint(const std::string& path) {
  v1::Request message;
  message.mutable_write_checkpoint()->set_path(path);
  return session_->call(std::move(message), v1::Reply::kCheckpointWritten).first.checkpoint_written().bytes();
}

std::vector<NamedNumber> RemoteParticipant::close(const std::string& reason) {
  v1::Request message;
  message.mutable_close()->set_reason(reason);
  const auto answer = session_->call(std::move(message), v1::Reply::kClosed);
  session_->is_closed = true;
  return read(answer.first.closed().quantity());
}

}  // namespace couplet::participant
