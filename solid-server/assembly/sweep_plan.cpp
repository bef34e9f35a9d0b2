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
  std::vector<Index> member;  // of each chunk
  std::vector<Span> span;     // of each node

  Index n_chunks() const { return static_cast<Index>(member.size()); }
  bool is_shared(Index node) const { return member[at(span[at(node)].first)] != member[at(span[at(node)].last)]; }
};

/// Calls visit(chunk number, pack, lane, local node, node) for every node of every element, rising.
template <class Visit>
void for_each_part(const std::vector<const ElementPacks*>& blocks, const SweepPlan& plan, const Visit& visit) {
  for (std::size_t c = 0; c < plan.chunks.size(); ++c) {
    const SweepPlan::Chunk& chunk = plan.chunks[c];
    const ElementPacks& packs = *blocks[at(chunk.block)];
    for (Index pack = chunk.first_pack; pack < chunk.last_pack; ++pack)
      for (int lane = 0; lane < n_lanes; ++lane)
        if (packs.lane_element[at(pack * n_lanes + lane)] >= 0)
          for (int a = 0; a < packs.n_nodes; ++a)
            visit(static_cast<Index>(c), pack, lane, a,
                  packs.node_start[at((pack * packs.n_nodes + a) * n_lanes + lane)] / NodeVectors::ColsAtCompileTime);
  }
}

/// Cuts the blocks into chunks and deals them out to the members by the number of packs.
ChunkTable divide(const std::vector<const ElementPacks*>& blocks, Index n_nodes, int n_members, SweepPlan& plan) {
  Index n_packs = 0;
  for (const ElementPacks* packs : blocks) n_packs += packs->n_packs;
  // A small body is cut finer, so that every member has something to do.
  const Index chunk_size = std::clamp(n_packs / (2 * n_members), Index{1}, packs_per_chunk);
  for (std::size_t b = 0; b < blocks.size(); ++b)
    for (Index first = 0; first < blocks[b]->n_packs; first += chunk_size) {
      SweepPlan::Chunk& chunk = plan.chunks.emplace_back();
      chunk.block = static_cast<Index>(b);
      chunk.first_pack = first;
      chunk.last_pack = std::min(blocks[b]->n_packs, first + chunk_size);
    }
  ChunkTable table;
  const auto n_chunks = static_cast<Index>(plan.chunks.size());
  for (Index member = 0; member <= n_members; ++member)
    plan.first_chunk.push_back(static_cast<Index>(static_cast<long>(n_chunks) * member / n_members));
  for (Index member = 0; member < n_members; ++member)
    table.member.resize(at(plan.first_chunk[at(member) + 1]), member);
  table.span.resize(at(n_nodes));
  for_each_part(blocks, plan, [&](Index chunk, Index, int, int, Index node) {
    Span& span = table.span[at(node)];
    if (span.first < 0) span.first = chunk;
    span.last = chunk;
  });
  for (Span& span : table.span)
    if (span.first < 0) span = {0, 0};  // a node without elements
  return table;
}

/// Chunks with a node that waits for other members keep their place; the others of a member take turns.
void give_places(const std::vector<const ElementPacks*>& blocks, const ChunkTable& table, int n_members,
                 SweepPlan& plan) {
  std::vector<char> keeps_place(at(table.n_chunks()), 0);
  Index n_turns = 1, size = 0;  // chunks after which the nodes of a chunk have all been visited; of the largest chunk
  for_each_part(blocks, plan, [&](Index chunk, Index, int, int, Index node) {
    const Span& span = table.span[at(node)];
    if (table.is_shared(node))
      keeps_place[at(chunk)] = 1;
    else
      n_turns = std::max(n_turns, span.last - span.first + 1);
  });
  for (const SweepPlan::Chunk& chunk : plan.chunks)
    size = std::max(size, (chunk.last_pack - chunk.first_pack) * blocks[at(chunk.block)]->packs_of_force());
  Index next_place = n_members * n_turns * size;
  for (Index c = 0; c < table.n_chunks(); ++c) {
    SweepPlan::Chunk& chunk = plan.chunks[at(c)];
    chunk.place = (table.member[at(c)] * n_turns + c % n_turns) * size;
    if (keeps_place[at(c)]) {
      chunk.place = next_place;
      next_place += size;
    }
  }
  plan.n_element_packs = at(next_place);
}

/// Nodes in the order of their last chunk; those between members at the end.
void order_visits(const ChunkTable& table, int n_members, SweepPlan& plan) {
  plan.visit_node.resize(table.span.size());
  std::iota(plan.visit_node.begin(), plan.visit_node.end(), 0);
  const auto turn = [&](Index node) { return table.is_shared(node) ? table.n_chunks() : table.span[at(node)].last; };
  std::stable_sort(plan.visit_node.begin(), plan.visit_node.end(), [&](Index a, Index b) { return turn(a) < turn(b); });
  Index visit = 0;
  const auto n_visits = static_cast<Index>(plan.visit_node.size());
  for (Index c = 0; c < table.n_chunks(); ++c) {
    plan.chunks[at(c)].first_visit = visit;
    while (visit < n_visits && turn(plan.visit_node[at(visit)]) == c) ++visit;
    plan.chunks[at(c)].last_visit = visit;
  }
  for (Index member = 0; member <= n_members; ++member)
    plan.first_shared_visit.push_back(visit +
                                      static_cast<Index>(static_cast<long>(n_visits - visit) * member / n_members));
}

}  // namespace

SweepPlan make_sweep_plan(const std::vector<const ElementPacks*>& blocks, Index n_nodes,
                          const std::vector<ForcePart>& external_parts, int n_members) {
  SweepPlan plan;
  const ChunkTable table = divide(blocks, n_nodes, n_members, plan);
  give_places(blocks, table, n_members, plan);
  order_visits(table, n_members, plan);

  std::vector<std::vector<Index>> parts(at(n_nodes));  // starts, of each node
  for_each_part(blocks, plan, [&](Index c, Index pack, int lane, int a, Index node) {
    const SweepPlan::Chunk& chunk = plan.chunks[at(c)];
    const Index place = chunk.place + (pack - chunk.first_pack) * blocks[at(chunk.block)]->packs_of_force();
    parts[at(node)].push_back(place * n_lanes + force_start(a, lane));
  });
  for (const ForcePart& part : external_parts)
    parts[at(part.node)].push_back(static_cast<Index>(plan.n_element_packs) * n_lanes + part.start);
  plan.first_part.push_back(0);
  for (const Index node : plan.visit_node) {
    plan.part_start.insert(plan.part_start.end(), parts[at(node)].begin(), parts[at(node)].end());
    plan.first_part.push_back(static_cast<Index>(plan.part_start.size()));
  }
  return plan;
}

}  // namespace couplet::solid
