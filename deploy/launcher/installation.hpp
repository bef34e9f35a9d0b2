#pragma once
// Where the pieces of Couplet lie on this machine.

#include <filesystem>
#include <string>

namespace couplet::launcher {

struct Installation {
  std::filesystem::path programs;  // folder of coupler, flow-server, solid-server and the benchmarks
  std::filesystem::path sources;   // top folder: deploy/, tests/
  std::string python;              // the interpreter that has Debian's packages

  /// Full name of a program; throws FileError when it was not built.
  std::string program(const std::string& name) const;
  /// Full name of a script, given from the top folder; throws FileError when it is not there.
  std::string script(const std::string& name) const;
};

/// The programs lie beside the launcher that is running.
Installation find_installation();

}  // namespace couplet::launcher
