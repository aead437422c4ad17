// A sparse matrix of blocks of rows, in which repeated blocks are stored once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sparse.hpp"

namespace robotraj::native {

/// Rows from interval to interval: the same numbers, each time `shift` columns further on.
///
/// A mesh of equal intervals writes one block of rows as often as it has intervals. As compressed rows they would be a
/// good part of the memory of a plan.
class Stacked {
 public:
  /// `repeats` times the same rows; columns are those of the first.
  struct Piece {
    Csr rows;
    std::size_t repeats = 1;
    std::ptrdiff_t shift = 0;
  };

  Stacked() : Stacked(Csr()) {}
  explicit Stacked(const Csr& matrix);
  Stacked(std::size_t columns, std::vector<Piece> pieces);

  std::size_t rows() const { return rows_; }
  std::size_t columns() const { return columns_; }
  std::size_t entries() const { return entries_; }
  /// Entries without those of repeats.
  std::size_t kept() const;
  const std::vector<Piece>& pieces() const { return pieces_; }

  /// y = A x for a single product; see Combination for many.
  void times(const double* x, double* y) const;

 private:
  std::size_t columns_, rows_ = 0, entries_ = 0;
  std::vector<Piece> pieces_;
};

/// Stacks blocks one after the other.
class Stacking {
 public:
  explicit Stacking(std::size_t columns) : columns_(columns) {}

  void append(Csr block);
  /// Appends the last block once more, `shift` columns behind the last time; false where that is another shift.
  bool repeat(std::ptrdiff_t shift);
  Stacked stacked();

 private:
  /// Adds rows that repeat too seldom for a piece of their own to their neighbours.
  void settle();
  void close();

  std::size_t columns_;
  std::vector<Stacked::Piece> pieces_;
  std::optional<Stacked::Piece> last_;
  std::vector<std::int32_t> starts_{0}, indices_;
  std::vector<double> data_;
};

}  // namespace robotraj::native
