#include "flow-server/grid/active_cells.hpp"

namespace couplet::flow {

ActiveCells ActiveCells::all(const Box& range) {
  ActiveCells cells(range);
  for (int k = range.begin[2]; k < range.end[2]; ++k)
    for (int j = range.begin[1]; j < range.end[1]; ++j) {
      cells.intervals_.push_back({range.begin[0], range.end[0]});
      cells.first_.push_back(cells.intervals_.size());
    }
  cells.n_cells_ = range.n_cells();
  return cells;
}

ActiveCells ActiveCells::where(const Box& range, const std::function<bool(int i, int j, int k)>& is_active) {
  ActiveCells cells(range);
  for (int k = range.begin[2]; k < range.end[2]; ++k)
    for (int j = range.begin[1]; j < range.end[1]; ++j) {
      bool was_active = false;
      for (int i = range.begin[0]; i < range.end[0]; ++i) {
        const bool is = is_active(i, j, k);
        if (is && !was_active) cells.intervals_.push_back({i, i});
        if (is) cells.intervals_.back().end = i + 1, ++cells.n_cells_;
        was_active = is;
      }
      cells.first_.push_back(cells.intervals_.size());
    }
  return cells;
}

ActiveCells ActiveCells::of_rows(const Box& range,
                                 const std::function<void(int j, int k, std::vector<Interval>& intervals)>& append) {
  ActiveCells cells(range);
  for (int k = range.begin[2]; k < range.end[2]; ++k)
    for (int j = range.begin[1]; j < range.end[1]; ++j) {
      const std::size_t before = cells.intervals_.size();
      append(j, k, cells.intervals_);
      for (std::size_t i = before; i < cells.intervals_.size(); ++i)
        cells.n_cells_ += cells.intervals_[i].end - cells.intervals_[i].begin;
      cells.first_.push_back(cells.intervals_.size());
    }
  return cells;
}

bool ActiveCells::contains(int i, int j, int k) const {
  if (!range_.contains({i, j, k})) return false;
  for (const Interval& interval : row(j, k))
    if (i >= interval.begin && i < interval.end) return true;
  return false;
}

}  // namespace couplet::flow
