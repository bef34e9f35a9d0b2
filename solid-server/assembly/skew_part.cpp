#include "solid-server/assembly/skew_part.hpp"

#include <algorithm>

namespace couplet::solid {

void SkewPart::add(Index node_a, Index node_b, const Eigen::Matrix3d& block) {
  entries_.push_back({node_a, node_b, block / 2});
  entries_.push_back({node_b, node_a, -block.transpose() / 2});
}

void SkewPart::complete(const FreeComponents& free) {
  // Stable, so that the order of the sums is that of the calls.
  std::stable_sort(entries_.begin(), entries_.end(),
                   [](const Entry& x, const Entry& y) { return std::pair(x.a, x.b) < std::pair(y.a, y.b); });
  std::vector<Entry> sums;
  double largest = 0;  // of what is added
  for (const Entry& entry : entries_) {
    largest = std::max(largest, entry.block.cwiseAbs().maxCoeff());
    if (sums.empty() || sums.back().a != entry.a || sums.back().b != entry.b)
      sums.push_back(entry);
    else
      sums.back().block += entry.block;
  }
  for (Entry& sum : sums)
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) sum.block(i, k) *= free(sum.a, i) && free(sum.b, k);
  constexpr double round_off = 1e-12;  // of sums of some faces
  std::erase_if(sums, [&](const Entry& sum) { return sum.block.cwiseAbs().maxCoeff() <= round_off * largest; });
  entries_ = std::move(sums);
}

void SkewPart::add_product(const NodeVectors& vector, NodeVectors& sum) const {
  for (const auto& [a, b, block] : entries_) sum.row(a).head<3>() += vector.row(b).head<3>() * block.transpose();
}

}  // namespace couplet::solid
