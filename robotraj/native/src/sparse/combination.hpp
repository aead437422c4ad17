// A sparse matrix for many products: blocks that repeat from interval to interval are stored once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "parallel/thread_pool.hpp"
#include "repeated_rows.hpp"
#include "sparse.hpp"
#include "stacked.hpp"

namespace robotraj::native {

struct Kernels;

/// y = base + A x for one sparse A.
///
/// Equal intervals make equal blocks of rows, each reading x a fixed distance further on. One of them stays in a cache
/// near the processor; the whole matrix of a long mesh would come from memory each time. It is applied to as many
/// intervals at once as a vector register has lanes. In a block, rows of equally many entries follow each other. Every
/// row is summed as it stands, base first.
///
/// Results may have places of their own: row i goes to y[places[i]], to nowhere where that is negative. A base that
/// stays the same may be kept with the rows, once where they repeat. A combination that only adds leaves out the rows
/// without entries.
class Combination {
 public:
  Combination() : Combination(Csr()) {}
  explicit Combination(const Csr& matrix, const std::int32_t* places = nullptr, const double* kept_base = nullptr)
      : Combination(Stacked(matrix), places, kept_base) {}
  /// By the fastest kernels, unless others are given.
  explicit Combination(const Stacked& matrix, const std::int32_t* places = nullptr, const double* kept_base = nullptr,
                       const Kernels* kernels = nullptr, bool adds = false);
  /// For calls of `apply` whose base is y.
  static Combination adding(const Stacked& matrix, const std::int32_t* places = nullptr) {
    return Combination(matrix, places, nullptr, nullptr, true);
  }

  /// y = base + A x, rows shared by the pool. Base may be y; null stands for the kept one, or zeros where none is kept.
  void apply(const double* x, const double* base, double* y, ThreadPool& pool) const;

  /// How many entries are kept.
  std::size_t entries() const { return values_.size(); }

 private:
  /// Entries that are worth handing to another thread, some 20 us of work.
  static constexpr std::size_t kPiece = 1u << 15;

  /// `repeats` blocks, `period` rows apart, that read x `shift` numbers apart and write y `step` numbers apart.
  struct Run {
    std::size_t row = 0, period = 0, repeats = 0;
    std::ptrdiff_t shift = 0, step = 0;
    // Of its first block, in the arrays below.
    std::size_t first_group = 0, groups = 0, first_row = 0, rows = 0, first_entry = 0;
    std::size_t first_read = 0, reads = 0, first_order = 0;  // where it repeats
  };
  /// Repeats [begin, end) of a run: a piece of work for a thread.
  struct Piece {
    std::size_t run, begin, end;
  };

  struct Rows;
  void divide(const Rows& matrix, std::size_t begin, std::size_t end);
  void divide_entries(const Rows& all);
  void take(const Rows& matrix, std::size_t repeats, std::ptrdiff_t shift);
  void add(const Rows& matrix, const Run& run);
  void number_reads(Run& run);
  void order_rows(Run& run);
  void once(const Run& run, const double* x, const double* base, double* y) const;
  void repeated(const Run& run, std::size_t begin, std::size_t end, const double* x, const double* base,
                double* y) const;

  const Kernels* kernels_;
  // Of the first block of each run. Columns are those of x or, where the block repeats, places in `reads_`.
  std::vector<std::int32_t> rows_, places_, columns_, reads_, order_;
  std::vector<double> values_, kept_base_;  // the latter as rows_, or empty
  std::vector<RowGroup> groups_;
  std::vector<Run> runs_;
  std::vector<Piece> pieces_;
  std::size_t work_ = 0;  // entries, and one for each row
};

}  // namespace robotraj::native
