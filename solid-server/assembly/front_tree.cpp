#include "solid-server/assembly/front_tree.hpp"

#include <algorithm>
#include <numeric>

#include "solid-server/assembly/elimination_order.hpp"

namespace couplet::solid {

namespace {

std::size_t at(Index n) {
  return static_cast<std::size_t>(n);
}

/// Lists of numbers, one after the other.
struct Lists {
  std::vector<Index> start, item;  // (n + 1), (all items)
};

/// The children of each node of a forest, rising.
Lists children_of(const std::vector<Index>& parent) {
  Lists lists;
  lists.start.assign(parent.size() + 1, 0);
  for (const Index p : parent)
    if (p >= 0) ++lists.start[at(p) + 1];
  for (std::size_t n = 0; n < parent.size(); ++n) lists.start[n + 1] += lists.start[n];
  lists.item.resize(at(lists.start.back()));
  std::vector<Index> next(lists.start.begin(), lists.start.end() - 1);
  for (std::size_t n = 0; n < parent.size(); ++n)
    if (parent[n] >= 0) lists.item[at(next[at(parent[n])]++)] = static_cast<Index>(n);
  return lists;
}

/// The nodes of a forest, each after its children and all of a branch together.
std::vector<Index> postorder(const std::vector<Index>& parent) {
  const Lists children = children_of(parent);
  std::vector<Index> next(children.start.begin(), children.start.end() - 1), order, path;
  for (std::size_t root = 0; root < parent.size(); ++root) {
    if (parent[root] >= 0) continue;
    path.push_back(static_cast<Index>(root));
    while (!path.empty()) {
      const Index n = path.back();
      if (next[at(n)] < children.start[at(n) + 1]) {
        path.push_back(children.item[at(next[at(n)]++)]);
      } else {
        order.push_back(n);
        path.pop_back();
      }
    }
  }
  return order;
}

/// Nodes that are eliminated together.
struct Groups {
  std::vector<std::vector<Index>> node;  // of each group, in the order of elimination; a parent's group comes later
  std::vector<Index> parent;
};

/// A group while groups are merged.
struct Merging {
  double n_columns = 0, n_rows = 0;  // unknowns: its own and those below
  double n_zeros = 0;                // entries of the factor that are kept though they are 0
  Index merged_into = -1;
};

/// How much of a front may be zeros: small fronts cost more by their number than by their size.
double allowed_share_of_zeros(double n_columns) {
  return n_columns <= 24 ? 0.6 : n_columns <= 64 ? 0.2 : n_columns <= 160 ? 0.08 : 0.03;
}

/// Neighbouring columns whose rows are the same up to the diagonal, then groups of nearly the same rows.
Groups make_groups(const Elimination& elimination, const std::vector<Index>& order, const std::vector<int>& weight) {
  const auto n = static_cast<Index>(order.size());
  std::vector<Index> group_of(at(n));
  std::vector<std::vector<Index>> member;
  for (Index j = 0; j < n; ++j) {
    const bool continues =
        j > 0 && elimination.parent[at(j - 1)] == j && elimination.n_rows[at(j - 1)] == elimination.n_rows[at(j)] + 1;
    if (!continues) member.emplace_back();
    member.back().push_back(j);
    group_of[at(j)] = static_cast<Index>(member.size()) - 1;
  }
  std::vector<Index> parent(member.size());
  std::vector<Merging> merging(member.size());
  for (std::size_t g = 0; g < member.size(); ++g) {
    const Index last = member[g].back(), up = elimination.parent[at(last)];
    parent[g] = up < 0 ? -1 : group_of[at(up)];
    for (const Index j : member[g]) merging[g].n_columns += weight[at(order[at(j)])];
    merging[g].n_rows = 3.0 * (elimination.n_rows[at(last)] - 1);  // nearly: held components are rare
  }

  const Lists children = children_of(parent);
  for (std::size_t g = 0; g < member.size(); ++g)
    for (Index c = children.start[g]; c < children.start[g + 1]; ++c) {
      Merging &child = merging[at(children.item[at(c)])], &here = merging[g];
      const double n_columns = child.n_columns + here.n_columns;
      const double n_zeros =
          child.n_zeros + here.n_zeros + child.n_columns * std::max(0.0, here.n_columns + here.n_rows - child.n_rows);
      const double n_all = n_columns * (n_columns + 1) / 2 + n_columns * here.n_rows;
      if (n_zeros > allowed_share_of_zeros(n_columns) * n_all) continue;
      here.n_columns = n_columns;
      here.n_zeros = n_zeros;
      child.merged_into = static_cast<Index>(g);
    }

  // From the roots down: the group that each one has become part of.
  std::vector<Index> target(member.size()), kept(member.size(), -1);
  for (std::size_t g = member.size(); g-- > 0;)
    target[g] = merging[g].merged_into < 0 ? static_cast<Index>(g) : target[at(merging[g].merged_into)];
  Groups groups;
  for (std::size_t g = 0; g < member.size(); ++g)
    if (target[g] == static_cast<Index>(g)) {
      kept[g] = static_cast<Index>(groups.node.size());
      groups.node.emplace_back();
      groups.parent.push_back(-1);
    }
  for (std::size_t g = 0; g < member.size(); ++g) {
    auto& nodes = groups.node[at(kept[at(target[g])])];
    for (const Index j : member[g]) nodes.push_back(order[at(j)]);
    if (target[g] == static_cast<Index>(g) && parent[g] >= 0)
      groups.parent[at(kept[g])] = kept[at(target[at(parent[g])])];
  }
  return groups;
}

/// Puts groups into postorder.
Groups in_postorder(const Groups& groups) {
  const std::vector<Index> order = postorder(groups.parent);
  std::vector<Index> place(order.size());
  for (std::size_t n = 0; n < order.size(); ++n) place[at(order[n])] = static_cast<Index>(n);
  Groups out;
  for (const Index g : order) {
    out.node.push_back(groups.node[at(g)]);
    out.parent.push_back(groups.parent[at(g)] < 0 ? -1 : place[at(groups.parent[at(g)])]);
  }
  return out;
}

std::uint8_t mask_of(const FreeComponents& free, Index node) {
  return static_cast<std::uint8_t>((free(node, 0) ? 1 : 0) | (free(node, 1) ? 2 : 0) | (free(node, 2) ? 4 : 0));
}

/// Builds the fronts from the groups, children before parents.
class TreeMaker {
 public:
  TreeMaker(const NodePairs& pairs, const FreeComponents& free, Groups groups)
      : pairs_(pairs), free_(free), groups_(std::move(groups)), weight_(n_free_of_nodes(free)) {
    tree_.unknown.assign(at(3 * pairs.n_nodes()), -1);
    place_.assign(at(pairs.n_nodes()), -1);
    Index n_placed = 0;
    for (const auto& nodes : groups_.node)
      for (const Index node : nodes) {
        place_[at(node)] = n_placed++;
        for (int i = 0; i < 3; ++i)
          if (free(node, i)) tree_.unknown[at(3 * node + i)] = tree_.n_unknowns++;
      }
    collect_pairs();
    local_.assign(at(pairs.n_nodes()), -1);
  }

