#include "proto/participant/serve_participant.hpp"

#include <exception>
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
using wire::SessionState;

constexpr double glance = 0.1;  // [s] between two looks at whether the server was asked to end

OpenRequest make_open_request(v1::OpenScene open, wire::Arrays arrays, const std::string& scene_folder) {
  OpenRequest request;
  request.scene.Swap(open.mutable_scene());
  request.scene_folder = scene_folder.empty() ? open.scene_folder() : scene_folder;
  request.run_folder = open.run_folder();
  request.resume_from = open.resume_from();
  if (arrays.surface) {
    surface::check_surface(*arrays.surface, "open-scene");
    request.peer_surface = std::move(arrays.surface);
  }
  return request;
}

void write(const std::vector<NamedNumber>& numbers, google::protobuf::RepeatedPtrField<v1::NamedNumber>* list) {
  for (const auto& number : numbers) {
    auto* item = list->Add();
    item->set_name(number.name);
    item->set_value(number.value);
    item->set_unit(number.unit);
    if (!number.text.empty()) item->set_text(number.text);
  }
}

// One session: what the coupler said last, what was answered, where the session stands.
class Server {
 public:
  Server(wire::Channel& channel, Participant& participant, const ServeOptions& options)
      : channel_(channel), participant_(participant), options_(options) {}

  void serve() {
    participant_.watch_steps([this](double) { return !(options_.should_end && options_.should_end()); });
    try {
      while (state_ != SessionState::closed) {
        if (auto message = channel_.receive(wire::deadline_in(glance))) answer(*message);
        if (state_ != SessionState::closed && options_.should_end && options_.should_end()) throw asked_to_end();
      }
    } catch (const PeerError& end) {
      // Nobody will ask for it any more, but what was computed must be complete on disk.
      close_participant(end.what());
      if (!failure_) throw;
    }
    if (failure_) std::rethrow_exception(failure_);
    if (step_failure_) std::rethrow_exception(step_failure_);
  }

 private:
  static PeerError asked_to_end() {
    return {"", "asked to end by a signal", "results are complete up to the last step"};
  }

  void answer(const Frames& message) {
    v1::Request request;
    try {
      request = wire::decode_request(message, channel_.describe());
    } catch (const PeerError&) {
      // Nothing in it can be trusted, not even its number: the answer has none.
      send(refusal(0));
      return;
    }
    const std::uint64_t sequence = request.sequence();
    switch (wire::judge_sequence(last_sequence_, sequence)) {
      case wire::SequenceVerdict::repeated:
        channel_.send(wire::share(last_reply_));
        return;
      case wire::SequenceVerdict::late:
        send(late_reply(sequence));
        return;
      case wire::SequenceVerdict::skipped:
      case wire::SequenceVerdict::next:
        break;
    }
    Frames reply = reply_to(std::move(request), message);
    last_sequence_ = sequence;
    last_reply_ = wire::share(reply);
    send(std::move(reply));
  }

  // Serves the request; what goes wrong becomes a Failure and leaves only close, but for a step that could not be
  // solved.
  Frames reply_to(v1::Request request, const Frames& message) {
    const std::uint64_t sequence = request.sequence();
    const bool is_step = request.body_case() == v1::Request::kSolveStep;
    try {
      if (sequence != last_sequence_ + 1) {
        throw PeerError("session",
                        "request " + std::to_string(sequence) + " follows request " + std::to_string(last_sequence_) +
                            ": one in between is missing",
                        "number requests 1, 2, 3, ...");
      }
      const auto* rule = wire::find_rule(state_, request.body_case());
      if (rule == nullptr) {
        throw PeerError("session", wire::name(request.body_case()) + " is not allowed in state " + wire::name(state_),
                        "see the state table in proto/README.md");
      }
      Frames reply = dispatch(std::move(request), message);
      state_ = rule->next;
      return reply;
    } catch (const report::NumericsError&) {
      return is_step ? step_refusal(sequence) : refusal(sequence);
    } catch (...) {
      return refusal(sequence);
    }
  }

  Frames dispatch(v1::Request request, const Frames& message) {
    v1::Reply reply;
    reply.set_sequence(request.sequence());
    wire::Arrays arrays = wire::decode_arrays(request, message, wire::name(request.body_case()));
    switch (request.body_case()) {
      case v1::Request::kHello:
        greet(request.hello(), reply.mutable_welcome());
        break;
      case v1::Request::kOpenScene:
        return open(std::move(*request.mutable_open_scene()), std::move(arrays), std::move(reply));
      case v1::Request::kSolveStep:
        return solve(request.solve_step(), std::move(arrays.fields), std::move(reply));
      case v1::Request::kAcceptStep:
        write(participant_.accept_step(request.accept_step().step()),
              reply.mutable_step_accepted()->mutable_quantity());
        break;
      case v1::Request::kWriteCheckpoint:
        reply.mutable_checkpoint_written()->set_bytes(participant_.write_checkpoint(request.write_checkpoint().path()));
        break;
      case v1::Request::kClose:
        write(close_participant(request.close().reason()), reply.mutable_closed()->mutable_quantity());
        break;
      case v1::Request::BODY_NOT_SET:
        break;
    }
    return wire::encode_reply(std::move(reply), {}, nullptr);
  }

