#pragma once
// One HDF5 file with reserved places for states, filled without touching its structure.

#include <cstdint>
#include <filesystem>
#include <vector>

#include "proto/store/result_file.hpp"
#include "proto/store/xdmf_text.hpp"

namespace couplet::store {

/// Drops the states of a block from `n_states` on.
void cut_block(const std::filesystem::path& path, std::int64_t n_states);

struct StateRows {
  std::int64_t n_nodes = 0, n_cells = 0;
};

class StateBlock {
 public:
  /// Makes the file complete under another name, then gives it its own. `arrays` of a state: fields, then the moved
  /// nodes where there are some. `mesh` is null for all blocks but the first.
  StateBlock(const std::filesystem::path& path, std::int64_t n_slots, const StateRows& rows,
             const std::vector<XdmfField>& arrays, const ResultMesh* mesh);
  StateBlock(const StateBlock&) = delete;
  StateBlock& operator=(const StateBlock&) = delete;
  ~StateBlock();

  std::int64_t n_states() const { return n_states_; }
  bool is_full() const { return n_states_ == n_slots_; }

  /// The arrays of one state in the order of `arrays`; the state counts only when all of it is there.
  void append(double time, const std::vector<const surface::NodeArray*>& values);

 private:
  void write_at(std::int64_t offset, const void* data, std::size_t size) const;

  std::filesystem::path path_;
  std::int64_t n_slots_, n_states_ = 0;
  std::vector<std::int64_t> array_offset_;  // (n_slots * n_arrays) [byte]
  std::int64_t time_offset_ = 0, count_offset_ = 0;
  std::vector<float> single_;
  int file_ = -1;
};

}  // namespace couplet::store
