// Patterns of sparse matrices on their way to NumPy.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "rigid_body/rigid_tree.hpp"

namespace robotraj::native {

using IndexResult = Owned<std::int64_t>;

/// Rows and columns.
inline auto to_arrays(const Pattern& pattern) {
  std::vector<std::int64_t> rows, columns;
  for (const auto& [row, column] : pattern) {
    rows.push_back(row);
    columns.push_back(column);
  }
  return std::pair(to_numpy(std::move(rows)), to_numpy(std::move(columns)));
}

}  // namespace robotraj::native
