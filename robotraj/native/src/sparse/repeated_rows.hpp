// Rows of a sparse matrix that repeat from interval to interval, as the inner loops read them.
#pragma once

#include <cstddef>
#include <cstdint>

namespace robotraj::native {

/// Rows of a sparse matrix that follow each other and have equally many entries.
struct RowGroup {
  std::size_t count, rows;
};

/// Rows that repeat: columns of entries are numbers of `reads`, which are columns of x at the first repeat.
struct RepeatedRows {
  const std::int32_t* reads;
  std::size_t read_count;
  const RowGroup* groups;
  std::size_t group_count;
  const std::int32_t* columns;
  const double* values;
  const std::int32_t *order, *from, *places;  ///< rows as they are in y: their numbers, places of their base, in y
  const double* kept_base;                    ///< by number, of every repeat; may be null
  std::size_t row_count;
};

/// How far the next repeat is.
struct RepeatSteps {
  std::ptrdiff_t x, base, y;
};

}  // namespace robotraj::native
