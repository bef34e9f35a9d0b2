#include "proto/store/result_reader.hpp"

#include <algorithm>
#include <sstream>

#include "proto/report/failure.hpp"
#include "proto/store/result_layout.hpp"

namespace couplet::store {

namespace {

std::vector<std::string> split(const std::string& names) {
  std::vector<std::string> parts;
  std::istringstream stream(names);
  for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
  return parts;
}

ResultMesh read_mesh(const Hdf5File& file, const std::filesystem::path& path) {
  const std::string name = file.read_text("mesh/shape");
  const auto layout =
      std::find_if(cell_layouts.begin(), cell_layouts.end(), [&](const CellLayout& l) { return l.name == name; });
  if (layout == cell_layouts.end())
    throw report::FileError(path.string(), "has cells of the unknown shape \"" + name + "\"");
  ResultMesh mesh{layout->shape, file.read("mesh/position"), file.read_integers("mesh/cell")};
  for (const std::string& number : split(file.read_text("mesh/cell_numbers")))
    mesh.cell_number.push_back({number, file.read_integers(mesh_dataset(number))});
  return mesh;
}

}  // namespace

ResultReader::ResultReader(const std::filesystem::path& results_folder, const std::string& name)
    : folder_(results_folder), name_(name) {
  for (;; ++n_blocks_) {
    const auto path = folder_ / block_file_name(name_, n_blocks_);
    if (n_blocks_ > 0 && !std::filesystem::exists(path)) break;
    const Hdf5File file = Hdf5File::open_for_reading(path);
    if (n_blocks_ == 0) {
      mesh_ = read_mesh(file, path);
      field_names_ = split(file.read_text("field_names"));
      cell_field_names_ = split(file.read_text("cell_field_names"));
    }
    const auto n_states = file.read_integers("n_states").at(0);
    const auto times = file.read("time");
    if (n_states > times.rows()) throw report::FileError(path.string(), "counts more states than it holds");
    for (std::int64_t slot = 0; slot < n_states; ++slot) states_.push_back({times(slot, 0), n_blocks_, slot});
  }
}

surface::NodeArray ResultReader::field(std::size_t state, const std::string& name) const {
  const StatePlace& place = states_.at(state);
  const auto file = Hdf5File::open_for_reading(folder_ / block_file_name(name_, place.block));
  return file.read(state_dataset(place.slot, name));
}

}  // namespace couplet::store
