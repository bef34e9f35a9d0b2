#pragma once
// A flow that is given by formulas, on the blocks of the ranks that run the test.

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>

#include "flow-server/navier_stokes/navier_stokes_model.hpp"

namespace couplet::flow {

using Formula = std::function<double(const Point&)>;

inline StretchedGrid stretched_box(const Triple& n_cells, std::array<bool, 3> is_periodic = {}) {
  return {{StretchedAxis(symmetrically_stretched_faces(0, 2, n_cells[0], 3), is_periodic[0]),
           StretchedAxis(symmetrically_stretched_faces(-1, 1, n_cells[1], 2), is_periodic[1]),
           StretchedAxis(uniform_faces(0, 1, n_cells[2]), is_periodic[2])},
          3};
}

inline int ranks_of_test() {
  int n = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &n);
  return n;
}

inline int rank_of_test() {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}

/// Grid, blocks, cells and state, in the same arithmetic on any number of ranks; ghosts follow the formulas too.
struct FormulaFlow {
  FormulaFlow(StretchedGrid given, const std::array<Formula, 3>& velocity, const Formula& pressure,
              const std::function<bool(const Point&)>& is_fluid = {})
      : grid(std::move(given)), decomposition(decompose(grid, {}, MPI_COMM_WORLD)) {
    const bool is_flat = grid.n_dimensions == 2;
    const Triple sizes = decomposition.mine().sizes(), ghosts{2, 2, is_flat ? 0 : 2};
    const Box range = box_of(sizes).grown(ghosts);
    for (int d = 0; d < grid.n_dimensions; ++d) {
      state.velocity[d] = Field<double>(sizes, ghosts);
      fill(state.velocity[d], range, d, velocity[static_cast<std::size_t>(d)]);
    }
    state.pressure = Field<double>(sizes, ghosts);
    fill(state.pressure, range, -1, pressure);
    active = ActiveCells::where(range, [&](int i, int j, int k) { return !is_fluid || is_fluid(place(i, j, k, -1)); });
  }

  FlowPart part() const { return {grid, decomposition, active, state}; }

  Point place(int i, int j, int k, int face_direction) const {
    const Triple cell{i, j, k};
    Point at;
    for (int d = 0; d < 3; ++d) {
      const int global = decomposition.mine().begin[d] + cell[d];
      at[d] = d == face_direction ? grid.axis[d].face(global + 1) : grid.axis[d].centre(global);
    }
    return at;
  }

  void fill(Field<double>& field, const Box& range, int face_direction, const Formula& formula) const {
    for (int k = range.begin[2]; k < range.end[2]; ++k)
      for (int j = range.begin[1]; j < range.end[1]; ++j)
        for (int i = range.begin[0]; i < range.end[0]; ++i) field(i, j, k) = formula(place(i, j, k, face_direction));
  }

  StretchedGrid grid;
  BlockDecomposition decomposition;
  FlowState state;
  ActiveCells active = ActiveCells::all({});
};

inline double sum_of_ranks(double value) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  return value;
}

/// A folder that all ranks of the test share, and no other test that runs beside it; empty at first.
class SharedFolder {
 public:
  explicit SharedFolder(const std::string& name) {
    std::string path = std::filesystem::temp_directory_path() / ("couplet-" + name + "-XXXXXX");
    if (rank_of_test() == 0 && mkdtemp(path.data()) == nullptr) throw std::runtime_error("no temporary folder");
    MPI_Bcast(path.data(), static_cast<int>(path.size()), MPI_CHAR, 0, MPI_COMM_WORLD);
    path_ = path;
  }
  ~SharedFolder() {
    MPI_Barrier(MPI_COMM_WORLD);
    std::error_code ignored;
    if (rank_of_test() == 0) std::filesystem::remove_all(path_, ignored);
  }
  SharedFolder(const SharedFolder&) = delete;
  SharedFolder& operator=(const SharedFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace couplet::flow
