#include "solid-server/assembly/force_gather.hpp"

namespace couplet::solid {

ForceGather::ForceGather(Index n_nodes, const std::vector<ForcePart>& parts)
    : first_(static_cast<std::size_t>(n_nodes) + 1, 0), start_(parts.size()) {
  for (const ForcePart& part : parts) ++first_[static_cast<std::size_t>(part.node) + 1];
  for (std::size_t n = 1; n < first_.size(); ++n) first_[n] += first_[n - 1];
  std::vector<Index> next(first_.begin(), first_.end() - 1);
  for (const ForcePart& part : parts)
    start_[static_cast<std::size_t>(next[static_cast<std::size_t>(part.node)]++)] = part.start;
}

}  // namespace couplet::solid
