#pragma once
// Who said a line that came through mpirun, and whether it is a program's last word.

#include <string>

namespace couplet::launcher {

/// Takes the tag "[1,0]<stdout>:" off a line and returns "rank 0"; "mpirun" for a line without one, which is its own.
std::string take_mpi_tag(std::string& line);

/// The same for updates, which come in pieces: mpirun puts its tags between them. Only rank 0, which owns the run,
/// shows updates.
std::string take_mpi_tags(std::string& update);

/// A program that fails ends with one line `PROGRAM: what happened; what to do next`.
bool is_last_word(const std::string& line);

}  // namespace couplet::launcher
