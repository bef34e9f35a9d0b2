#pragma once
// The command line of the coupler.

namespace couplet::coupling {

/// run SCENE --flow ADDRESS --solid ADDRESS --out DIR [--set PATH=VALUE]... [--steps N] [--resume DIR] [--quiet]
///     [--transport zmq|mpi] [--keys DIR]
/// Returns the exit code; may throw report::Failure.
int run_coupler_program(int argc, char** argv);

}  // namespace couplet::coupling
