#include "coupler/checkpoint/coupled_checkpoint.hpp"

#include <sstream>

#include "proto/store/hdf5_file.hpp"

namespace couplet::coupling {

namespace {

// An array without entries keeps its shape beside it: a dataset must have entries.
void write_state(const std::filesystem::path& path, const SavedState& state) {
  store::Hdf5File file = store::Hdf5File::create(path);
  std::string names;
  for (const auto& [name, array] : state) {
    names += name + "\n";
    file.write(name + "/shape", std::vector<std::int64_t>{array.rows(), array.cols()});
    if (array.size() > 0) file.write(name + "/values", surface::NodeArray(array));
  }
  file.write_text("names", names);
  file.close();
}

}  // namespace

void write_coupled_checkpoint(const std::filesystem::path& checkpoints, std::int64_t step,
                              participant::Participant& flow, participant::Participant& solid,
                              const SavedState& state) {
  const store::CheckpointFolder folder = store::make_checkpoint_folder(checkpoints, step);
  flow.write_checkpoint(folder.participant_file("flow").string());
  solid.write_checkpoint(folder.participant_file("solid").string());
  write_state(folder.participant_file("coupler"), state);
  store::complete_checkpoint(folder);
}

SavedState read_coupler_state(const store::CheckpointFolder& folder) {
  const store::Hdf5File file = store::Hdf5File::open_for_reading(folder.participant_file("coupler"));
  SavedState state;
  std::istringstream names(file.read_text("names"));
  for (std::string name; std::getline(names, name);) {
    const std::vector<std::int64_t> shape = file.read_integers(name + "/shape");
    Eigen::MatrixXd array(shape.at(0), shape.at(1));
    if (array.size() > 0) array = file.read(name + "/values");
    state[name] = std::move(array);
  }
  return state;
}

}  // namespace couplet::coupling
