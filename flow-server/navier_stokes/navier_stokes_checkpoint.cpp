#include "flow-server/navier_stokes/navier_stokes_checkpoint.hpp"

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "flow-server/output/parallel_file.hpp"
#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {

const std::string kind = "navier-stokes flow 2";

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

/// Lists of all ranks one behind the other. A list without any entry is not written.
void write_joined(ParallelFile& file, const std::string& name, const std::vector<double>& mine, MPI_Comm ranks) {
  int rank = 0;
  MPI_Comm_rank(ranks, &rank);
  const std::int64_t n = static_cast<std::int64_t>(mine.size());
  std::int64_t before = 0, all = 0;
  MPI_Exscan(&n, &before, 1, MPI_INT64_T, MPI_SUM, ranks);
  if (rank == 0) before = 0;  // not set there by the library
  MPI_Allreduce(&n, &all, 1, MPI_INT64_T, MPI_SUM, ranks);
  if (all == 0) return;
  file.write(name, {{static_cast<hsize_t>(all)}, {static_cast<hsize_t>(before)}, {static_cast<hsize_t>(n)}},
             mine.data(), Precision::full);
}

std::vector<double> read_joined(const ParallelFile& file, const std::string& name) {
  return file.contains(name) ? file.read_list(name) : std::vector<double>{};
}

Triple of_grid(Triple local, const Box& mine) {
  for (int d = 0; d < 3; ++d) local[d] += mine.begin[d];
  return local;
}

void append(std::vector<double>& list, const Triple& indices) {
  for (int d = 0; d < 3; ++d) list.push_back(indices[d]);
}

Triple triple_at(const std::vector<double>& list, std::size_t first) {
  return {static_cast<int>(list.at(first)), static_cast<int>(list.at(first + 1)), static_cast<int>(list.at(first + 2))};
}

void write_array(ParallelFile& file, const std::string& name, const surface::NodeArray& array) {
  file.write_list(name, std::vector<double>(array.data(), array.data() + array.size()));
}

surface::NodeArray read_array(const ParallelFile& file, const std::string& name) {
  const std::vector<double> list = file.read_list(name);
  surface::NodeArray array(static_cast<Eigen::Index>(list.size() / 3), 3);
  std::copy_n(list.begin(), array.size(), array.data());
  return array;
}

/// Part i of a cell as (cell, number in it), for the further parts of cut cells.
std::pair<Triple, int> place_of(const CutCells& cut, int part) {
  const CutCell& cell = cut.cells()[static_cast<std::size_t>(cut.parts()[static_cast<std::size_t>(part)].cell)];
  return {cell.cell, part - cell.first_part};
}

void write_bodies(ParallelFile& file, const BodyGeometry& bodies, const BlockDecomposition& decomposition,
                  const std::optional<NodalMotion>& motion) {
  std::string names;
  for (const BodySurface& surface : bodies.surfaces()) names += surface.name + "\n";
  file.write_text("bodies/names", names);
  if (motion) {
    file.write_list("bodies/motion_time", {motion->time});
    write_array(file, "bodies/displacement", motion->displacement);
    write_array(file, "bodies/velocity", motion->velocity);
  }
  const Box cells = box_of(decomposition.mine().sizes());
  std::vector<double> parts, faces;
  for (std::size_t f = 0; f < bodies.cut().further_parts().size(); ++f) {
    const auto [cell, number] = place_of(bodies.cut(), bodies.cut().further_parts()[f]);
    if (!cells.contains(cell)) continue;  // the rank that owns it writes it
    append(parts, of_grid(cell, decomposition.mine()));
    parts.push_back(number);
    parts.push_back(bodies.piece_pressure[f]);
  }
  for (const BodyGeometry::ChangedFace& changed : bodies.changed_faces) {
    faces.push_back(changed.component);
    append(faces, of_grid(changed.face, decomposition.mine()));
    faces.push_back(changed.closed);
  }
  write_joined(file, "bodies/parts", parts, decomposition.communicator());
  write_joined(file, "bodies/changed_faces", faces, decomposition.communicator());
}

StoredBodies read_bodies(const ParallelFile& file) {
  StoredBodies stored;
  if (!file.contains("bodies/names")) return stored;
  const std::string names = file.read_text("bodies/names");
  for (std::size_t begin = 0, end = 0; (end = names.find('\n', begin)) != std::string::npos; begin = end + 1)
    stored.names.push_back(names.substr(begin, end - begin));
  if (file.contains("bodies/motion_time"))
    stored.motion = NodalMotion{file.read_list("bodies/motion_time").at(0), read_array(file, "bodies/displacement"),
                                read_array(file, "bodies/velocity")};
  const std::vector<double> parts = read_joined(file, "bodies/parts");
  for (std::size_t at = 0; at + 5 <= parts.size(); at += 5)
    stored.parts.push_back({triple_at(parts, at), static_cast<int>(parts[at + 3]), parts[at + 4]});
  const std::vector<double> faces = read_joined(file, "bodies/changed_faces");
  for (std::size_t at = 0; at + 5 <= faces.size(); at += 5)
    stored.changed_faces.push_back({static_cast<int>(faces[at]), triple_at(faces, at + 1), faces[at + 4]});
  return stored;
}

}  // namespace

int restore_bodies(const StoredBodies& stored, const StretchedGrid& grid, const BlockDecomposition& decomposition,
                   FlowState& state) {
  std::map<std::pair<Triple, int>, double> pressure;
  for (const StoredBodies::Part& part : stored.parts) pressure[{part.cell, part.number}] = part.pressure;
  BodyGeometry& bodies = *state.bodies;
  const Box& mine = decomposition.mine();
  const Box cells = box_of(mine.sizes());
  int n_missing = 0;
  for (std::size_t f = 0; f < bodies.cut().further_parts().size(); ++f) {
    const auto [local, number] = place_of(bodies.cut(), bodies.cut().further_parts()[f]);
    Triple cell = of_grid(local, mine);
    for (int d = 0; d < 3; ++d) {
      const int n = grid.n_cells()[d];
      if (grid.is_periodic()[d]) cell[d] = (cell[d] + n) % n;
    }
    const auto found = pressure.find({cell, number});
    if (found != pressure.end()) {
      bodies.piece_pressure[f] = found->second;
    } else if (cells.contains(local)) {
      ++n_missing;
    }
  }
  // Faces at the start of the grid are those of the rank that begins there.
  bodies.changed_faces.clear();
  for (BodyGeometry::ChangedFace changed : stored.changed_faces) {
    const int c = changed.component;
    Box faces = mine;
    if (faces.begin[c] == 0) --faces.begin[c];
    if (!faces.contains(changed.face)) continue;
    for (int d = 0; d < 3; ++d) changed.face[d] -= mine.begin[d];
    bodies.changed_faces.push_back(changed);
  }
  return n_missing;
}

void write_navier_stokes_checkpoint(const std::filesystem::path& path, const FlowState& state,
                                    const StretchedGrid& grid, const BlockDecomposition& decomposition,
                                    const std::optional<NodalMotion>& motion) {
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
  if (state.bodies) write_bodies(file, *state.bodies, decomposition, motion);
  file.close();
}

StoredBodies read_navier_stokes_checkpoint(const std::filesystem::path& path, const StretchedGrid& grid,
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
  return read_bodies(file);
}

}  // namespace couplet::flow
