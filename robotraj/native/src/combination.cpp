#include "combination.hpp"

#include <algorithm>

namespace robotraj::native {

namespace {

/// Entries that are worth handing to another thread, some 20 us of work.
constexpr std::size_t kPiece = 1u << 15;
/// Rows of a block at least, of what is looked at for repeats, and of a block at most.
constexpr std::size_t kLeast = 16, kWorthwhile = 128, kMost = 1u << 13;

}  // namespace

/// A piece of the matrix with the places of its rows.
struct Combination::Rows {
  const Csr& matrix;
  const std::int32_t* places;
  std::size_t first;          // row of the whole
  std::ptrdiff_t behind = 0;  // how much further on x is read than its columns say
  std::ptrdiff_t place(std::size_t row) const {
    return places ? places[first + row] : static_cast<std::ptrdiff_t>(first + row);
  }

  /// Whether `count` places from row b on are those from a on, moved by the run's step, which is found at first.
  bool same_places(std::size_t a, std::size_t b, std::size_t count, Run& run, bool& known) const {
    for (std::size_t row = 0; row < count; ++row) {
      const std::ptrdiff_t from = place(a + row), to = place(b + row);
      if ((from < 0) != (to < 0)) return false;
      if (from < 0) continue;
      if (known && to - from != run.step) return false;
      run.step = to - from;
      known = true;
    }
    return true;
  }

  /// Whether rows [a, a + count) are those from b on, moved by the run's shift and step, which are found at first.
  bool same(std::size_t a, std::size_t b, std::size_t count, Run& run, bool (&known)[2]) const {
    const std::int32_t *starts = matrix.starts(), *columns = matrix.indices();
    const double* values = matrix.data();
    for (std::size_t row = 0; row < count; ++row) {
      const std::int32_t here = starts[a + row], there = starts[b + row], entries = starts[a + row + 1] - here;
      if (starts[b + row + 1] - there != entries || !same_places(a + row, b + row, 1, run, known[1])) return false;
      for (std::int32_t e = 0; e < entries; ++e) {
        const std::ptrdiff_t apart = columns[there + e] - columns[here + e];
        if ((known[0] && apart != run.shift) || values[there + e] != values[here + e]) return false;
        run.shift = apart;
        known[0] = true;
      }
    }
    return true;
  }

