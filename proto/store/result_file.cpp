#include "proto/store/result_file.hpp"

#include <algorithm>
#include <cassert>
#include <optional>

#include "proto/report/failure.hpp"
#include "proto/store/result_layout.hpp"
#include "proto/store/result_reader.hpp"
#include "proto/store/run_folder.hpp"
#include "proto/store/state_block.hpp"
#include "proto/store/xdmf_text.hpp"

namespace couplet::store {

namespace {

constexpr std::int64_t slots_of_first_block = 16;
constexpr std::int64_t block_bytes_max = std::int64_t{256} << 20;
constexpr std::int64_t listing_lag = 256;  // states for each of which the XDMF file may lag behind by one

/// A polyline is drawn as its segments: one kind of cell that every reader knows.
ResultMesh drawn(const ResultMesh& mesh) {
  if (mesh.shape != CellShape::polyline) return mesh;
  ResultMesh segments{mesh.shape, mesh.node_position, {}};
  for (std::size_t node = 0; node + 1 < mesh.cell_node.size(); ++node)
    segments.cell_node.insert(segments.cell_node.end(), {mesh.cell_node[node], mesh.cell_node[node + 1]});
  return segments;
}

bool is_same(const ResultMesh& a, const ResultMesh& b) {
  return a.shape == b.shape && a.cell_node == b.cell_node && a.node_position.rows() == b.node_position.rows() &&
         a.node_position == b.node_position &&
         std::equal(a.cell_number.begin(), a.cell_number.end(), b.cell_number.begin(), b.cell_number.end(),
                    [](const auto& m, const auto& n) { return m.name == n.name && m.value == n.value; });
}

void remove_blocks(const std::filesystem::path& folder, const std::string& name, int first) {
  int last = first;
  while (std::filesystem::exists(folder / block_file_name(name, last))) ++last;
  std::error_code error;  // a file that stays is replaced later or found then
  for (int block = last - 1; block >= first; --block)
    std::filesystem::remove(folder / block_file_name(name, block), error);
}

}  // namespace

std::int64_t cell_code(CellShape shape) {
  switch (shape) {
    case CellShape::hexahedron20:
      return 48;
    case CellShape::hexahedron8:
      return 9;
    case CellShape::tetrahedron10:
      return 38;
    case CellShape::triangle:
      return 4;
    case CellShape::quadrilateral:
      return 5;
    case CellShape::polyline:
    case CellShape::mixed:
      break;
  }
  assert(false);
  return 0;
}

std::int64_t count_cells(CellShape shape, const std::vector<std::int64_t>& cell_node) {
  if (shape != CellShape::mixed) return static_cast<std::int64_t>(cell_node.size()) / layout_of(shape).n_columns;
  std::int64_t n_cells = 0;
  for (std::size_t at = 0; at < cell_node.size(); ++n_cells) {
    const std::int64_t code = cell_node[at];
    const auto kind = std::find_if(cell_layouts.begin(), cell_layouts.end(), [code](const CellLayout& layout) {
      return layout.shape != CellShape::polyline && layout.shape != CellShape::mixed && cell_code(layout.shape) == code;
    });
    assert(kind != cell_layouts.end());
    at += 1 + static_cast<std::size_t>(kind->n_columns);
  }
  return n_cells;
}

struct ResultWriter::State {
  State(const std::filesystem::path& in, const std::string& name_of_result, const ResultMesh& given)
      : folder(in), name(name_of_result), mesh(drawn(given)), n_cells(count_cells(mesh.shape, mesh.cell_node)) {}

  std::filesystem::path folder;
  std::string name;
  ResultMesh mesh;
  std::int64_t n_cells;
  std::vector<XdmfField> fields;  // known from the first append on
  bool is_moving = false;
  std::optional<StateBlock> block;
  int n_blocks = 0;
  std::int64_t next_slots = slots_of_first_block;
  std::string listed_states;  // text of all states for the XDMF file
  std::int64_t n_states = 0, n_states_on_disk = 0;

  XdmfMesh xdmf_mesh() const {
    XdmfMesh out{mesh.shape, mesh.node_position.rows(), n_cells, static_cast<std::int64_t>(mesh.cell_node.size()),
                 block_file_name(name, 0)};
    for (const auto& number : mesh.cell_number) out.cell_number.push_back(number.name);
    return out;
  }

