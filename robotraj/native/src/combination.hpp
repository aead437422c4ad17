// A sparse matrix as it is multiplied by, over and over: what repeats from interval to interval is written once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sparse.hpp"
#include "stacked.hpp"
#include "thread_pool.hpp"

namespace robotraj::native {

/// y = base + A x for one sparse A.
///
/// Equal intervals make equal blocks of rows, each reading x a fixed distance further on. One of them stays in a cache
/// near the processor, where the whole matrix of a long mesh has to come from memory each time. In a block, rows of
/// equally many entries follow each other. Every row is summed as it stands, base first.
///
/// Results may have places of their own: row i goes to y[places[i]], to nowhere where that is negative.
class Combination {
 public:
  Combination() : Combination(Csr()) {}
  explicit Combination(const Csr& matrix, const std::int32_t* places = nullptr)
      : Combination(Stacked(matrix), places) {}
  explicit Combination(const Stacked& matrix, const std::int32_t* places = nullptr);

  /// y = base + A x, rows shared by the pool; base may be null for zeros, and y for what has its places.
  void apply(const double* x, const double* base, double* y, ThreadPool& pool) const;

  /// How many entries are kept.
  std::size_t entries() const { return values_.size(); }

 private:
  /// Rows of a block with `count` entries each.
  struct Group {
    std::size_t count, rows, first_row, first_entry;
  };
  /// `repeats` blocks, `period` rows apart, that read x `shift` numbers apart and write y `step` numbers apart.
  struct Run {
    std::size_t row, period, repeats;
    std::ptrdiff_t shift, step;
    std::size_t groups_begin, groups_end;
  };
  /// Repeats [begin, end) of a run: a piece of work for a thread.
  struct Piece {
    std::size_t run, begin, end;
  };

  struct Rows;
  void divide(const Rows& matrix, std::size_t begin, std::size_t end);
  void take(const Stacked::Piece& piece, const std::int32_t* places, std::size_t first);
  void add(const Rows& matrix, const Run& run);
  void block(const Run& run, std::size_t repeat, const double* x, const double* base, double* y) const;

  // Of the first block of each run.
  std::vector<std::int32_t> rows_, places_, columns_;
  std::vector<double> values_;
  std::vector<Group> groups_;
  std::vector<Run> runs_;
  std::vector<Piece> pieces_;
  std::size_t work_ = 0;  // entries, and one for each row
};

}  // namespace robotraj::native
