#pragma once
// What a user asks of `couplet run`.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace couplet::launcher {

struct RunOptions {
  std::filesystem::path scene;
  std::filesystem::path out;          // empty: runs/<scene folder>-<date>-<time>
  std::vector<std::string> settings;  // PATH=VALUE, in order
  int flow_ranks = 0;                 // 0: as suits the scene and this machine
  int solid_threads = 0;              // 0: as the solid server chooses
  std::string transport;              // mpi, zmq; empty: as the scene says
  std::filesystem::path hosts;        // file that says who runs where; empty: all on this machine
  std::filesystem::path keys;         // folder of key pairs; empty: the programs talk in the clear
  std::string own_flow, own_solid;    // commands of the user's own programs in the place of our servers; empty: ours
  std::filesystem::path resume;       // run folder or checkpoint to continue from; empty: start at t = 0
  std::int64_t steps = 0;             // stop after so many steps; 0: at the end of the scene
  int restarts = 3;                   // in a row without a further checkpoint, after the loss of a program; 0: none
  bool quiet = false;
  bool force = false;  // write into a folder that already holds a run
  bool report = true;  // write report.html at the end
};

}  // namespace couplet::launcher
