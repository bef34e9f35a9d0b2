#include "proto/store/state_block.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstring>

#include "proto/report/failure.hpp"
#include "proto/store/result_layout.hpp"
#include "proto/store/run_folder.hpp"

namespace couplet::store {

namespace {

void write_mesh(Hdf5File& file, const ResultMesh& mesh) {
  file.write("mesh/position", mesh.node_position);
  file.write("mesh/cell", mesh.cell_node, layout_of(mesh.shape).n_columns);
  file.write_text("mesh/shape", layout_of(mesh.shape).name);
  std::string names;
  for (const ResultMesh::CellNumber& number : mesh.cell_number) {
    file.write(mesh_dataset(number.name), number.value);
    names += (names.empty() ? "" : ",") + number.name;
  }
  file.write_text("mesh/cell_numbers", names);
}

/// Of the fields of nodes, or of cells.
std::string joined_names(const std::vector<XdmfField>& arrays, bool is_of_cells) {
  std::string names;
  for (const XdmfField& array : arrays)
    if (array.is_of_cells == is_of_cells && array.name != moved_position)
      names += (names.empty() ? "" : ",") + array.name;
  return names;
}

int open_for_writing(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) throw report::FileError(path.string(), "cannot write: " + std::string(std::strerror(errno)));
  return file;
}

void write_bytes(int file, const std::filesystem::path& path, std::int64_t offset, const void* data, std::size_t size) {
  const char* bytes = static_cast<const char*>(data);
  while (size > 0) {
    const auto count = ::pwrite(file, bytes, size, offset);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0)
      throw report::FileError(path.string(), "cannot write a state: " + std::string(std::strerror(errno)),
                              "free some space and resume from the last checkpoint");
    bytes += count;
    offset += count;
    size -= static_cast<std::size_t>(count);
  }
}

}  // namespace

void cut_block(const std::filesystem::path& path, std::int64_t n_states) {
  const std::int64_t offset = Hdf5File::open_for_reading(path).offset_of("n_states");
  const int file = open_for_writing(path);
  write_bytes(file, path, offset, &n_states, sizeof n_states);
  ::close(file);
}

StateBlock::StateBlock(const std::filesystem::path& path, std::int64_t n_slots, const StateRows& rows,
                       const std::vector<XdmfField>& arrays, const ResultMesh* mesh)
    : path_(path), n_slots_(n_slots) {
  const std::filesystem::path part = unfinished(path);
  Hdf5File file = Hdf5File::create(part);
  if (mesh != nullptr) write_mesh(file, *mesh);
  file.write_text("field_names", joined_names(arrays, false));
  file.write_text("cell_field_names", joined_names(arrays, true));
  count_offset_ = file.reserve_integer("n_states", 1);
  time_offset_ = file.reserve_double("time", n_slots);
  for (std::int64_t slot = 0; slot < n_slots; ++slot) {
    for (const XdmfField& array : arrays)
      array_offset_.push_back(file.reserve_float(state_dataset(slot, array.name),
                                                 array.is_of_cells ? rows.n_cells : rows.n_nodes, array.n_components));
  }
  file.close();
  file_ = open_for_writing(part);
  write_at(count_offset_, &n_states_, sizeof n_states_);
  try {
    put_in_place(path);
  } catch (...) {
    ::close(file_);  // no destructor runs for what was never made
    throw;
  }
}

StateBlock::~StateBlock() {
  ::close(file_);
}

void StateBlock::write_at(std::int64_t offset, const void* data, std::size_t size) const {
  write_bytes(file_, path_, offset, data, size);
}

void StateBlock::append(double time, const std::vector<const surface::NodeArray*>& values) {
  assert(!is_full());
  const auto n_arrays = static_cast<std::int64_t>(values.size());
  for (std::int64_t array = 0; array < n_arrays; ++array) {
    const surface::NodeArray& source = *values[array];
    single_.resize(static_cast<std::size_t>(source.size()));
    std::transform(source.data(), source.data() + source.size(), single_.begin(),
                   [](double value) { return static_cast<float>(value); });
    write_at(array_offset_[n_states_ * n_arrays + array], single_.data(), single_.size() * sizeof(float));
  }
  write_at(time_offset_ + n_states_ * static_cast<std::int64_t>(sizeof time), &time, sizeof time);
  const std::int64_t n_complete = n_states_ + 1;
  write_at(count_offset_, &n_complete, sizeof n_complete);
  n_states_ = n_complete;
}

}  // namespace couplet::store