  FrontTree make() {
    const Lists children = children_of(groups_.parent);
    tree_.child = children.item;
    rows_of_.resize(groups_.node.size());
    Index first_column = 0;
    for (std::size_t g = 0; g < groups_.node.size(); ++g) {
      FrontTree::Front front;
      front.parent = groups_.parent[g];
      front.first_child = children.start[g];
      front.last_child = children.start[g + 1];
      front.first_column = first_column;
      for (const Index node : groups_.node[g]) front.n_columns += weight_[at(node)];
      first_column += front.n_columns;
      find_rows(g, front);
      add_entries(g, front);
      front.place = tree_.factor_size;
      tree_.factor_size += at(front.leading()) * at(front.n_columns);
      tree_.update_size += at(FrontTree::padded(front.n_rows));
      for (double m = front.size(), k = 0; k < front.n_columns; ++k) front.n_operations += (m - k) * (m - k);
      tree_.front.push_back(front);
    }
    for (FrontTree::Front& front : tree_.front) add_runs(front);
    find_branches();
    return std::move(tree_);
  }

 private:
  /// For each node, the pairs with nodes that are eliminated later.
  void collect_pairs() {
    later_.start.assign(at(pairs_.n_nodes()) + 1, 0);
    const auto for_each_pair = [&](const auto& visit) {
      for (Index column = 0; column < pairs_.n_nodes(); ++column)
        for (Index p = pairs_.start[at(column)]; p < pairs_.start[at(column) + 1]; ++p) {
          const Index row = pairs_.row[at(p)];
          if (place_[at(row)] < 0 || place_[at(column)] < 0) continue;
          const bool is_transposed = place_[at(row)] < place_[at(column)];
          visit(p, is_transposed ? row : column, is_transposed ? column : row, is_transposed);
        }
    };
    for_each_pair([&](Index, Index first, Index, bool) { ++later_.start[at(first) + 1]; });
    for (Index n = 0; n < pairs_.n_nodes(); ++n) later_.start[at(n) + 1] += later_.start[at(n)];
    later_.item.resize(at(later_.start.back()));
    other_.resize(later_.item.size());
    is_transposed_.resize(later_.item.size());
    std::vector<Index> next = later_.start;
    for_each_pair([&](Index p, Index first, Index second, bool is_transposed) {
      const auto e = at(next[at(first)]++);
      later_.item[e] = p;
      other_[e] = second;
      is_transposed_[e] = is_transposed;
    });
  }

