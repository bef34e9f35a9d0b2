// A whole server program with springs in the place of a solver, to be started by server_program_test. A step of
// iteration 99 fails; one of iteration 98 takes a second.

#include <chrono>
#include <thread>

#include "proto/participant/server_program.hpp"
#include "proto/report/failure.hpp"
#include "tests/unit/proto/participant/spring_participant.hpp"

namespace {

using namespace couplet;

class TestSpring : public participant::SpringParticipant {
 public:
  using SpringParticipant::SpringParticipant;
  participant::StepSolved solve_step(const participant::StepInterval& interval,
                                     const surface::FieldSet& fields) override {
    if (interval.iteration == 99) throw report::NumericsError("spring 1", "is torn", "pull less");
    if (interval.iteration == 98) std::this_thread::sleep_for(std::chrono::seconds(1));
    return SpringParticipant::solve_step(interval, fields);
  }
  std::vector<participant::NamedNumber> close(const std::string& reason) override {
    std::fprintf(stderr, "results are complete\n");
    return SpringParticipant::close(reason);
  }
};

int serve_springs(int argc, char** argv) {
  participant::ServerProgram program;
  program.name = "solid-server";
  program.purpose = "springs";
  program.make_participant = [](const participant::ServerOptions&) { return std::make_unique<TestSpring>(2); };
  program.estimate = [](const participant::OpenRequest& request) -> std::vector<participant::NamedNumber> {
    return {{"springs", 2, "1"}, {"stable_time_step", request.scene.time().step(), "s"}};
  };
  return participant::run_server_program(program, argc, argv);
}

}  // namespace

int main(int argc, char** argv) {
  return report::run_program("solid-server", serve_springs, argc, argv);
}
