// flow-server: computes the force of a flow on a moving surface.

#include <memory>

#include "flow-server/service/estimate_flow.hpp"
#include "flow-server/service/flow_participant.hpp"
#include "proto/participant/server_program.hpp"
#include "proto/report/failure.hpp"

namespace {

int serve_flow(int argc, char** argv) {
  couplet::participant::ServerProgram program;
  program.name = "flow-server";
  program.purpose = "Computes the force of an incompressible flow on a moving surface.";
  program.make_participant = [](const couplet::participant::ServerOptions& options) {
    return couplet::flow::make_flow_participant(options.ranks);
  };
  program.follow = [](const couplet::participant::ServerOptions& options) {
    couplet::flow::follow_flow_participant(options.ranks);
  };
  program.estimate = couplet::flow::estimate_flow;
  return couplet::participant::run_server_program(program, argc, argv);
}

}  // namespace

int main(int argc, char** argv) {
  return couplet::report::run_program("flow-server", serve_flow, argc, argv);
}
