#include "flow-server/output/field_writer.hpp"

#include <array>
#include <optional>

#include "proto/report/failure.hpp"
#include "proto/store/run_folder.hpp"

namespace couplet::flow {

namespace {

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
    case FieldQuantity::fluid_share:
      return values.push_back(fluid_share(part, cell));
  }
}

/// Rank 0 alone looks at the folder and names what is in it; the others learn whether it went well.
template <class Action>
void on_first_rank(const BlockDecomposition& decomposition, const std::filesystem::path& folder, Action action) {
  int is_well = 1;
  std::optional<report::FileError> failure;
  if (decomposition.rank() == 0) {
    try {
      action();
    } catch (const report::FileError& met) {
      failure = met;
      is_well = 0;
    }
  }
  MPI_Bcast(&is_well, 1, MPI_INT, 0, decomposition.communicator());
  if (failure) throw *failure;
  if (is_well == 0) throw report::FileError(folder.string(), "cannot be read or written; the first rank says why");
}

}  // namespace

FieldWriter::FieldWriter(const std::filesystem::path& results_folder, const StretchedGrid& grid,
                         const BlockDecomposition& decomposition, std::vector<FieldRegion> regions, double time,
                         std::vector<StoredSurface> surfaces)
    : folder_(results_folder),
      decomposition_(decomposition),
      regions_(std::move(regions)),
      surfaces_(std::move(surfaces)) {
  on_first_rank(decomposition_, folder_, [&] {
    catalogue_ = std::make_unique<StateCatalogue>(folder_, grid, regions_, surfaces_, time);
    next_number_ = catalogue_->next_number();
  });
  MPI_Bcast(&next_number_, 1, MPI_INT64_T, 0, decomposition_.communicator());
}

void FieldWriter::append(const FlowPart& part, std::span<const SurfaceValues> surfaces) {
  const std::filesystem::path path = folder_ / state_file_name(next_number_);
  ParallelFile file = ParallelFile::create(store::unfinished(path), decomposition_.communicator());
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
      file.write(region.name + "/" + name_of(quantity), block_of(region, own, is_vector(quantity)), values.data(),
                 region.precision);
    }
  }
  for (std::size_t s = 0; s < surfaces_.size(); ++s)
    write_surface(file, surfaces_[s], surfaces[s], decomposition_.rank());
  file.write_list("time", {part.state.time});
  file.close();
  on_first_rank(decomposition_, folder_, [&] {
    store::put_in_place(path);
    catalogue_->add(part.state.time);
  });
  ++next_number_;
}

}  // namespace couplet::flow
