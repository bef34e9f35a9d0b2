#include "solid-server/assembly/elimination_order.hpp"

#include <cholmod.h>

#include <algorithm>
#include <memory>

#include "proto/report/failure.hpp"

namespace couplet::solid {

namespace {

std::size_t at(Index n) {
  return static_cast<std::size_t>(n);
}

/// CHOLMOD's workspace.
class Cholmod {
 public:
  Cholmod() {
    cholmod_start(&common_);
    common_.print = 0;
  }
  ~Cholmod() { cholmod_finish(&common_); }
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;

  cholmod_common* get() { return &common_; }

 private:
  cholmod_common common_{};
};

}  // namespace

Elimination eliminate(const NodePairs& pairs, const std::vector<int>& weight, const std::vector<Index>& order) {
  const auto n = static_cast<Index>(order.size());
  std::vector<Index> place(at(pairs.n_nodes()), -1), first(order.size() + 1, 0);
  for (Index j = 0; j < n; ++j) place[at(order[at(j)])] = j;
  const auto for_each_pair = [&](const auto& visit) {
    for (Index column = 0; column < pairs.n_nodes(); ++column)
      for (Index p = pairs.start[at(column)]; p < pairs.start[at(column) + 1]; ++p) {
        const auto [low, high] = std::minmax(place[at(column)], place[at(pairs.row[at(p)])]);
        if (low >= 0 && low < high) visit(low, high);
      }
  };
  for_each_pair([&](Index, Index high) { ++first[at(high) + 1]; });
  for (Index j = 0; j < n; ++j) first[at(j) + 1] += first[at(j)];
  std::vector<Index> earlier(at(first.back())), next = first;
  for_each_pair([&](Index low, Index high) { earlier[at(next[at(high)]++)] = low; });

  Elimination out;
  out.parent.assign(order.size(), -1);
  std::vector<Index> ancestor(order.size(), -1);
  for (Index j = 0; j < n; ++j)
    for (Index e = first[at(j)]; e < first[at(j) + 1]; ++e)
      for (Index r = earlier[at(e)]; r >= 0 && r < j;) {  // up to the root known so far, which j becomes the parent of
        const Index up = ancestor[at(r)];
        ancestor[at(r)] = j;
        if (up < 0) out.parent[at(r)] = j;
        r = up;
      }

  // Row j of the factor holds the nodes on the paths from its entries up to j.
  out.n_rows.assign(order.size(), 1);
  std::vector<double> size(order.size());  // of the columns, in unknowns
  std::vector<Index> seen(order.size(), -1);
  for (Index j = 0; j < n; ++j) {
    const int here = weight[at(order[at(j)])];
    size[at(j)] += here;
    seen[at(j)] = j;
    for (Index e = first[at(j)]; e < first[at(j) + 1]; ++e)
      for (Index r = earlier[at(e)]; seen[at(r)] != j; r = out.parent[at(r)]) {
        seen[at(r)] = j;
        ++out.n_rows[at(r)];
        size[at(r)] += here;
      }
  }
  for (Index j = 0; j < n; ++j) out.n_operations += weight[at(order[at(j)])] * size[at(j)] * size[at(j)];
  return out;
}

std::vector<Index> elimination_order(const NodePairs& pairs, const std::vector<int>& weight) {
  std::vector<Index> node, place(at(pairs.n_nodes()), -1);  // those that take part, and their places among them
  for (Index n = 0; n < pairs.n_nodes(); ++n)
    if (weight[at(n)] > 0) {
      place[at(n)] = static_cast<Index>(node.size());
      node.push_back(n);
    }
  if (node.empty()) return {};

  Cholmod cholmod;
  const auto release = [&](cholmod_sparse* matrix) { cholmod_free_sparse(&matrix, cholmod.get()); };
  const auto not_enough_memory = [&] {
    return report::NumericsError(
        "solver", "there is not enough memory to order a matrix of " + std::to_string(node.size()) + " nodes",
        "coarsen the mesh or use a machine with more memory");
  };
  const std::unique_ptr<cholmod_sparse, decltype(release)> graph(
      cholmod_allocate_sparse(node.size(), node.size(), at(pairs.n_pairs()), 1, 1, -1, CHOLMOD_PATTERN, cholmod.get()),
      release);
  if (!graph) throw not_enough_memory();
  auto* const start = static_cast<int*>(graph->p);
  auto* const row = static_cast<int*>(graph->i);
  int n_entries = 0;
  for (std::size_t j = 0; j < node.size(); ++j) {
    start[j] = n_entries;
    for (Index p = pairs.start[at(node[j])]; p < pairs.start[at(node[j]) + 1]; ++p)
      if (const Index r = place[at(pairs.row[at(p)])]; r >= 0) row[n_entries++] = r;
  }
  start[node.size()] = n_entries;

  std::vector<Index> best;
  double fewest_operations = 0;
  const auto consider = [&](const std::vector<int>& permutation) {
    std::vector<Index> order;
    for (const int j : permutation) order.push_back(node[static_cast<std::size_t>(j)]);
    const double n_operations = eliminate(pairs, weight, order).n_operations;
    if (!best.empty() && !(n_operations < fewest_operations)) return;
    best = std::move(order);
    fewest_operations = n_operations;
  };
  std::vector<int> permutation(node.size()), component(node.size()), separator(node.size());
  if (!cholmod_amd(graph.get(), nullptr, 0, permutation.data(), cholmod.get())) throw not_enough_memory();
  consider(permutation);
  // A CHOLMOD without METIS says so here; then minimum degree is what there is.
  if (cholmod_nested_dissection(graph.get(), nullptr, 0, permutation.data(), component.data(), separator.data(),
                                cholmod.get()) > 0)
    consider(permutation);
  return best;
}

}  // namespace couplet::solid
