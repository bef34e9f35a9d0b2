#include "solid-server/assembly/sweep_plan.hpp"

#include <algorithm>
#include <numeric>

#include "solid-server/element/internal_force.hpp"

namespace couplet::solid {

namespace {

// Packs that are computed before nodes are visited: 64 elements, whose forces fill 40 kB.
constexpr Index packs_per_chunk = 8;

std::size_t at(Index n) {
  return static_cast<std::size_t>(n);
}

/// The first and last chunk that has an element of a node.
struct Span {
  Index first = -1, last = -1;
};

/// What is known of the chunks before nodes are put in order.
struct ChunkTable {
  Index chunk_size, n_chunks;
  std::vector<Index> member;  // of each chunk
  std::vector<Span> span;     // of each node

  bool is_shared(Index node) const { return member[at(span[at(node)].first)] != member[at(span[at(node)].last)]; }
};

Index node_of(const ElementPacks& packs, Index pack, int a, int lane) {
  return packs.node_start[at((pack * hex20::n_nodes + a) * n_lanes + lane)] / NodeVectors::ColsAtCompileTime;
}

/// Calls visit(pack, lane, local node, node) for every node of every element, rising.
template <class Visit>
void for_each_part(const ElementPacks& packs, const Visit& visit) {
  for (Index pack = 0; pack < packs.n_packs; ++pack)
    for (int lane = 0; lane < n_lanes; ++lane)
      if (packs.lane_element[at(pack * n_lanes + lane)] >= 0)
        for (int a = 0; a < hex20::n_nodes; ++a) visit(pack, lane, a, node_of(packs, pack, a, lane));
}

ChunkTable divide(const ElementPacks& packs, Index n_nodes, int n_members, SweepPlan& plan) {
  ChunkTable table;
  // A small body is cut finer, so that every member has something to do.
  table.chunk_size = std::clamp(packs.n_packs / (2 * n_members), Index{1}, packs_per_chunk);
  table.n_chunks = (packs.n_packs + table.chunk_size - 1) / table.chunk_size;
  for (Index member = 0; member <= n_members; ++member)
    plan.first_chunk.push_back(static_cast<Index>(static_cast<long>(table.n_chunks) * member / n_members));
  for (Index member = 0; member < n_members; ++member)
    table.member.resize(at(plan.first_chunk[at(member) + 1]), member);
  table.span.resize(at(n_nodes));
  for_each_part(packs, [&](Index pack, int, int, Index node) {
    Span& span = table.span[at(node)];
    if (span.first < 0) span.first = pack / table.chunk_size;
    span.last = pack / table.chunk_size;
  });
  return table;
}

/// Chunks with a node that waits for other members keep their place; the others of a member take turns.
void give_places(const ElementPacks& packs, const ChunkTable& table, int n_members, SweepPlan& plan) {
  std::vector<char> keeps_place(at(table.n_chunks), 0);
  Index n_turns = 1;  // chunks after which the nodes of a chunk have all been visited
  for_each_part(packs, [&](Index pack, int, int, Index node) {
    const Span& span = table.span[at(node)];
    if (table.is_shared(node))
      keeps_place[at(pack / table.chunk_size)] = 1;
    else
      n_turns = std::max(n_turns, span.last - span.first + 1);
  });
  const Index size = table.chunk_size * packs_per_element_pack;
  Index next_place = n_members * n_turns * size;
  for (Index c = 0; c < table.n_chunks; ++c) {
    SweepPlan::Chunk chunk{};
    chunk.first_pack = c * table.chunk_size;
    chunk.last_pack = std::min(packs.n_packs, chunk.first_pack + table.chunk_size);
    chunk.place = (table.member[at(c)] * n_turns + c % n_turns) * size;
    if (keeps_place[at(c)]) {
      chunk.place = next_place;
      next_place += size;
    }
    plan.chunks.push_back(chunk);
  }
  plan.n_element_packs = at(next_place);
}

/// Nodes in the order of their last chunk; those between members at the end.
void order_visits(const ChunkTable& table, int n_members, SweepPlan& plan) {
  plan.visit_node.resize(table.span.size());
  std::iota(plan.visit_node.begin(), plan.visit_node.end(), 0);
  const auto turn = [&](Index node) { return table.is_shared(node) ? table.n_chunks : table.span[at(node)].last; };
  std::stable_sort(plan.visit_node.begin(), plan.visit_node.end(), [&](Index a, Index b) { return turn(a) < turn(b); });
  Index visit = 0;
  const auto n_visits = static_cast<Index>(plan.visit_node.size());
  for (Index c = 0; c < table.n_chunks; ++c) {
    plan.chunks[at(c)].first_visit = visit;
    while (visit < n_visits && turn(plan.visit_node[at(visit)]) == c) ++visit;
    plan.chunks[at(c)].last_visit = visit;
  }
  for (Index member = 0; member <= n_members; ++member)
    plan.first_shared_visit.push_back(visit + (n_visits - visit) * member / n_members);
}

}  // namespace

SweepPlan make_sweep_plan(const ElementPacks& packs, Index n_nodes, const std::vector<ForcePart>& surface_parts,
                          int n_members) {
  SweepPlan plan;
  const ChunkTable table = divide(packs, n_nodes, n_members, plan);
  give_places(packs, table, n_members, plan);
  order_visits(table, n_members, plan);

  std::vector<std::vector<Index>> parts(at(n_nodes));  // starts, of each node
  for_each_part(packs, [&](Index pack, int lane, int a, Index node) {
    const SweepPlan::Chunk& chunk = plan.chunks[at(pack / table.chunk_size)];
    const Index place = chunk.place + (pack - chunk.first_pack) * packs_per_element_pack;
    parts[at(node)].push_back(place * n_lanes + force_start(a, lane));
  });
  for (const ForcePart& part : surface_parts)
    parts[at(part.node)].push_back(static_cast<Index>(plan.n_element_packs) * n_lanes + part.start);
  plan.first_part.push_back(0);
  for (const Index node : plan.visit_node) {
    plan.part_start.insert(plan.part_start.end(), parts[at(node)].begin(), parts[at(node)].end());
    plan.first_part.push_back(static_cast<Index>(plan.part_start.size()));
  }
  return plan;
}

}  // namespace couplet::solid
