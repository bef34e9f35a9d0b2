#pragma once
// Reads back the fields over time that a ResultWriter left, also those of a run that was killed.

#include <filesystem>
#include <string>
#include <vector>

#include "proto/store/result_file.hpp"

namespace couplet::store {

class ResultReader {
 public:
  /// Throws FileError when there is no such result.
  ResultReader(const std::filesystem::path& results_folder, const std::string& name);

  std::size_t n_states() const { return states_.size(); }
  double time(std::size_t state) const { return states_[state].time; }          // [s], rising
  const std::vector<std::string>& field_names() const { return field_names_; }  // of nodes
  const std::vector<std::string>& cell_field_names() const { return cell_field_names_; }
  const ResultMesh& mesh() const { return mesh_; }

  /// A field at one of the states, (n_nodes or n_cells, n_components), in the precision of its file.
  surface::NodeArray field(std::size_t state, const std::string& name) const;

  /// Where a state lies, for who continues the result.
  struct StatePlace {
    double time = 0;
    int block = 0;
    std::int64_t slot = 0;
  };
  const std::vector<StatePlace>& states() const { return states_; }
  int n_blocks() const { return n_blocks_; }

 private:
  std::filesystem::path folder_;
  std::string name_;
  ResultMesh mesh_;
  std::vector<std::string> field_names_, cell_field_names_;
  std::vector<StatePlace> states_;
  int n_blocks_ = 0;
};

}  // namespace couplet::store
