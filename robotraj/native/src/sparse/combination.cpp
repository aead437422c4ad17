#include "combination.hpp"

#include <algorithm>
#include <numeric>

#include "kernels/packed.hpp"
#include "parallel/pack.hpp"

namespace robotraj::native {

namespace {

/// Least rows of a block, least rows in which repeats are searched for, and most rows of a block.
constexpr std::size_t kLeast = 16, kWorthwhile = 128, kMost = 1u << 13;
/// Most comparisons a row in the search for repeats, which limits the cost where nothing repeats.
constexpr std::size_t kPatience = 4;

}  // namespace

/// A piece of the matrix with the places and the kept base of its rows, each null where there is none.
struct Combination::Rows {
  const Csr& matrix;
  const std::int32_t* places;
  const double* base;
  bool adds;
  std::size_t first;          // row of the whole
  std::ptrdiff_t behind = 0;  // offset of the entries of x that are read from its columns
  std::ptrdiff_t place(std::size_t row) const {
    if (adds) {
      const std::int32_t* entries = matrix.starts() + row % matrix.rows();
      if (entries[0] == entries[1]) return -1;
    }
    return places ? places[first + row] : static_cast<std::ptrdiff_t>(first + row);
  }

  /// Whether `count` rows from b on have the base of those from a on, and their places moved by the run's step. The
  /// first call finds the step.
  bool same_ends(std::size_t a, std::size_t b, std::size_t count, Run& run, bool& known) const {
    for (std::size_t row = 0; row < count; ++row) {
      const std::ptrdiff_t from = place(a + row), to = place(b + row);
      if (base && base[first + a + row] != base[first + b + row]) return false;
      if ((from < 0) != (to < 0)) return false;
      if (from < 0) continue;
      if (known && to - from != run.step) return false;
      run.step = to - from;
      known = true;
    }
    return true;
  }

  /// Whether rows [a, a + count) are those from b on, moved by the run's shift and step, which are found at first.
  /// Counts the rows that it compares.
  bool same(std::size_t a, std::size_t b, std::size_t count, Run& run, bool (&known)[2], std::size_t& compared) const {
    const std::int32_t *starts = matrix.starts(), *columns = matrix.indices();
    const double* values = matrix.data();
    for (std::size_t row = 0; row < count; ++row) {
      ++compared;
      const std::int32_t here = starts[a + row], there = starts[b + row], entries = starts[a + row + 1] - here;
      if (starts[b + row + 1] - there != entries || !same_ends(a + row, b + row, 1, run, known[1])) return false;
      for (std::int32_t e = 0; e < entries; ++e) {
        const std::ptrdiff_t apart = columns[there + e] - columns[here + e];
        if ((known[0] && apart != run.shift) || values[there + e] != values[here + e]) return false;
        run.shift = apart;
        known[0] = true;
      }
    }
    return true;
  }

