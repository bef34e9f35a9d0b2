#include "flow-server/navier_stokes/navier_stokes_checkpoint.hpp"

#include <string>
#include <vector>

#include "flow-server/output/parallel_file.hpp"
#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {

const std::string kind = "navier-stokes flow 1";

/// A rank's part of a field of the whole. Faces along a direction are one more than cells: entry 0 of the file is the
/// first face of the grid, which is entry -1 of the rank that begins there.
struct FieldPart {
  Box cells;  // local
  ArrayBlock block;
};

FieldPart part_of(const BlockDecomposition& decomposition, int face_direction) {
  const Box& mine = decomposition.mine();
  FieldPart part{box_of(mine.sizes()), {}};
  for (int d = 2; d >= 0; --d) {
    const bool has_faces = d == face_direction;
    const bool is_first = mine.begin[d] == 0;
    const int n_all = decomposition.all().size(d) + (has_faces ? 1 : 0);
    if (has_faces && is_first) part.cells.begin[d] = -1;
    const int begin = mine.begin[d] + (has_faces && !is_first ? 1 : 0);
    part.block.shape.push_back(static_cast<hsize_t>(n_all));
    part.block.start.push_back(static_cast<hsize_t>(begin));
    part.block.count.push_back(decomposition.has_cells() ? static_cast<hsize_t>(part.cells.size(d)) : 0);
  }
  return part;
}

template <class Visit>
void for_each_entry(const FieldPart& part, bool has_cells, Visit visit) {
  if (!has_cells) return;
  const Box& cells = part.cells;
  for (int k = cells.begin[2]; k < cells.end[2]; ++k)
    for (int j = cells.begin[1]; j < cells.end[1]; ++j)
      for (int i = cells.begin[0]; i < cells.end[0]; ++i) visit(i, j, k);
}

void write_field(ParallelFile& file, const std::string& name, const Field<double>& field,
                 const BlockDecomposition& decomposition, int face_direction) {
  const FieldPart part = part_of(decomposition, face_direction);
  std::vector<double> values;
  for_each_entry(part, decomposition.has_cells(), [&](int i, int j, int k) { values.push_back(field(i, j, k)); });
  file.write(name, part.block, values.data(), Precision::full);
}

void read_field(const ParallelFile& file, const std::string& name, Field<double>& field,
                const BlockDecomposition& decomposition, int face_direction) {
  const FieldPart part = part_of(decomposition, face_direction);
  std::vector<double> values(decomposition.has_cells() ? static_cast<std::size_t>(part.cells.n_cells()) : 0);
  file.read(name, part.block, values.data());
  std::size_t next = 0;
  for_each_entry(part, decomposition.has_cells(), [&](int i, int j, int k) { field(i, j, k) = values[next++]; });
}

std::string component(const std::string& name, int d) {
  return name + "_" + std::string(1, "xyz"[d]);
}

}  // namespace

void write_navier_stokes_checkpoint(const std::filesystem::path& path, const FlowState& state,
                                    const StretchedGrid& grid, const BlockDecomposition& decomposition) {
  ParallelFile file = ParallelFile::create(path, decomposition.communicator());
  file.write_text("kind", kind);
  file.write_list("clock", {state.time, state.pressure_time, state.last_step});
  file.write_list("known", {state.courant_rate, state.largest_speed, static_cast<double>(state.rate_kind)});
  for (int d = 0; d < 3; ++d) file.write_list(component("face", d), grid.axis[d].faces());
  for (int d = 0; d < grid.n_dimensions; ++d)
    write_field(file, component("velocity", d), state.velocity[d], decomposition, d);
  write_field(file, "pressure", state.pressure, decomposition, -1);
  for (int d = 0; d < grid.n_dimensions && state.rate_kind != RateKind::none; ++d)
    write_field(file, component("rate", d), state.rate[d], decomposition, d);
  file.close();
}

void read_navier_stokes_checkpoint(const std::filesystem::path& path, const StretchedGrid& grid,
                                   const BlockDecomposition& decomposition, FlowState& state) {
  const ParallelFile file = ParallelFile::open_for_reading(path, decomposition.communicator());
  if (!file.contains("kind") || file.read_text("kind") != kind) {
    throw report::FileError(path.string(), "it is not a checkpoint of a Navier-Stokes flow of this version",
                            "resume with the scene and the version that wrote it");
  }
  for (int d = 0; d < 3; ++d) {
    if (file.read_list(component("face", d)) == grid.axis[d].faces()) continue;
    throw report::FileError(path.string(),
                            "its cells along " + std::string(1, "xyz"[d]) + " are not those of the scene",
                            "resume with the grid of the run that wrote the checkpoint");
  }
  const std::vector<double> clock = file.read_list("clock");
  state.time = clock.at(0);
  state.pressure_time = clock.at(1);
  state.last_step = clock.at(2);
  const std::vector<double> known = file.read_list("known");
  state.courant_rate = known.at(0);
  state.largest_speed = known.at(1);
  state.rate_kind = static_cast<RateKind>(static_cast<int>(known.at(2)));
  for (int d = 0; d < grid.n_dimensions; ++d)
    read_field(file, component("velocity", d), state.velocity[d], decomposition, d);
  read_field(file, "pressure", state.pressure, decomposition, -1);
  for (int d = 0; d < grid.n_dimensions; ++d) {
    if (!file.contains(component("rate", d))) continue;
    if (state.rate[d].is_empty() && decomposition.has_cells())
      state.rate[d] = Field<double>(state.velocity[d].sizes(), state.velocity[d].ghosts());
    read_field(file, component("rate", d), state.rate[d], decomposition, d);
  }
}

}  // namespace couplet::flow
