#pragma once
// A participant that is quickly computed by hand: every node a mass on a spring, m u'' + k u = f.

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "proto/participant/participant.hpp"

namespace couplet::participant {

/// Within a step the force is constant, so the exact solution is known:
/// u(t) = f/k + (u0 - f/k) cos(w t) + v0/w sin(w t), w = sqrt(k/m).
class SpringParticipant : public Participant {
 public:
  explicit SpringParticipant(std::int64_t n_nodes) : n_nodes_(n_nodes) {}

  static constexpr double mass = 2;        // [kg]
  static constexpr double stiffness = 50;  // [N/m]

  Opened open(const OpenRequest& request) override {
    calls.push_back("open");
    opened = request;
    if (on_open) on_open();
    accepted_ = trial_ = {surface::NodeArray::Zero(n_nodes_, 3), surface::NodeArray::Zero(n_nodes_, 3)};
    Opened reply;
    reply.surface.node_position = surface::NodeArray::Random(n_nodes_, 3);
    reply.surface.marker["first"] = 0;
    reply.needs = {"force"};
    reply.offers = {"displacement", "velocity"};
    reply.fields = fields(accepted_);
    return reply;
  }

  StepSolved solve_step(const StepInterval& interval, const surface::FieldSet& given) override {
    calls.push_back("solve " + std::to_string(interval.step) + "/" + std::to_string(interval.iteration));
    if (on_solve) on_solve();
    const double w = std::sqrt(stiffness / mass), angle = w * interval.duration;
    const surface::NodeArray rest = surface::find_field(given, "force").values / stiffness;
    trial_.displacement =
        rest + (accepted_.displacement - rest) * std::cos(angle) + accepted_.velocity / w * std::sin(angle);
    trial_.velocity = -(accepted_.displacement - rest) * w * std::sin(angle) + accepted_.velocity * std::cos(angle);
    return {fields(trial_), 0.25, 7, 1e-9};
  }

  std::vector<NamedNumber> accept_step(std::int64_t step) override {
    calls.push_back("accept " + std::to_string(step));
    accepted_ = trial_;
    return {{"energy", accepted_.velocity.squaredNorm() * mass / 2, "J"}};
  }

  std::uint64_t write_checkpoint(const std::string& path) override {
    calls.push_back("checkpoint " + path);
    return 123;
  }

  std::vector<NamedNumber> close(const std::string& reason) override {
    calls.push_back("close " + reason);
    return {{"seconds", 1.5, "s"}, {"peak_memory_bytes", 1e6, "1"}};
  }

  std::vector<std::string> calls;
  OpenRequest opened;
  std::function<void()> on_open, on_solve;  // what else shall happen there

 private:
  struct State {
    surface::NodeArray displacement, velocity;
  };
  static surface::FieldSet fields(const State& state) {
    return {{"displacement", "m", state.displacement}, {"velocity", "m/s", state.velocity}};
  }
  std::int64_t n_nodes_;
  State accepted_, trial_;
};

}  // namespace couplet::participant