  void learn_fields(const surface::FieldSet& of_nodes, const surface::FieldSet& of_cells);
  void open_next_block();
  void list_state(double time, int in_block, std::int64_t slot);
  void write_listing();
};

void ResultWriter::State::learn_fields(const surface::FieldSet& of_nodes, const surface::FieldSet& of_cells) {
  const auto learn = [&](const surface::Field& field, bool is_of_cells) {
    assert(field.values.rows() == (is_of_cells ? n_cells : mesh.node_position.rows()));
    assert(field.values.cols() == 1 || field.values.cols() == 3 || field.values.cols() == 9);
    fields.push_back({field.name, field.values.cols(), is_of_cells});
  };
  for (const surface::Field& field : of_nodes) {
    learn(field, false);
    is_moving = is_moving || field.name == "displacement";
  }
  for (const surface::Field& field : of_cells) learn(field, true);
}

void ResultWriter::State::open_next_block() {
  std::vector<XdmfField> arrays = fields;
  if (is_moving) arrays.push_back({moved_position, 3});
  std::int64_t state_bytes = 1;
  const std::int64_t n_nodes = mesh.node_position.rows();
  for (const XdmfField& array : arrays)
    state_bytes += array.n_components * (array.is_of_cells ? n_cells : n_nodes) * std::int64_t{sizeof(float)};
  const std::int64_t n_slots = std::clamp<std::int64_t>(block_bytes_max / state_bytes, 1, next_slots);
  block.reset();
  block.emplace(folder / block_file_name(name, n_blocks), n_slots, StateRows{n_nodes, n_cells}, arrays,
                n_blocks == 0 ? &mesh : nullptr);
  ++n_blocks;
  next_slots *= 2;
}

void ResultWriter::State::list_state(double time, int in_block, std::int64_t slot) {
  listed_states += xdmf_state(xdmf_mesh(), fields, is_moving, time, block_file_name(name, in_block), slot);
  ++n_states;
}

void ResultWriter::State::write_listing() {
  write_file(folder / (name + ".xmf"), xdmf_start(name) + listed_states + xdmf_end());
  n_states_on_disk = n_states;
}

ResultWriter::ResultWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
ResultWriter::ResultWriter(ResultWriter&&) noexcept = default;

ResultWriter::ResultWriter(const std::filesystem::path& results_folder, const std::string& name, const ResultMesh& mesh)
    : state_(std::make_unique<State>(results_folder, name, mesh)) {
  std::error_code error;
  std::filesystem::remove(results_folder / (name + ".xmf"), error);
  remove_blocks(results_folder, name, 0);
}

ResultWriter ResultWriter::continue_from(const std::filesystem::path& results_folder, const std::string& name,
                                         const ResultMesh& mesh, double time) {
  if (!std::filesystem::exists(results_folder / block_file_name(name, 0)))
    return ResultWriter(results_folder, name, mesh);
  const ResultReader reader(results_folder, name);
  auto state = std::make_unique<State>(results_folder, name, mesh);
  if (!is_same(reader.mesh(), state->mesh))
    throw report::FileError((results_folder / block_file_name(name, 0)).string(), "belongs to another mesh",
                            "resume into another run folder, or remove these results");
  auto states = reader.states();
  std::erase_if(states, [&](const auto& place) { return place.time > time; });
  if (states.empty()) return ResultWriter(results_folder, name, mesh);
  const auto stored = [&](const std::vector<std::string>& names) {
    surface::FieldSet fields;
    for (const std::string& field : names) fields.push_back({field, "", reader.field(0, field)});
    return fields;
  };
  state->learn_fields(stored(reader.field_names()), stored(reader.cell_field_names()));
  for (const auto& place : states) state->list_state(place.time, place.block, place.slot);
  state->n_blocks = states.back().block + 1;
  state->write_listing();  // before the states go that it no longer names
  remove_blocks(results_folder, name, state->n_blocks);
  cut_block(results_folder / block_file_name(name, states.back().block), states.back().slot + 1);
  return ResultWriter(std::move(state));
}

ResultWriter::~ResultWriter() {
  if (state_ == nullptr || state_->n_states_on_disk == state_->n_states) return;
  try {
    state_->write_listing();
  } catch (const report::FileError&) {
    // The last states are missing from the listing, as after a kill; nobody above can do more about it.
  }
}

void ResultWriter::append(double time, const surface::FieldSet& fields, const surface::FieldSet& cell_fields) {
  if (state_->fields.empty()) state_->learn_fields(fields, cell_fields);
  assert(fields.size() + cell_fields.size() == state_->fields.size());
  if (!state_->block || state_->block->is_full()) state_->open_next_block();
  std::vector<const surface::NodeArray*> arrays;
  for (const surface::FieldSet* set : {&fields, &cell_fields})
    for (const surface::Field& field : *set) arrays.push_back(&field.values);
  surface::NodeArray moved;
  if (state_->is_moving) {
    moved = state_->mesh.node_position + surface::find_field(fields, "displacement").values;
    arrays.push_back(&moved);
  }
  state_->block->append(time, arrays);
  state_->list_state(time, state_->n_blocks - 1, state_->block->n_states() - 1);
  if (state_->n_states - state_->n_states_on_disk > state_->n_states / listing_lag) state_->write_listing();
}

}  // namespace couplet::store
