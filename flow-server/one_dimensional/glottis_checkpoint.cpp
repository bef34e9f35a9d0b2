#include "flow-server/one_dimensional/glottis_checkpoint.hpp"

#include <array>
#include <string>

#include "proto/report/failure.hpp"
#include "proto/store/hdf5_file.hpp"

namespace couplet::flow {

namespace {

constexpr auto layout = "glottal flow 1";

/// The arrays of a solution, one column each.
template <typename Solution>
auto columns_of(Solution& solution) {
  return std::array{&solution.position, &solution.effective_area, &solution.volume, &solution.velocity,
                    &solution.pressure};
}
constexpr int n_columns = 5;

void write_solution(store::Hdf5File& file, const std::string& name, const GlottalSolution& solution) {
  surface::NodeArray table(solution.position.size(), n_columns);
  const auto columns = columns_of(solution);
  for (int c = 0; c < n_columns; ++c) table.col(c) = columns[static_cast<std::size_t>(c)]->matrix();
  file.write(name + "/stations", table);
  file.write_number(name + "/exit", solution.exit);
  file.write_number(name + "/inlet_rate", solution.inlet_rate);
  file.write_number(name + "/exit_rate", solution.exit_rate);
  file.write_integer(name + "/throat", solution.throat);
}

GlottalSolution read_solution(const store::Hdf5File& file, const std::string& name, int n_stations) {
  const surface::NodeArray table = file.read(name + "/stations");
  if (table.rows() != n_stations || table.cols() != n_columns) {
    throw report::FileError(
        file.path().string(),
        "it holds " + std::to_string(table.rows()) + " stations, the scene has " + std::to_string(n_stations),
        "resume with the scene that wrote the checkpoint");
  }
  GlottalSolution solution;
  const auto columns = columns_of(solution);
  for (int c = 0; c < n_columns; ++c) *columns[static_cast<std::size_t>(c)] = table.col(c).array();
  solution.exit = file.read_number(name + "/exit");
  solution.inlet_rate = file.read_number(name + "/inlet_rate");
  solution.exit_rate = file.read_number(name + "/exit_rate");
  solution.throat = static_cast<int>(file.read_integer(name + "/throat"));
  return solution;
}

}  // namespace

void write_glottis_checkpoint(const std::filesystem::path& path, const GlottisCheckpoint& state) {
  store::Hdf5File file = store::Hdf5File::create(path);
  file.write_text("kind", layout);
  file.write_number("time", state.time);
  file.write_number("clipped_steps", state.n_clipped);
  file.write_number("previous_step", state.history.previous_step);
  file.write_integer("has_earlier", state.history.has_earlier ? 1 : 0);
  write_solution(file, "accepted", state.history.accepted);
  write_solution(file, "earlier", state.history.earlier);
  if (state.force.rows() > 0) file.write("force", state.force);
  file.close();
}

GlottisCheckpoint read_glottis_checkpoint(const std::filesystem::path& path, int n_stations, std::int64_t n_nodes) {
  const store::Hdf5File file = store::Hdf5File::open_for_reading(path);
  if (!file.contains("kind") || file.read_text("kind") != layout) {
    throw report::FileError(path.string(), "it is not a checkpoint of the glottal flow of this version",
                            "resume with the scene and the version that wrote it");
  }
  GlottisCheckpoint state;
  state.time = file.read_number("time");
  state.n_clipped = file.read_number("clipped_steps");
  state.history.previous_step = file.read_number("previous_step");
  state.history.has_earlier = file.read_integer("has_earlier") != 0;
  state.history.accepted = read_solution(file, "accepted", n_stations);
  state.history.earlier = read_solution(file, "earlier", n_stations);
  state.force = file.contains("force") ? file.read("force") : surface::NodeArray::Zero(0, 3);
  if (state.force.rows() != n_nodes) {
    throw report::FileError(path.string(),
                            "it holds " + std::to_string(state.force.rows()) + " interface nodes, the surface has " +
                                std::to_string(n_nodes),
                            "resume with the scene that wrote the checkpoint");
  }
  return state;
}

}  // namespace couplet::flow