  void greet(const v1::Hello& hello, v1::Welcome* welcome) const {
    if (hello.protocol() != wire::protocol_version) {
      throw PeerError("hello",
                      "the coupler (commit " + hello.commit() + ") speaks protocol " +
                          std::to_string(hello.protocol()) + ", this " + options_.program + " (commit " +
                          report::commit() + ") speaks " + std::to_string(wire::protocol_version),
                      "build all programs from the same sources");
    }
    welcome->set_protocol(wire::protocol_version);
    welcome->set_program(options_.program);
    welcome->set_version(report::version());
    welcome->set_commit(report::commit());
    welcome->set_ranks(static_cast<std::uint32_t>(options_.ranks));
    welcome->set_threads(static_cast<std::uint32_t>(options_.threads));
  }

  Frames open(v1::OpenScene request, wire::Arrays arrays, v1::Reply reply) {
    is_open_ = true;  // a participant that fails in open is closed as well
    Opened opened = participant_.open(make_open_request(std::move(request), std::move(arrays), options_.scene_folder));
    auto* ready = reply.mutable_scene_ready();
    ready->set_time(opened.time);
    for (const auto& name : opened.needs) ready->add_needs(name);
    for (const auto& name : opened.offers) ready->add_offers(name);
    needs_ = std::move(opened.needs);
    n_nodes_ = opened.surface.n_nodes();
    return wire::encode_reply(std::move(reply), std::move(opened.fields), &opened.surface);
  }

  Frames solve(const v1::SolveStep& request, const surface::FieldSet& fields, v1::Reply reply) {
    for (const auto& name : needs_) {
      const auto n_rows = surface::find_field(fields, name).values.rows();
      if (n_rows != n_nodes_) {
        throw PeerError("solve-step", "field " + name + " has " + std::to_string(n_rows) + " rows for " +
                                          std::to_string(n_nodes_) + " nodes");
      }
    }
    StepSolved solved =
        participant_.solve_step({request.step(), request.iteration(), request.start(), request.duration()}, fields);
    step_failure_ = nullptr;
    auto* answer = reply.mutable_step_solved();
    answer->set_seconds(solved.seconds);
    answer->set_inner_iterations(solved.inner_iterations);
    answer->set_residual(solved.residual);
    return wire::encode_reply(std::move(reply), std::move(solved.fields), nullptr);
  }

  std::vector<NamedNumber> close_participant(const std::string& reason) {
    if (!std::exchange(is_open_, false)) return {};
    return participant_.close(reason);
  }

  // To be called while an exception is handled: it becomes the reply, and the first one the end of serve().
  Frames refusal(std::uint64_t sequence) {
    if (!failure_) failure_ = std::current_exception();
    state_ = SessionState::failed;
    return failure_reply(sequence);
  }

  // A step that cannot be solved leaves the accepted state as it was: the coupler may try again, with half the step.
  Frames step_refusal(std::uint64_t sequence) {
    step_failure_ = std::current_exception();
    state_ = SessionState::opened;
    return failure_reply(sequence);
  }

  static Frames failure_reply(std::uint64_t sequence) {
    v1::Reply reply;
    reply.set_sequence(sequence);
    *reply.mutable_failure() = wire::describe_failure(std::current_exception());
    return wire::encode_reply(std::move(reply), {}, nullptr);
  }

  Frames late_reply(std::uint64_t sequence) const {
    v1::Reply reply;
    reply.set_sequence(sequence);
    auto* failure = reply.mutable_failure();
    failure->set_kind(v1::Failure::PEER);
    failure->set_where("session");
    failure->set_sentence("request " + std::to_string(sequence) + " comes after request " +
                          std::to_string(last_sequence_) + " was answered");
    return wire::encode_reply(std::move(reply), {}, nullptr);
  }

  void send(Frames reply) { channel_.send(std::move(reply)); }

  wire::Channel& channel_;
  Participant& participant_;
  const ServeOptions& options_;
  SessionState state_ = SessionState::connected;
  std::uint64_t last_sequence_ = 0;
  Frames last_reply_;
  std::vector<std::string> needs_;
  std::int64_t n_nodes_ = 0;
  bool is_open_ = false;
  std::exception_ptr failure_;       // the first
  std::exception_ptr step_failure_;  // of the last solve; forgotten when a later one succeeds
};

}  // namespace

void serve_participant(wire::Channel& channel, Participant& participant, const ServeOptions& options) {
  Server(channel, participant, options).serve();
}

}  // namespace couplet::participant
