#include "combination.hpp"

#include <algorithm>
#include <numeric>

namespace robotraj::native {

namespace {

/// Entries that are worth handing to another thread, some 20 us of work.
constexpr std::size_t kPiece = 1u << 15;
/// Rows of a block at least, of what is looked at for repeats, and of a block at most.
constexpr std::size_t kLeast = 16, kWorthwhile = 128, kMost = 1u << 13;

/// `repeats` blocks of `period` rows from `row` on, equal but for columns that are `shift` apart.
struct Repeat {
  std::size_t row = 0, period = 0, repeats = 0;
  std::ptrdiff_t shift = 0;
  std::size_t size() const { return period * repeats; }
};

/// Whether rows [a, a + count) are those from b on, moved by a shift, which is found where it is not known.
bool same(const Csr& matrix, std::size_t a, std::size_t b, std::size_t count, std::ptrdiff_t& shift, bool& known) {
  const std::int32_t *starts = matrix.starts(), *columns = matrix.indices();
  const double* values = matrix.data();
  for (std::size_t row = 0; row < count; ++row) {
    const std::int32_t here = starts[a + row], there = starts[b + row], entries = starts[a + row + 1] - here;
    if (starts[b + row + 1] - there != entries) return false;
    for (std::int32_t e = 0; e < entries; ++e) {
      const std::ptrdiff_t apart = columns[there + e] - columns[here + e];
      if (!known) {
        shift = apart;
        known = true;
      }
      if (apart != shift || values[there + e] != values[here + e]) return false;
    }
  }
  return true;
}

/// The longest repeat within rows [begin, end) that goes through `middle`.
Repeat through(const Csr& matrix, std::size_t begin, std::size_t end, std::size_t middle) {
  Repeat best;
  for (std::size_t period = 1; period <= kMost && middle + 2 * period <= end; ++period) {
    std::ptrdiff_t shift = 0;
    bool known = false;
    if (!same(matrix, middle, middle + period, period, shift, known)) continue;
    std::size_t first = middle, last = middle + 2 * period;
    while (last + period <= end && same(matrix, last - period, last, period, shift, known)) last += period;
    while (first >= begin + period && same(matrix, first - period, first, period, shift, known)) first -= period;
    const Repeat found{first, period, (last - first) / period, shift};
    if (found.size() > best.size()) best = found;
    if (best.size() >= (end - begin) / 4) break;
  }
  // Blocks of few rows are taken several at a time.
  if (best.period > 0 && best.period < kLeast) {
    const std::size_t times = (kLeast + best.period - 1) / best.period;
    best = {best.row, best.period * times, best.repeats / times, best.shift * static_cast<std::ptrdiff_t>(times)};
  }
  return best;
}

template <std::size_t count>
void sum_rows(std::size_t rows, const std::int32_t* row, const std::int32_t* columns, const double* values,
              const double* x, const double* base, double* y) {
  for (std::size_t i = 0; i < rows; ++i, columns += count, values += count) {
    double sum = base ? base[row[i]] : 0.0;
    for (std::size_t e = 0; e < count; ++e) sum += values[e] * x[columns[e]];
    y[row[i]] = sum;
  }
}

}  // namespace

Combination::Combination(const Csr& matrix) {
  divide(matrix, 0, matrix.rows());
  for (std::size_t run = 0; run < runs_.size(); ++run) {
    std::size_t entries = 1;
    for (std::size_t g = runs_[run].groups_begin; g < runs_[run].groups_end; ++g)
      entries += groups_[g].rows * (groups_[g].count + 1);
    const std::size_t step = kPiece / entries + 1;
    for (std::size_t begin = 0; begin < runs_[run].repeats; begin += step)
      pieces_.push_back({run, begin, std::min(begin + step, runs_[run].repeats)});
  }
}

/// Finds what repeats in rows [begin, end), and in what is before and behind it.
void Combination::divide(const Csr& matrix, std::size_t begin, std::size_t end) {
  if (end - begin >= kWorthwhile)
    for (const std::size_t quarters : {2, 1, 3}) {
      const Repeat found = through(matrix, begin, end, begin + (end - begin) * quarters / 4);
      if (found.repeats < 4 || found.size() < (end - begin) / 8) continue;
      divide(matrix, begin, found.row);
      add(matrix, {found.row, found.period, found.repeats, found.shift, 0, 0});
      divide(matrix, found.row + found.size(), end);
      return;
    }
  // What does not repeat is cut for the threads.
  for (std::size_t row = begin; row < end;) {
    std::size_t last = row + 1;
    while (last < end && static_cast<std::size_t>(matrix.starts()[last] - matrix.starts()[row]) < kPiece) ++last;
    add(matrix, {row, last - row, 1, 0, 0, 0});
    row = last;
  }
}

/// Writes down one block of a run, rows of equally many entries together.
void Combination::add(const Csr& matrix, const Run& run) {
  const std::int32_t* starts = matrix.starts() + run.row;
  std::vector<std::int32_t> order(run.period);
  std::iota(order.begin(), order.end(), 0);
  const auto count = [starts](std::int32_t row) { return starts[row + 1] - starts[row]; };
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) { return count(a) < count(b); });
  Run added = run;
  added.groups_begin = groups_.size();
  for (const std::int32_t row : order) {
    const auto entries = static_cast<std::size_t>(count(row));
    if (groups_.size() == added.groups_begin || groups_.back().count != entries)
      groups_.push_back({entries, 0, rows_.size(), values_.size()});
    ++groups_.back().rows;
    rows_.push_back(row);
    columns_.insert(columns_.end(), matrix.indices() + starts[row], matrix.indices() + starts[row + 1]);
    values_.insert(values_.end(), matrix.data() + starts[row], matrix.data() + starts[row + 1]);
  }
  added.groups_end = groups_.size();
  runs_.push_back(added);
}

