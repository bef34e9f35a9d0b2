#include "solid-server/assembly/sweep_plan.hpp"

#include <gtest/gtest.h>

#include <set>

#include "solid-server/element/internal_force.hpp"
#include "solid-server/mesh/parametric/box_mesh.hpp"

namespace couplet::solid {
namespace {

class SweepOf : public testing::TestWithParam<int> {
 protected:
  const int n_members = GetParam();
  const SolidMesh mesh = make_box_mesh({{1, 1, 1}, {5, 3, 120}});  // 1800 elements: 240 packs
  const ElementPacks packs = make_element_packs(mesh, mesh.block[0], 8);
  // Two loads on every third node.
  const std::vector<ForcePart> loads = [this] {
    std::vector<ForcePart> parts;
    for (Index n = 0; n < mesh.n_nodes(); n += 3)
      for (int copy = 0; copy < 2; ++copy) parts.push_back({n, static_cast<Index>(4 * parts.size())});
    return parts;
  }();
  const SweepPlan plan = make_sweep_plan({&packs}, mesh.n_nodes(), loads, n_members);

  /// Goes through the sweep with one made-up number for each element and load, members one after the other or in turns
  /// of a chunk; gives what each node has added up.
  std::vector<double> go(bool in_turns) const {
    std::vector<double> buffer(plan.n_element_packs * n_lanes + 4 * loads.size(), 0);
    for (std::size_t l = 0; l < loads.size(); ++l)
      buffer[plan.n_element_packs * n_lanes + 4 * l] = 1e-3 * static_cast<double>(l + 1);
    std::vector<double> sums(static_cast<std::size_t>(mesh.n_nodes()), -1);
    const auto visit = [&](Index v) {
      double& sum = sums[static_cast<std::size_t>(plan.visit_node[static_cast<std::size_t>(v)])];
      EXPECT_EQ(sum, -1);  // exactly once
      sum = plan.sum(v, buffer.data())[0];
    };
    std::vector<Index> next(plan.first_chunk.begin(), plan.first_chunk.end() - 1);
    const auto do_chunk = [&](std::size_t member) {
      if (next[member] == plan.first_chunk[member + 1]) return false;
      const auto& chunk = plan.chunks[static_cast<std::size_t>(next[member]++)];
      for (Index pack = chunk.first_pack; pack < chunk.last_pack; ++pack)
        for (int lane = 0; lane < n_lanes; ++lane)
          for (int a = 0; a < packs.n_nodes; ++a)
            buffer[static_cast<std::size_t>(
                (chunk.place + (pack - chunk.first_pack) * packs.packs_of_force()) * n_lanes + force_start(a, lane))] =
                packs.lane_element[static_cast<std::size_t>(pack * n_lanes + lane)] + 1;
      for (Index v = chunk.first_visit; v < chunk.last_visit; ++v) visit(v);
      return true;
    };
    if (in_turns)
      for (bool any = true; any;) {
        any = false;
        for (std::size_t member = 0; member < next.size(); ++member) any |= do_chunk(member);
      }
    else
      for (std::size_t member = 0; member < next.size(); ++member)
        while (do_chunk(member)) continue;
    for (Index v = plan.first_shared_visit.front(); v < plan.first_shared_visit.back(); ++v) visit(v);
    return sums;
  }
};

TEST_P(SweepOf, GivesEachNodeTheForcesOfAllItsElementsAndLoads) {
  std::vector<double> expected(static_cast<std::size_t>(mesh.n_nodes()), 0);
  for (Index e = 0; e < mesh.n_elements(); ++e)
    for (const Index n : mesh.nodes_of(e)) expected[static_cast<std::size_t>(n)] += e + 1;
  for (std::size_t l = 0; l < loads.size(); ++l)
    expected[static_cast<std::size_t>(loads[l].node)] += 1e-3 * static_cast<double>(l + 1);
  EXPECT_EQ(go(false), expected);  // whole numbers first, then the loads in order: no other round-off
  EXPECT_EQ(go(true), expected);
}

TEST_P(SweepOf, VisitsANodeOnlyAfterTheLastElementAroundIt) {
  std::vector<Index> last_chunk(static_cast<std::size_t>(mesh.n_nodes()), -1);
  for (std::size_t c = 0; c < plan.chunks.size(); ++c)
    for (Index n = plan.chunks[c].first_pack * n_lanes * packs.n_nodes;
         n < plan.chunks[c].last_pack * n_lanes * packs.n_nodes; ++n)
      last_chunk[static_cast<std::size_t>(packs.node_start[static_cast<std::size_t>(n)] / 4)] = static_cast<Index>(c);
  for (std::size_t c = 0; c < plan.chunks.size(); ++c)
    for (Index v = plan.chunks[c].first_visit; v < plan.chunks[c].last_visit; ++v)
      EXPECT_LE(last_chunk[static_cast<std::size_t>(plan.visit_node[static_cast<std::size_t>(v)])],
                static_cast<Index>(c));
}

TEST_P(SweepOf, UsesPlacesAgain) {
  EXPECT_LT(plan.n_element_packs, static_cast<std::size_t>(packs.n_packs * packs.packs_of_force()));
}

INSTANTIATE_TEST_SUITE_P(Members, SweepOf, testing::Values(1, 2, 3));

TEST(ElementPacks, ShareOneGeometryAmongLayersOfTheSameShape) {
  const SolidMesh mesh = make_box_mesh({{1, 1, 1}, {5, 3, 40}});
  const ElementPacks packs = make_element_packs(mesh, mesh.block[0], 8);
  EXPECT_EQ(packs.n_packs, 80);
  EXPECT_EQ(packs.geometry.size(), 2u * 8 * 10);  // two packs of a layer, eight points, ten numbers
  SolidMesh bent = mesh;
  for (Index n = 0; n < bent.n_nodes(); ++n) bent.node_position(n, 0) *= 1 + bent.node_position(n, 2);
  EXPECT_EQ(make_element_packs(bent, bent.block[0], 8).geometry.size(), 80u * 8 * 10);
}

}  // namespace
}  // namespace couplet::solid
