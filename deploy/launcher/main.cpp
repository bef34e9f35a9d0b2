// couplet: starts what a scene needs, watches over it, and tells what came out.

#include "deploy/launcher/command_line.hpp"
#include "proto/report/failure.hpp"

int main(int argc, char** argv) {
  return couplet::report::run_program("couplet", couplet::launcher::run_command_line, argc, argv);
}
