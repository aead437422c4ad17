// Where the entries of a sparse matrix are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace robotraj::native {

/// Entries (row, column).
struct Pattern {
  std::vector<std::int32_t> rows, columns;

  std::size_t size() const { return rows.size(); }
  void add(std::int64_t row, std::int64_t column) {
    rows.push_back(static_cast<std::int32_t>(row));
    columns.push_back(static_cast<std::int32_t>(column));
  }
};

}  // namespace robotraj::native
