// solid-server: computes the motion of a deformable body under forces.

#include <memory>

#include "proto/participant/server_program.hpp"
#include "proto/report/failure.hpp"
#include "solid-server/assembly/dense_kernels.hpp"
#include "solid-server/service/estimate_solid.hpp"
#include "solid-server/service/find_modes.hpp"
#include "solid-server/service/solid_participant.hpp"

namespace {

int serve_solid(int argc, char** argv) {
  couplet::participant::ServerProgram program;
  program.name = "solid-server";
  program.purpose = "Computes the motion of a deformable body under forces on its surface.";
  program.make_participant = [](const couplet::participant::ServerOptions& options) {
    return std::make_unique<couplet::solid::SolidParticipant>(options);
  };
  program.estimate = [](const couplet::participant::OpenRequest& request) {
    return couplet::solid::estimate_solid(request, 0);
  };
  program.verbs = {
      {"modes", "find the lowest modes of free vibration of the bodies of a scene", couplet::solid::find_modes}};
  return couplet::participant::run_server_program(program, argc, argv);
}

}  // namespace

int main(int argc, char** argv) {
  couplet::solid::use_better_kernels(argv);
  return couplet::report::run_program("solid-server", serve_solid, argc, argv);
}