  /// The longest run within rows [begin, end) that includes `middle`.
  Run through(std::size_t begin, std::size_t end, std::size_t middle) const {
    Run best{};
    std::size_t compared = 0;
    for (std::size_t period = 1; period <= kMost && middle + 2 * period <= end; ++period) {
      if (compared > kPatience * (end - begin)) break;
      Run run{};
      bool known[2] = {false, false};
      if (!same(middle, middle + period, period, run, known, compared)) continue;
      std::size_t first = middle, last = middle + 2 * period;
      while (last + period <= end && same(last - period, last, period, run, known, compared)) last += period;
      while (first >= begin + period && same(first - period, first, period, run, known, compared)) first -= period;
      if (last - first > best.period * best.repeats)
        best = {first, period, (last - first) / period, run.shift, run.step};
      if (last - first >= (end - begin) / 4) break;
    }
    // Blocks of few rows are taken several at a time.
    if (best.period > 0 && best.period < kLeast) {
      const std::size_t times = (kLeast + best.period - 1) / best.period;
      best.period *= times;
      best.repeats /= times;
      best.shift *= static_cast<std::ptrdiff_t>(times);
      best.step *= static_cast<std::ptrdiff_t>(times);
    }
    return best;
  }
};

Combination::Combination(const Stacked& matrix, const std::int32_t* places, const double* kept_base,
                         const Kernels* kernels, bool adds)
    : kernels_(kernels ? kernels : native::kernels().front()) {
  std::size_t first = 0;
  for (const Stacked::Piece& piece : matrix.pieces()) {
    const Rows rows{piece.rows, places, kept_base, adds, first};
    if (piece.repeats > 1) take(rows, piece.repeats, piece.shift);
    else if (adds) divide_entries(rows);
    else divide(rows, 0, piece.rows.rows());
    first += piece.repeats * piece.rows.rows();
  }
  for (std::size_t run = 0; run < runs_.size(); ++run) {
    std::size_t entries = 1;
    for (std::size_t g = 0; g < runs_[run].groups; ++g) {
      const RowGroup& group = groups_[runs_[run].first_group + g];
      entries += group.rows * (group.count + 1);
    }
    work_ += entries * runs_[run].repeats;
    const std::size_t step = (kPiece / entries / kMostLanes + 1) * kMostLanes;
    for (std::size_t begin = 0; begin < runs_[run].repeats; begin += step)
      pieces_.push_back({run, begin, std::min(begin + step, runs_[run].repeats)});
  }
}

/// Repeated rows whose places and base repeat as well.
void Combination::take(const Rows& matrix, std::size_t repeats, std::ptrdiff_t shift) {
  const std::size_t period = matrix.matrix.rows();
  for (std::size_t begin = 0, end; begin < repeats; begin = end) {
    Run run{0, period, 1, shift};
    bool known = false;
    for (end = begin + 1; end < repeats; ++end) {
      const std::size_t row = (end - 1) * period;
      if (!matrix.same_ends(row, row + period, period, run, known)) break;
      ++run.repeats;
    }
    Rows rows = matrix;
    rows.first += begin * period;
    rows.behind = static_cast<std::ptrdiff_t>(begin) * shift;
    add(rows, run);
  }
}

/// The same for rows with entries alone. The others would hide the repeats: they are equal to each other.
void Combination::divide_entries(const Rows& all) {
  const Csr& matrix = all.matrix;
  std::vector<std::int32_t> starts{0}, places;
  for (std::size_t row = 0; row < matrix.rows(); ++row) {
    if (matrix.starts()[row] == matrix.starts()[row + 1]) continue;
    starts.push_back(matrix.starts()[row + 1]);
    places.push_back(static_cast<std::int32_t>(all.place(row)));
  }
  const Csr entries(matrix.columns(), std::move(starts), {matrix.indices(), matrix.indices() + matrix.entries()},
                    {matrix.data(), matrix.data() + matrix.entries()});
  divide({entries, places.data(), nullptr, false, 0}, 0, entries.rows());
}

/// Finds repeated blocks in rows [begin, end): one run, then those in the rows before and behind it.
void Combination::divide(const Rows& matrix, std::size_t begin, std::size_t end) {
  if (end - begin >= kWorthwhile)
    for (const std::size_t quarters : {2, 1, 3}) {
      const Run run = matrix.through(begin, end, begin + (end - begin) * quarters / 4);
      const std::size_t size = run.period * run.repeats;
      if (run.repeats < 4 || size < (end - begin) / 8) continue;
      divide(matrix, begin, run.row);
      add(matrix, run);
      divide(matrix, run.row + size, end);
      return;
    }
  // Rows that do not repeat are divided among the threads.
  const std::int32_t* starts = matrix.matrix.starts();
  for (std::size_t row = begin; row < end;) {
    std::size_t last = row + 1;
    while (last < end && static_cast<std::size_t>(starts[last] - starts[row]) < kPiece) ++last;
    add(matrix, {row, last - row, 1});
    row = last;
  }
}

/// Stores one block of a run, rows of equally many entries together.
void Combination::add(const Rows& rows, const Run& run) {
  const Csr& matrix = rows.matrix;
  const std::int32_t* starts = matrix.starts() + run.row;
  std::vector<std::int32_t> order;
  for (std::size_t row = 0; row < run.period; ++row)
    if (rows.place(run.row + row) >= 0) order.push_back(static_cast<std::int32_t>(row));
  const auto count = [starts](std::int32_t row) { return starts[row + 1] - starts[row]; };
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) { return count(a) < count(b); });
  Run added = run;
  added.first_group = groups_.size();
  added.first_row = rows_.size();
  added.rows = order.size();
  added.first_entry = values_.size();
  for (const std::int32_t row : order) {
    const auto entries = static_cast<std::size_t>(count(row));
    if (groups_.size() == added.first_group || groups_.back().count != entries) groups_.push_back({entries, 0});
    ++groups_.back().rows;
    rows_.push_back(static_cast<std::int32_t>(rows.first + run.row) + row);
    places_.push_back(static_cast<std::int32_t>(rows.place(run.row + row)));
    if (rows.base) kept_base_.push_back(rows.base[rows.first + run.row + row]);
    for (std::int32_t e = starts[row]; e < starts[row + 1]; ++e)
      columns_.push_back(matrix.indices()[e] + static_cast<std::int32_t>(rows.behind));
    values_.insert(values_.end(), matrix.data() + starts[row], matrix.data() + starts[row + 1]);
  }
  added.groups = groups_.size() - added.first_group;
  if (added.repeats > 1) {
    number_reads(added);
    order_rows(added);
  }
  runs_.push_back(added);
}

/// Lists the columns that the last block reads; its entries become indices into that list.
void Combination::number_reads(Run& run) {
  const auto begin = columns_.begin() + static_cast<std::ptrdiff_t>(run.first_entry);
  std::vector<std::int32_t> reads(begin, columns_.end());
  std::sort(reads.begin(), reads.end());
  reads.erase(std::unique(reads.begin(), reads.end()), reads.end());
  for (auto column = begin; column != columns_.end(); ++column)
    *column = static_cast<std::int32_t>(std::lower_bound(reads.begin(), reads.end(), *column) - reads.begin());
  run.first_read = reads_.size();
  run.reads = reads.size();
  reads_.insert(reads_.end(), reads.begin(), reads.end());
}

/// Orders the last block so that its results are written in the order of their places; its groups stay the same.
void Combination::order_rows(Run& run) {
  const auto rows = rows_.begin() + static_cast<std::ptrdiff_t>(run.first_row);
  const auto places = places_.begin() + static_cast<std::ptrdiff_t>(run.first_row);
  std::vector<std::int32_t> order(run.rows), from(run.rows), to(run.rows);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [places](std::int32_t a, std::int32_t b) { return places[a] < places[b]; });
  for (std::size_t i = 0; i < run.rows; ++i) {
    from[i] = rows[order[i]];
    to[i] = places[order[i]];
  }
  std::copy(from.begin(), from.end(), rows);
  std::copy(to.begin(), to.end(), places);
  run.first_order = order_.size();
  order_.insert(order_.end(), order.begin(), order.end());
}

}  // namespace robotraj::native