void Combination::block(const Run& run, const double* x, const double* base, double* y) const {
  for (std::size_t g = run.groups_begin; g < run.groups_end; ++g) {
    const Group& group = groups_[g];
    const std::int32_t *row = rows_.data() + group.first_row, *columns = columns_.data() + group.first_entry;
    const double* values = values_.data() + group.first_entry;
    switch (group.count) {
      case 0:
        if (base != y) sum_rows<0>(group.rows, row, columns, values, x, base, y);
        break;
      case 1: sum_rows<1>(group.rows, row, columns, values, x, base, y); break;
      case 2: sum_rows<2>(group.rows, row, columns, values, x, base, y); break;
      case 3: sum_rows<3>(group.rows, row, columns, values, x, base, y); break;
      case 4: sum_rows<4>(group.rows, row, columns, values, x, base, y); break;
      case 5: sum_rows<5>(group.rows, row, columns, values, x, base, y); break;
      case 6: sum_rows<6>(group.rows, row, columns, values, x, base, y); break;
      default:
        for (std::size_t i = 0; i < group.rows; ++i, columns += group.count, values += group.count) {
          double sum = base ? base[row[i]] : 0.0;
          for (std::size_t e = 0; e < group.count; ++e) sum += values[e] * x[columns[e]];
          y[row[i]] = sum;
        }
    }
  }
}

void Combination::apply(const double* x, const double* base, double* y, ThreadPool& pool) const {
  pool.split(pieces_.size(), [=](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t piece = begin; piece < end; ++piece) {
      const Run& run = runs_[pieces_[piece].run];
      for (std::size_t k = pieces_[piece].begin; k < pieces_[piece].end; ++k) {
        const std::size_t row = run.row + k * run.period;
        block(run, x + static_cast<std::ptrdiff_t>(k) * run.shift, base ? base + row : nullptr, y + row);
      }
    }
  });
}

}  // namespace robotraj::native