  /// The nodes below the columns: those of later pairs and of children, in the order of elimination.
  void find_rows(std::size_t g, FrontTree::Front& front) {
    std::vector<Index>& nodes = rows_of_[g];
    for (const Index node : groups_.node[g]) local_[at(node)] = 0;
    const auto take = [&](Index node) {
      if (local_[at(node)] >= 0) return;
      local_[at(node)] = 0;
      nodes.push_back(node);
    };
    for (const Index node : groups_.node[g])
      for (Index e = later_.start[at(node)]; e < later_.start[at(node) + 1]; ++e) take(other_[at(e)]);
    for (Index c = front.first_child; c < front.last_child; ++c)
      for (const Index node : rows_of_[at(tree_.child[at(c)])]) take(node);
    std::sort(nodes.begin(), nodes.end(), [&](Index a, Index b) { return place_[at(a)] < place_[at(b)]; });

    Index position = 0;
    for (const Index node : groups_.node[g]) {
      local_[at(node)] = position;
      position += weight_[at(node)];
    }
    front.first_row = tree_.row.size();
    for (const Index node : nodes) {
      local_[at(node)] = position;
      position += weight_[at(node)];
      for (int i = 0; i < 3; ++i)
        if (free_(node, i)) tree_.row.push_back(tree_.unknown[at(3 * node + i)]);
    }
    front.n_rows = position - front.n_columns;
  }

  /// Also forgets the local positions again.
  void add_entries(std::size_t g, FrontTree::Front& front) {
    front.first_entry = tree_.entry.size();
    for (const Index node : groups_.node[g])
      for (Index e = later_.start[at(node)]; e < later_.start[at(node) + 1]; ++e)
        tree_.entry.push_back({later_.item[at(e)], local_[at(other_[at(e)])], local_[at(node)],
                               mask_of(free_, other_[at(e)]), mask_of(free_, node), is_transposed_[at(e)] != 0});
    front.last_entry = tree_.entry.size();
    for (const Index node : groups_.node[g]) local_[at(node)] = -1;
    for (const Index node : rows_of_[g]) local_[at(node)] = -1;
  }