  /// The longest run within rows [begin, end) that goes through `middle`.
  Run through(std::size_t begin, std::size_t end, std::size_t middle) const {
    Run best{};
    for (std::size_t period = 1; period <= kMost && middle + 2 * period <= end; ++period) {
      Run run{};
      bool known[2] = {false, false};
      if (!same(middle, middle + period, period, run, known)) continue;
      std::size_t first = middle, last = middle + 2 * period;
      while (last + period <= end && same(last - period, last, period, run, known)) last += period;
      while (first >= begin + period && same(first - period, first, period, run, known)) first -= period;
      if (last - first > best.period * best.repeats)
        best = {first, period, (last - first) / period, run.shift, run.step, 0, 0};
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

namespace {

template <std::size_t count>
void sum_rows(std::size_t rows, const std::int32_t* row, const std::int32_t* place, const std::int32_t* columns,
              const double* values, const double* x, const double* base, double* y) {
  for (std::size_t i = 0; i < rows; ++i, columns += count, values += count) {
    double sum = base ? base[row[i]] : 0.0;
    for (std::size_t e = 0; e < count; ++e) sum += values[e] * x[columns[e]];
    y[place[i]] = sum;
  }
}

}  // namespace

Combination::Combination(const Stacked& matrix, const std::int32_t* places) {
  std::size_t first = 0;
  for (const Stacked::Piece& piece : matrix.pieces()) {
    if (piece.repeats > 1)
      take(piece, places, first);
    else
      divide({piece.rows, places, first}, 0, piece.rows.rows());
    first += piece.repeats * piece.rows.rows();
  }
  for (std::size_t run = 0; run < runs_.size(); ++run) {
    std::size_t entries = 1;
    for (std::size_t g = runs_[run].groups_begin; g < runs_[run].groups_end; ++g)
      entries += groups_[g].rows * (groups_[g].count + 1);
    work_ += entries * runs_[run].repeats;
    const std::size_t step = kPiece / entries + 1;
    for (std::size_t begin = 0; begin < runs_[run].repeats; begin += step)
      pieces_.push_back({run, begin, std::min(begin + step, runs_[run].repeats)});
  }
}

/// What repeats already, as far as its places do.
void Combination::take(const Stacked::Piece& piece, const std::int32_t* places, std::size_t first) {
  const std::size_t period = piece.rows.rows();
  for (std::size_t begin = 0, end; begin < piece.repeats; begin = end) {
    const Rows rows{piece.rows, places, first + begin * period, static_cast<std::ptrdiff_t>(begin) * piece.shift};
    Run run{0, period, 1, piece.shift, 0, 0, 0};
    bool known = false;
    for (end = begin + 1; end < piece.repeats; ++end) {
      const std::size_t row = (end - 1 - begin) * period;
      if (!rows.same_places(row, row + period, period, run, known)) break;
      ++run.repeats;
    }
    add(rows, run);
  }
}

/// Finds what repeats in rows [begin, end), and in what is before and behind it.
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
  // What does not repeat is cut for the threads.
  const std::int32_t* starts = matrix.matrix.starts();
  for (std::size_t row = begin; row < end;) {
    std::size_t last = row + 1;
    while (last < end && static_cast<std::size_t>(starts[last] - starts[row]) < kPiece) ++last;
    add(matrix, {row, last - row, 1, 0, 0, 0, 0});
    row = last;
  }
}

/// Writes down one block of a run, rows of equally many entries together.
void Combination::add(const Rows& rows, const Run& run) {
  const Csr& matrix = rows.matrix;
  const std::int32_t* starts = matrix.starts() + run.row;
  std::vector<std::int32_t> order;
  for (std::size_t row = 0; row < run.period; ++row)
    if (rows.place(run.row + row) >= 0) order.push_back(static_cast<std::int32_t>(row));
  const auto count = [starts](std::int32_t row) { return starts[row + 1] - starts[row]; };
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) { return count(a) < count(b); });
  Run added = run;
  added.groups_begin = groups_.size();
  for (const std::int32_t row : order) {
    const auto entries = static_cast<std::size_t>(count(row));
    if (groups_.size() == added.groups_begin || groups_.back().count != entries)
      groups_.push_back({entries, 0, rows_.size(), values_.size()});
    ++groups_.back().rows;
    rows_.push_back(static_cast<std::int32_t>(rows.first + run.row) + row);
    places_.push_back(static_cast<std::int32_t>(rows.place(run.row + static_cast<std::size_t>(row))));
    for (std::int32_t e = starts[row]; e < starts[row + 1]; ++e)
      columns_.push_back(matrix.indices()[e] + static_cast<std::int32_t>(rows.behind));
    values_.insert(values_.end(), matrix.data() + starts[row], matrix.data() + starts[row + 1]);
  }
  added.groups_end = groups_.size();
  runs_.push_back(added);
}

void Combination::block(const Run& run, std::size_t repeat, const double* x, const double* base, double* y) const {
  const auto k = static_cast<std::ptrdiff_t>(repeat);
  const bool adds = base == y;
  x += k * run.shift;
  y += k * run.step;
  if (base) base += adds ? k * run.step : k * static_cast<std::ptrdiff_t>(run.period);
  const std::vector<std::int32_t>& from = adds ? places_ : rows_;
  for (std::size_t g = run.groups_begin; g < run.groups_end; ++g) {
    const Group& group = groups_[g];
    const std::int32_t *row = from.data() + group.first_row, *place = places_.data() + group.first_row,
                       *columns = columns_.data() + group.first_entry;
    const double* values = values_.data() + group.first_entry;
    switch (group.count) {
      case 0:
        if (!adds) sum_rows<0>(group.rows, row, place, columns, values, x, base, y);
        break;
      case 1: sum_rows<1>(group.rows, row, place, columns, values, x, base, y); break;
      case 2: sum_rows<2>(group.rows, row, place, columns, values, x, base, y); break;
      case 3: sum_rows<3>(group.rows, row, place, columns, values, x, base, y); break;
      case 4: sum_rows<4>(group.rows, row, place, columns, values, x, base, y); break;
      case 5: sum_rows<5>(group.rows, row, place, columns, values, x, base, y); break;
      case 6: sum_rows<6>(group.rows, row, place, columns, values, x, base, y); break;
      default:
        for (std::size_t i = 0; i < group.rows; ++i, columns += group.count, values += group.count) {
          double sum = base ? base[row[i]] : 0.0;
          for (std::size_t e = 0; e < group.count; ++e) sum += values[e] * x[columns[e]];
          y[place[i]] = sum;
        }
    }
  }
}

void Combination::apply(const double* x, const double* base, double* y, ThreadPool& pool) const {
  const std::size_t step = work_ < 2 * kPiece ? pieces_.size() : 1;
  pool.split(pieces_.size(), step, [=](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t piece = begin; piece < end; ++piece)
      for (std::size_t k = pieces_[piece].begin; k < pieces_[piece].end; ++k)
        block(runs_[pieces_[piece].run], k, x, base, y);
  });
}

}  // namespace robotraj::native
