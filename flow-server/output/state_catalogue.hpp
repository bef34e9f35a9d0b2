#pragma once
// The small files that name the stored states of a flow. One process writes them.

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "flow-server/output/field_region.hpp"
#include "flow-server/output/surface_results.hpp"

namespace couplet::flow {

/// Of the file of a state: flow.000012.h5.
std::string state_file_name(std::int64_t number);

/// results/flow.h5 and, for each region results/NAME.xmf, for each body results/body.NAME.xmf. All are replaced as a
/// whole, and only after the files that they name are complete, so that after a kill at any moment they and all that
/// they name can be read.
class StateCatalogue {
 public:
  /// Removes what a killed run left unfinished. With time > 0 the states that are there are continued: those later than
  /// `time` are dropped. Otherwise all are. Throws FileError, also when the states are of other regions or bodies, or
  /// another grid.
  StateCatalogue(const std::filesystem::path& results_folder, const StretchedGrid& grid,
                 std::vector<FieldRegion> regions, std::vector<StoredSurface> surfaces, double time);
  StateCatalogue(const StateCatalogue&) = delete;
  StateCatalogue& operator=(const StateCatalogue&) = delete;
  /// Names the states that wait.
  ~StateCatalogue();

  /// The number that the next state has to take.
  std::int64_t next_number() const { return states_.empty() ? 0 : states_.back().number + 1; }

  /// The file of the next state is in its place. From some hundred states on not each is named at once: at most one in
  /// 256 waits. Throws FileError.
  void add(double time);

 private:
  struct State {
    std::int64_t number;
    double time;  // [s]
  };
  void remove_unfinished() const;
  void keep_states_up_to(double time);
  void refuse_another_grid() const;
  void refuse_other_bodies() const;
  void remove_states_not_kept() const;
  void list(const State& state);
  std::vector<std::string> names() const;  // of the .xmf files: of regions, then of bodies
  void write();

  std::filesystem::path folder_;
  std::vector<FieldRegion> regions_;
  std::vector<std::array<std::vector<double>, 3>> faces_;  // of each region's picture [m]
  std::vector<State> states_;
  std::vector<StoredSurface> surfaces_;
  std::vector<std::string> listed_;  // of each region, then of each body: the text of all states for its .xmf
  std::size_t n_named_ = 0;          // states that the files on disk name
};

}  // namespace couplet::flow
