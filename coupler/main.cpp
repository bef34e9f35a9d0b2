// Couples a flow server and a solid server: iterates between them until both agree, then moves time forward.
#include "coupler/program/coupler_program.hpp"
#include "proto/report/failure.hpp"

int main(int argc, char** argv) {
  return couplet::report::run_program("coupler", couplet::coupling::run_coupler_program, argc, argv);
}
