// How fast points come deeper into contact on the way from one displacement to another.

#include <algorithm>
#include <cmath>

#include "solid-server/contact/surface_contact.hpp"

namespace couplet::solid {

namespace {

// Of the depth over which a pair pushes, what a point may gain in one step. By experiment with a valve that closes at 2
// m/s: with a half leaflets end inside each other and the iterations grow; from a quarter down they stay apart, and an
// eighth costs least, since its many short steps take few iterations each.
constexpr double largest_gain = 1.0 / 8;

constexpr double n_looks_most = 1000;  // a way that takes more is too long to be followed

std::size_t at(Index n) {
  return static_cast<std::size_t>(n);
}

}  // namespace

bool SurfaceContact::deepens_too_fast(const double* from, const double* to) {
  if (is_empty()) return false;
  const ContactPositions start = positions_at(from), end = positions_at(to);
  const auto allowed_gain = [](const Side& side) { return largest_gain * (side.distance + side.largest_depth); };
  double n_looks = 1;  // so many that between two of them no point comes nearer to a face by more than half of it
  for (const Side& side : sides_) {
    const double approach =
        largest_approach(region_[side.points], region_[side.faces], start, end, side.search.reach().reach);
    n_looks = std::max(n_looks, std::ceil(approach / (allowed_gain(side) / 2)));
  }
  if (!(n_looks <= n_looks_most)) return true;

  find_all(from);
  std::vector<std::vector<double>> gap_at_start;
  for (const Side& side : sides_) {
    gap_at_start.emplace_back(region_[side.points].point.size(), 0);
    for (std::size_t n = 0; n < side.touch.size(); ++n)
      gap_at_start.back()[at(side.search.active_point()[n])] = side.touch[n].gap;
  }
  for (double look = n_looks; look > 0; --look) {  // the end first: it is there most often
    for (std::size_t n = 0; n < x_.size(); ++n) x_[n] = start[n] + (look / n_looks) * (end[n] - start[n]);
    search_here();
    find_gaps(0, 1);
    for (std::size_t s = 0; s < sides_.size(); ++s) {
      const Side& side = sides_[s];
      std::vector<double> gap(gap_at_start[s].size(), 0);
      for (std::size_t n = 0; n < side.touch.size(); ++n) gap[at(side.search.active_point()[n])] = side.touch[n].gap;
      // A point that was nearly as deep as contact pushes and is out of it has left through the back.
      const double nearly_let_go = side.distance + side.largest_depth - 2 * allowed_gain(side);
      for (std::size_t p = 0; p < gap.size(); ++p)
        if (gap[p] - gap_at_start[s][p] > allowed_gain(side) || (gap[p] == 0 && gap_at_start[s][p] > nearly_let_go))
          return true;
    }
  }
  return false;
}

}  // namespace couplet::solid
