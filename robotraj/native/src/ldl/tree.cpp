#include "tree.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cstddef>

namespace robotraj::native::ldl {
namespace {

/// The cost of a front in products: those of its pivots, a cost for each entry and a cost of the front itself. An entry
/// is cleared, filled, handed on and added to the parent's.
constexpr double kEntryCost = 12.0, kFrontCost = 8000.0;

double cost(double columns, double rows) {
  const double last = rows - columns;
  return (rows * rows * rows - last * last * last) / 3.0 + kEntryCost * rows * rows + kFrontCost;
}

/// Lists of rows, one after the other.
struct Lists {
  std::vector<int> starts{0}, items;
  const int* begin(int k) const { return items.data() + starts[k]; }
  const int* end(int k) const { return items.data() + starts[k + 1]; }
};

/// Both triangles' entries of each row, the diagonal first whether it is there or not.
Lists neighbours_of(const Pattern& pattern) {
  const int n = pattern.n;
  Lists lists;
  lists.starts.assign(n + 1, 1);
  lists.starts[0] = 0;
  const auto each = [&](const auto& visit) {
    for (int column = 0; column < n; ++column)
      for (int e = pattern.starts[column]; e < pattern.starts[column + 1]; ++e)
        if (const int row = pattern.rows[e]; row != column) {
          visit(row, column);
          visit(column, row);
        }
  };
  each([&](int row, int) { ++lists.starts[row + 1]; });
  for (int row = 0; row < n; ++row) lists.starts[row + 1] += lists.starts[row];
  lists.items.resize(lists.starts[n]);
  std::vector<int> next(lists.starts.begin(), lists.starts.end() - 1);
  for (int row = 0; row < n; ++row) lists.items[next[row]++] = row;
  each([&](int row, int other) { lists.items[next[row]++] = other; });
  return lists;
}

/// Rows in an order of little fill.
std::vector<int> minimum_degree(const Lists& neighbours) {
  const int n = static_cast<int>(neighbours.starts.size()) - 1;
  Eigen::SparseMatrix<char> graph(n, n);
  graph.resizeNonZeros(static_cast<Eigen::Index>(neighbours.items.size()));
  std::copy(neighbours.starts.begin(), neighbours.starts.end(), graph.outerIndexPtr());
  std::copy(neighbours.items.begin(), neighbours.items.end(), graph.innerIndexPtr());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> found;
  Eigen::internal::minimum_degree_ordering(graph, found);
  return {found.indices().data(), found.indices().data() + n};
}

/// Columns of the factor in a given order: each one's parent in the elimination tree and rows below.
struct Columns {
  std::vector<int> parent;
  Lists below;
};

Columns columns_of(const Lists& neighbours, const std::vector<int>& order) {
  const int n = static_cast<int>(order.size());
  std::vector<int> at(n), mark(n, -1), youngest(n, -1), sibling(n, -1);
  for (int k = 0; k < n; ++k) at[order[k]] = k;
  Columns found{std::vector<int>(n, -1), {}};
  std::vector<int>& items = found.below.items;
  for (int k = 0; k < n; ++k) {
    const std::size_t begun = items.size();
    int parent = n;
    const auto add = [&](int row) {
      if (row <= k || mark[row] == k) return;
      mark[row] = k;
      items.push_back(row);
      parent = std::min(parent, row);
    };
    for (const int* other = neighbours.begin(order[k]); other < neighbours.end(order[k]); ++other) add(at[*other]);
    for (int child = youngest[k]; child >= 0; child = sibling[child])
      for (int i = found.below.starts[child]; i < found.below.starts[child + 1]; ++i) add(items[i]);
    found.below.starts.push_back(static_cast<int>(items.size()));
    if (items.size() == begun) continue;
    found.parent[k] = parent;
    sibling[k] = youngest[parent];
    youngest[parent] = k;
  }
  return found;
}

/// A node that may still be merged, named by its last column.
struct Group {
  int columns, below;
};

/// Whether it is cheaper to eliminate a child's columns with its parent's.
bool merges(const Group& child, const Group& parent) {
  const double ours = child.columns, theirs = parent.columns, together = ours + theirs;
  return cost(together, together + parent.below) < cost(ours, ours + child.below) + cost(theirs, theirs + parent.below);
}

/// The group that each column is in: children merge into their parents, from the leaves up.
std::vector<int> groups_of(const Columns& columns) {
  const int n = static_cast<int>(columns.parent.size());
  std::vector<Group> groups(n);
  std::vector<int> home(n), pending;
  Lists children;
  children.starts.assign(n + 1, 0);
  for (const int parent : columns.parent)
    if (parent >= 0) ++children.starts[parent + 1];
  for (int k = 0; k < n; ++k) children.starts[k + 1] += children.starts[k];
  children.items.resize(children.starts[n]);
  std::vector<int> next(children.starts.begin(), children.starts.end() - 1);
  for (int k = 0; k < n; ++k)
    if (const int parent = columns.parent[k]; parent >= 0) children.items[next[parent]++] = k;
  for (int k = 0; k < n; ++k) {
    home[k] = k;
    groups[k] = {1, columns.below.starts[k + 1] - columns.below.starts[k]};
    pending.assign(children.begin(k), children.end(k));
    // Those with the longest list of rows first: they fill least.
    std::stable_sort(pending.begin(), pending.end(), [&](int a, int b) { return groups[a].below > groups[b].below; });
    for (const int child : pending)
      if (merges(groups[child], groups[k])) {
        groups[k].columns += groups[child].columns;
        home[child] = k;
      }
  }
  for (int k = n - 1; k >= 0; --k) home[k] = home[home[k]];
  return home;
}

/// Merges nodes where a larger front costs less than two, and numbers them, children right before their parents. Rows
/// are eliminated in about the given order. Places are missing.
Tree tree_of(const Columns& columns, const std::vector<int>& chosen) {
  Tree tree;
  const int n = static_cast<int>(chosen.size());
  const std::vector<int> home = groups_of(columns);
  std::vector<int> eldest(n, -1), sibling(n, -1), last(n, -1), before(n, -1), stack, sequence;
  for (int k = 0; k < n; ++k) {
    before[k] = last[home[k]];
    last[home[k]] = k;
    if (home[k] != k) continue;
    if (columns.parent[k] < 0) {
      stack.push_back(k);
      continue;
    }
    const int parent = home[columns.parent[k]];
    sibling[k] = eldest[parent];
    eldest[parent] = k;
  }
  // Parents before children, reversed at the end.
  while (!stack.empty()) {
    const int k = stack.back();
    stack.pop_back();
    sequence.push_back(k);
    for (int child = eldest[k]; child >= 0; child = sibling[child]) stack.push_back(child);
  }
  std::reverse(sequence.begin(), sequence.end());
  std::vector<int> number(n, -1), place(n);
  for (const int k : sequence) {
    number[k] = static_cast<int>(tree.nodes.size());
    const auto first = static_cast<std::ptrdiff_t>(tree.order.size());
    for (int column = last[k]; column >= 0; column = before[column]) tree.order.push_back(column);
    std::reverse(tree.order.begin() + first, tree.order.end());
    tree.nodes.push_back({static_cast<int>(first), static_cast<int>(tree.order.size() - first), -1, {}, {}, {}});
  }
  for (int i = 0; i < n; ++i) place[tree.order[i]] = i;
  for (int& column : tree.order) column = chosen[column];
  for (const int k : sequence) {
    Node& node = tree.nodes[number[k]];
    // The last column of a group has the group's rows below.
    for (const int* row = columns.below.begin(k); row < columns.below.end(k); ++row) node.below.push_back(place[*row]);
    std::sort(node.below.begin(), node.below.end());
    if (columns.parent[k] >= 0) {
      node.parent = number[home[columns.parent[k]]];
      tree.nodes[node.parent].children.push_back(number[k]);
    }
    const long rows = node.columns + static_cast<long>(node.below.size());
    tree.largest = std::max(tree.largest, static_cast<int>(rows));
    for (long left = rows; left > rows - node.columns; --left) tree.products += left * left;
  }
  return tree;
}

/// Where the matrix's entries and the children's rows are in each node.
void add_places(const Pattern& pattern, Tree& tree) {
  const int n = pattern.n;
  std::vector<int> at(n), owner(n), where(n, -1);
  for (int k = 0; k < n; ++k) at[tree.order[k]] = k;
  const int nodes = static_cast<int>(tree.nodes.size());
  for (int i = 0; i < nodes; ++i)
    for (int c = 0; c < tree.nodes[i].columns; ++c) owner[tree.nodes[i].first + c] = i;
  tree.place_starts.assign(nodes + 1, 0);
  const auto each = [&](const auto& visit) {
    for (int column = 0; column < n; ++column)
      for (int e = pattern.starts[column]; e < pattern.starts[column + 1]; ++e) {
        const int a = at[column], b = at[pattern.rows[e]];
        visit(e, std::max(a, b), std::min(a, b));
      }
  };
  each([&](int, int, int column) { ++tree.place_starts[owner[column] + 1]; });
  for (int i = 0; i < nodes; ++i) tree.place_starts[i + 1] += tree.place_starts[i];
  tree.place_of.resize(tree.place_starts[nodes]);
  tree.places.resize(tree.place_starts[nodes]);
  std::vector<std::pair<int, int>> rows(tree.places.size());
  std::vector<int> next(tree.place_starts.begin(), tree.place_starts.end() - 1);
  each([&](int e, int row, int column) { rows[tree.place_of[e] = next[owner[column]]++] = {row, column}; });
  for (int i = 0; i < nodes; ++i) {
    const Node& node = tree.nodes[i];
    for (int c = 0; c < node.columns; ++c) where[node.first + c] = c;
    for (std::size_t r = 0; r < node.below.size(); ++r) where[node.below[r]] = node.columns + static_cast<int>(r);
    for (int e = tree.place_starts[i]; e < tree.place_starts[i + 1]; ++e)
      tree.places[e] = {static_cast<std::uint16_t>(where[rows[e].first]),
                        static_cast<std::uint16_t>(where[rows[e].second])};
    for (const int child : node.children)
      for (const int row : tree.nodes[child].below) tree.nodes[child].places.push_back(where[row]);
  }
}

}  // namespace

Tree tree_of_fewest_products(const Pattern& pattern, const std::vector<int>& groups) {
  const Lists neighbours = neighbours_of(pattern);
  const std::vector<int> order = minimum_degree(neighbours);
  Tree best;
  const auto take = [&](const std::vector<int>& rows) {
    Tree tree = tree_of(columns_of(neighbours, rows), rows);
    if (best.nodes.empty() || tree.products < best.products) best = std::move(tree);
  };
  if (groups.empty()) take(order);
  for (auto numbers = groups.begin(); numbers != groups.end(); numbers += pattern.n) {
    std::vector<int> grouped = order;
    std::stable_sort(grouped.begin(), grouped.end(), [&](int a, int b) { return numbers[a] < numbers[b]; });
    take(grouped);
  }
  add_places(pattern, best);
  return best;
}

}  // namespace robotraj::native::ldl