  void add_runs(FrontTree::Front& front) {
    front.first_run = front.last_run = tree_.run.size();
    if (front.parent < 0) return;
    const FrontTree::Front& parent = tree_.front[at(front.parent)];
    Index below = 0;  // place in the parent's rows
    for (Index r = 0; r < front.n_rows; ++r) {
      const Index unknown = tree_.row[front.first_row + at(r)];
      Index to = unknown - parent.first_column;
      if (to >= parent.n_columns) {
        while (tree_.row[parent.first_row + at(below)] != unknown) ++below;
        to = parent.n_columns + below;
      }
      if (tree_.run.size() > front.first_run && tree_.run.back().to + tree_.run.back().length == to)
        ++tree_.run.back().length;
      else
        tree_.run.push_back({r, to, 1});
    }
    front.last_run = tree_.run.size();
  }

  /// Branches of at most a part of all operations, as long as they can be parted.
  void find_branches() {
    constexpr double largest_share = 1.0 / 24;
    const auto n = tree_.front.size();
    std::vector<double> operations(n);
    std::vector<Index> first(n);
    double all = 0;
    for (std::size_t f = 0; f < n; ++f) {
      const FrontTree::Front& front = tree_.front[f];
      operations[f] += front.n_operations;
      all += front.n_operations;
      first[f] =
          front.first_child == front.last_child ? static_cast<Index>(f) : first[at(tree_.child[at(front.first_child)])];
      if (front.parent >= 0) operations[at(front.parent)] += operations[f];
    }
    std::vector<char> is_in_branch(n, 0);
    std::vector<Index> top;
    for (std::size_t f = n; f-- > 0;) {
      const Index parent = tree_.front[f].parent;
      if (parent >= 0 && is_in_branch[at(parent)]) {
        is_in_branch[f] = 1;
      } else if (operations[f] <= largest_share * all) {
        is_in_branch[f] = 1;
        top.push_back(static_cast<Index>(f));
      } else {
        tree_.trunk.push_back(static_cast<Index>(f));
      }
    }
    std::reverse(tree_.trunk.begin(), tree_.trunk.end());
    std::stable_sort(top.begin(), top.end(), [&](Index a, Index b) { return operations[at(a)] > operations[at(b)]; });
    for (const Index f : top) tree_.branch.push_back({first[at(f)], f + 1});
  }

  const NodePairs& pairs_;
  const FreeComponents& free_;
  Groups groups_;
  std::vector<int> weight_;
  std::vector<Index> place_;  // of each node in the order of elimination, -1: does not take part
  Lists later_;               // pairs of each node with later ones
  std::vector<Index> other_;  // the later one
  std::vector<char> is_transposed_;
  std::vector<std::vector<Index>> rows_of_;  // nodes below each group
  std::vector<Index> local_;                 // first position of each node in the front at hand, -1: not in it
  FrontTree tree_;
};

}  // namespace

std::vector<int> n_free_of_nodes(const FreeComponents& free) {
  std::vector<int> n_free(static_cast<std::size_t>(free.rows()));
  for (Eigen::Index n = 0; n < free.rows(); ++n)
    n_free[static_cast<std::size_t>(n)] = static_cast<int>(free.row(n).count());
  return n_free;
}

FrontTree make_front_tree(const NodePairs& pairs, const FreeComponents& free, const std::vector<Index>& order) {
  const std::vector<int> weight = n_free_of_nodes(free);
  // Again in postorder of the nodes, so that columns of the same rows stand together.
  std::vector<Index> ordered;
  for (const Index j : postorder(eliminate(pairs, weight, order).parent)) ordered.push_back(order[at(j)]);
  return TreeMaker(pairs, free, in_postorder(make_groups(eliminate(pairs, weight, ordered), ordered, weight))).make();
}

}  // namespace couplet::solid
