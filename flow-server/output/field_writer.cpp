#include "flow-server/output/field_writer.hpp"

#include <algorithm>
#include <charconv>
#include <iterator>

#include "proto/report/failure.hpp"
#include "proto/store/run_folder.hpp"

namespace couplet::flow {

namespace {

const std::string file_name = "flow.h5";

std::string name_of(FieldQuantity quantity) {
  switch (quantity) {
    case FieldQuantity::velocity:
      return "velocity";
    case FieldQuantity::pressure:
      return "pressure";
    case FieldQuantity::vorticity:
      return "vorticity";
    case FieldQuantity::q_criterion:
      return "q_criterion";
    case FieldQuantity::swirling_strength:
      return "swirling_strength";
  }
  return "unknown";
}

bool is_vector(FieldQuantity quantity) {
  return quantity == FieldQuantity::velocity || quantity == FieldQuantity::vorticity;
}

int divided_up(int a, int b) {
  return (a + b - 1) / b;
}

/// Cells of the picture of a region along a direction.
int n_picture_cells(const FieldRegion& region, int d) {
  return divided_up(region.cells.size(d), region.stride);
}

/// The cell of the grid whose value picture cell m shows.
int shown_cell(const FieldRegion& region, int d, int m) {
  const int begin = region.cells.begin[d] + m * region.stride;
  const int end = std::min(begin + region.stride, region.cells.end[d]);
  return begin + (end - begin - 1) / 2;
}

/// Picture cells that a rank shows: those whose shown cell it owns.
std::array<Interval, 3> own_picture(const FieldRegion& region, const Box& mine) {
  std::array<Interval, 3> own;
  for (int d = 0; d < 3; ++d) {
    int m = 0;
    const int n = n_picture_cells(region, d);
    while (m < n && shown_cell(region, d, m) < mine.begin[d]) ++m;
    own[d].begin = m;
    while (m < n && shown_cell(region, d, m) < mine.end[d]) ++m;
    own[d].end = m;
  }
  return own;
}

std::vector<double> picture_faces(const FieldRegion& region, const StretchedAxis& axis, int d) {
  std::vector<double> faces;
  for (int m = 0; m < n_picture_cells(region, d); ++m)
    faces.push_back(axis.face(region.cells.begin[d] + m * region.stride));
  faces.push_back(axis.face(region.cells.end[d]));
  return faces;
}

std::string state_group(std::size_t state) {
  std::string digits = std::to_string(state);
  return "state/" + std::string(digits.size() < 6 ? 6 - digits.size() : 0, '0') + digits;
}

ArrayBlock block_of(const FieldRegion& region, const std::array<Interval, 3>& own, bool has_components) {
  ArrayBlock block;
  for (int d = 2; d >= 0; --d) {
    block.shape.push_back(static_cast<hsize_t>(n_picture_cells(region, d)));
    block.start.push_back(static_cast<hsize_t>(own[d].begin));
    block.count.push_back(static_cast<hsize_t>(own[d].end - own[d].begin));
  }
  if (has_components) {
    block.shape.push_back(3);
    block.start.push_back(0);
    block.count.push_back(3);
  }
  return block;
}

void append_values(const FlowPart& part, FieldQuantity quantity, const Triple& cell, std::vector<double>& values) {
  const CellVelocity velocity(part.grid, part.origin(), part.state);
  const auto append = [&](const Vector3& vector) { values.insert(values.end(), vector.begin(), vector.end()); };
  if (!part.active.contains(cell[0], cell[1], cell[2])) {
    values.insert(values.end(), is_vector(quantity) ? 3 : 1, 0.0);
    return;
  }
  switch (quantity) {
    case FieldQuantity::velocity:
      return append(velocity.at(cell));
    case FieldQuantity::pressure:
      return values.push_back(part.state.pressure(cell[0], cell[1], cell[2]));
    case FieldQuantity::vorticity:
      return append(vorticity(velocity.gradient(cell)));
    case FieldQuantity::q_criterion:
      return values.push_back(q_criterion(velocity.gradient(cell)));
    case FieldQuantity::swirling_strength:
      return values.push_back(swirling_strength(velocity.gradient(cell)));
  }
}

std::string shortest(double value) {
  char digits[32];
  return {std::begin(digits), std::to_chars(std::begin(digits), std::end(digits), value).ptr};
}

std::string data_item(int bytes, const std::string& dimensions, const std::string& place) {
  return "<DataItem NumberType=\"Float\" Precision=\"" + std::to_string(bytes) + "\" Dimensions=\"" + dimensions +
         "\" Format=\"HDF\">" + file_name + ":/" + place + "</DataItem>";
}

/// XDMF 3, arrays slowest index first. Names of regions and fields hold nothing that means something to XML.
std::string listing_text(const FieldRegion& region, const std::vector<double>& times) {
  std::string text = "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n<Grid Name=\"" + region.name +
                     "\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  std::array<std::string, 3> n_cells, n_faces;
  for (int d = 0; d < 3; ++d) {
    n_cells[d] = std::to_string(n_picture_cells(region, d));
    n_faces[d] = std::to_string(n_picture_cells(region, d) + 1);
  }
  const std::string cells = n_cells[2] + " " + n_cells[1] + " " + n_cells[0];
  for (std::size_t state = 0; state < times.size(); ++state) {
    text +=
        "<Grid Name=\"" + region.name + "\" GridType=\"Uniform\"><Time Value=\"" + shortest(times[state]) + "\"/>\n";
    text += "<Topology TopologyType=\"3DRectMesh\" Dimensions=\"" + n_faces[2] + " " + n_faces[1] + " " + n_faces[0] +
            "\"/>\n<Geometry GeometryType=\"VXVYVZ\">";
    for (int d = 0; d < 3; ++d)
      text += data_item(8, n_faces[d], "grid/" + region.name + "/" + std::string(1, "xyz"[d]));
    text += "</Geometry>\n";
    const int bytes = region.precision == Precision::single ? 4 : 8;
    for (const FieldQuantity quantity : region.quantities) {
      const std::string name = name_of(quantity);
      text += "<Attribute Name=\"" + name + "\" AttributeType=\"" + (is_vector(quantity) ? "Vector" : "Scalar") +
              "\" Center=\"Cell\">" +
              data_item(bytes, cells + (is_vector(quantity) ? " 3" : ""),
                        state_group(state) + "/" + region.name + "/" + name) +
              "</Attribute>\n";
    }
    text += "</Grid>\n";
  }
  return text + "</Grid>\n</Domain>\n</Xdmf>\n";
}

/// Rank 0 alone looks at the folder and writes small files; the others learn whether it went well.
template <class Action>
void on_first_rank(const BlockDecomposition& decomposition, const std::filesystem::path& path, Action action) {
  int is_well = 1;
  std::string reason;
  if (decomposition.rank() == 0) {
    try {
      action();
    } catch (const report::FileError& failure) {
      is_well = 0;
      reason = failure.sentence();
    }
  }
  MPI_Bcast(&is_well, 1, MPI_INT, 0, decomposition.communicator());
  if (is_well == 0) {
    throw report::FileError(path.string(), reason.empty() ? "cannot be written" : reason,
                            "free some space and resume from the last checkpoint");
  }
}

}  // namespace

FieldWriter::FieldWriter(const std::filesystem::path& results_folder, const StretchedGrid& grid,
                         const BlockDecomposition& decomposition, std::vector<FieldRegion> regions, double time)
    : folder_(results_folder), grid_(grid), decomposition_(decomposition), regions_(std::move(regions)) {
  int is_there = std::filesystem::exists(folder_ / file_name) ? 1 : 0;
  MPI_Bcast(&is_there, 1, MPI_INT, 0, decomposition_.communicator());
  if (time > 0 && is_there == 1) {
    file_ = std::make_unique<ParallelFile>(
        ParallelFile::open_for_appending(folder_ / file_name, decomposition_.communicator()));
    keep_states_up_to(time);
  } else {
    file_ = std::make_unique<ParallelFile>(ParallelFile::create(folder_ / file_name, decomposition_.communicator()));
    write_grid();
  }
  file_->flush();
  write_listing();
}

void FieldWriter::write_grid() {
  for (const FieldRegion& region : regions_)
    for (int d = 0; d < 3; ++d)
      file_->write_list("grid/" + region.name + "/" + std::string(1, "xyz"[d]),
                        picture_faces(region, grid_.axis[d], d));
}

void FieldWriter::keep_states_up_to(double time) {
  for (const FieldRegion& region : regions_) {
    for (int d = 0; d < 3; ++d) {
      const std::string name = "grid/" + region.name + "/" + std::string(1, "xyz"[d]);
      if (!file_->contains(name) || file_->read_list(name) != picture_faces(region, grid_.axis[d], d)) {
        throw report::FileError(file_->path().string(), "holds other regions or another grid",
                                "resume into another run folder, or remove these results");
      }
    }
  }
  for (const std::string& name : file_->names_in("state")) {
    const std::string group = "state/" + name;
    const bool is_complete = file_->contains(group + "/time");
    const double state_time = is_complete ? file_->read_list(group + "/time").front() : 0;
    if (is_complete && state_time <= time && group == state_group(times_.size())) {
      times_.push_back(state_time);
    } else {
      file_->remove(group);
    }
  }
}

void FieldWriter::append(const FlowPart& part) {
  const std::string group = state_group(times_.size());
  for (const FieldRegion& region : regions_) {
    const Box& mine = decomposition_.mine();
    const std::array<Interval, 3> own = own_picture(region, mine);
    for (const FieldQuantity quantity : region.quantities) {
      std::vector<double> values;
      for (int mk = own[2].begin; mk < own[2].end; ++mk) {
        for (int mj = own[1].begin; mj < own[1].end; ++mj) {
          for (int mi = own[0].begin; mi < own[0].end; ++mi) {
            append_values(part, quantity,
                          {shown_cell(region, 0, mi) - mine.begin[0], shown_cell(region, 1, mj) - mine.begin[1],
                           shown_cell(region, 2, mk) - mine.begin[2]},
                          values);
          }
        }
      }
      file_->write(group + "/" + region.name + "/" + name_of(quantity), block_of(region, own, is_vector(quantity)),
                   values.data(), region.precision);
    }
  }
  file_->write_list(group + "/time", {part.state.time});  // last: a state with a time is complete
  file_->flush();
  times_.push_back(part.state.time);
  write_listing();
}

void FieldWriter::write_listing() const {
  on_first_rank(decomposition_, folder_, [&] {
    for (const FieldRegion& region : regions_)
      store::write_file(folder_ / (region.name + ".xmf"), listing_text(region, times_));
  });
}

}  // namespace couplet::flow
