#pragma once
// Tridiagonal systems along lines of cells that run through several blocks.

#include <mpi.h>

#include <vector>

#include "flow-server/grid/block_decomposition.hpp"
#include "flow-server/grid/field.hpp"
#include "flow-server/grid/traffic.hpp"

namespace couplet::flow {

/// Solves, on every line of cells along one direction,
///     lower(i) x(i - 1) + diagonal(i) x(i) + upper(i) x(i + 1) = right_side(i),
/// to round-off, whatever the number of blocks. Each block eliminates its own rows and is left with its first and last
/// unknown [H. H. Wang, A parallel method for tridiagonal equations, ACM Trans. Math. Softw. 7 (1981) 170-183]; the
/// blocks of a line share its remaining small systems among themselves. Without pivoting: rows must be diagonally
/// dominant.
class LineSolver {
 public:
  /// The decomposition must outlive this. Collective.
  LineSolver(const BlockDecomposition& decomposition, int direction);
  ~LineSolver();
  LineSolver(const LineSolver&) = delete;
  LineSolver& operator=(const LineSolver&) = delete;

  /// Collective over the blocks of a line. `solution` holds the right side on entry; lower and upper serve as memory
  /// and hold nothing of use afterwards. All fields have the shape and the ghosts of one another; ghosts are neither
  /// read nor written. In a direction that is not periodic the lower entry of the first row and the upper entry of the
  /// last one are not used. A row that is no unknown: diagonal 1, lower and upper 0.
  void solve(Field<double>& lower, const Field<double>& diagonal, Field<double>& upper, Field<double>& solution);

  const Traffic& traffic() const { return traffic_; }
  std::size_t n_bytes() const;

 private:
  /// Neighbouring lines that are worked on side by side.
  struct Panel {
    Triple cell;     // first cell of the first line
    int first_line;  // among the lines of the block
    int n_lines;
  };

  bool is_one_piece() const { return n_blocks_ == 1 && !is_periodic_; }
  void eliminate(const Panel& panel, Field<double>& lower, const Field<double>& diagonal, Field<double>& upper,
                 Field<double>& solution);
  void complete(const Panel& panel, const Field<double>& before, const Field<double>& after, Field<double>& solution);
  void join_blocks();
  void solve_joined();
  int n_joined() const { return first_line_[place_ + 1] - first_line_[place_]; }

  int direction_;
  bool is_periodic_;
  int n_rows_ = 0, n_lines_ = 0;
  std::vector<Panel> panels_;
  int n_blocks_ = 1, place_ = 0;   // of the line, and mine among them
  MPI_Comm line_ = MPI_COMM_NULL;  // the blocks of my lines, in order
  std::vector<int> first_line_;    // (n_blocks + 1): which block joins which lines
  std::vector<double> ends_;       // what the first and the last row of each of my lines say
  std::vector<double> gathered_;   // the same of all blocks, for the lines that I join
  std::vector<double> answers_;    // x_before and x_after of all blocks, for the lines that I join
  std::vector<double> beside_;     // the same for my lines
  std::vector<double> packed_;     // a panel of lines along x, side by side
  Traffic traffic_;
};

}  // namespace couplet::flow
