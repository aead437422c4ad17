// The assembly tree of a sparse symmetric matrix: which rows are eliminated together, and which they update.
#pragma once

#include <cstdint>
#include <vector>

namespace robotraj::native::ldl {

/// The lower triangle of a symmetric matrix by columns, indices from 0.
struct Pattern {
  int n = 0;
  std::vector<int> starts, rows;  ///< n + 1, and the entries
};

/// A node of the tree: `columns` successive rows of the new order are eliminated, `below` updated.
struct Node {
  int first, columns;
  int parent;                 ///< -1 at a root
  std::vector<int> below;     ///< rows of the new order, ascending
  std::vector<int> places;    ///< where each of `below` is among the parent's columns and rows below
  std::vector<int> children;  ///< in the order in which they come
};

/// Where an entry of the matrix is in its node.
struct Place {
  std::uint16_t row, column;
};

struct Tree {
  std::vector<int> order;         ///< order[k] is the row of the matrix that is k-th
  std::vector<Node> nodes;        ///< children before their parents
  std::vector<int> place_starts;  ///< of each node's entries in `places`
  std::vector<Place> places;      ///< of all entries, node by node
  std::vector<int> place_of;      ///< number of each entry of the pattern in `places`
  long products = 0;              ///< expected, without delays
  int largest = 0;                ///< rows of the largest front, without delays
};

/// Of an order by approximate minimum degree (Amestoy, Davis and Duff, SIAM J. Matrix Analysis 17 (1996), Eigen's).
/// `groups` has none, one or several numbers for each row, the first of all rows before the second ones. Groups are
/// eliminated by ascending number, by those numbers for which the tree has fewest products.
Tree tree_of_fewest_products(const Pattern& pattern, const std::vector<int>& groups);

}  // namespace robotraj::native::ldl
