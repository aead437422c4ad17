// The product y = base + A x of a combination, by pieces that threads share.
#include <algorithm>

#include "combination.hpp"
#include "kernels/packed.hpp"
#include "parallel/pack.hpp"

namespace robotraj::native {

namespace {

/// Rows of a group; base i is base[row[i]], or base[i] where `row` is null.
template <std::size_t fixed>
void sum_rows(const RowGroup& group, const std::int32_t* row, const std::int32_t* place, const std::int32_t* columns,
              const double* values, const double* x, const double* base, double* y) {
  const std::size_t count = fixed ? fixed : group.count;
  for (std::size_t i = 0; i < group.rows; ++i, columns += count, values += count) {
    double sum = base ? base[row ? row[i] : i] : 0.0;
    for (std::size_t e = 0; e < count; ++e) sum += values[e] * x[columns[e]];
    y[place[i]] = sum;
  }
}

}  // namespace

void Combination::once(const Run& run, const double* x, const double* base, double* y) const {
  const bool kept = !base && !kept_base_.empty();
  const std::int32_t *place = places_.data() + run.first_row, *columns = columns_.data() + run.first_entry;
  const std::int32_t* row = kept ? nullptr : base == y ? place : rows_.data() + run.first_row;
  const double* values = values_.data() + run.first_entry;
  if (kept) base = kept_base_.data() + run.first_row;
  for (std::size_t g = run.first_group; g < run.first_group + run.groups; ++g) {
    const RowGroup& group = groups_[g];
    switch (group.count) {
      case 1: sum_rows<1>(group, row, place, columns, values, x, base, y); break;
      case 2: sum_rows<2>(group, row, place, columns, values, x, base, y); break;
      case 3: sum_rows<3>(group, row, place, columns, values, x, base, y); break;
      case 4: sum_rows<4>(group, row, place, columns, values, x, base, y); break;
      case 5: sum_rows<5>(group, row, place, columns, values, x, base, y); break;
      case 6: sum_rows<6>(group, row, place, columns, values, x, base, y); break;
      default: sum_rows<0>(group, row, place, columns, values, x, base, y);
    }
    if (kept) base += group.rows;
    else row += group.rows;
    place += group.rows;
    columns += group.rows * group.count;
    values += group.rows * group.count;
  }
}

/// Repeats [begin, end), a pack of them at once.
void Combination::repeated(const Run& run, std::size_t begin, std::size_t end, const double* x, const double* base,
                           double* y) const {
  static thread_local Packs memory;
  const std::size_t lanes = kernels_->lanes, needed = (run.reads + run.rows) * lanes;
  if (memory.size() < needed) memory.resize(needed);
  const bool adds = base == y;
  const std::int32_t* places = places_.data() + run.first_row;
  const RepeatedRows rows{reads_.data() + run.first_read,
                          run.reads,
                          groups_.data() + run.first_group,
                          run.groups,
                          columns_.data() + run.first_entry,
                          values_.data() + run.first_entry,
                          order_.data() + run.first_order,
                          adds ? places : rows_.data() + run.first_row,
                          places,
                          kept_base_.empty() ? nullptr : kept_base_.data() + run.first_row,
                          run.rows};
  const RepeatSteps steps{run.shift, adds ? run.step : static_cast<std::ptrdiff_t>(run.period), run.step};
  for (std::size_t k = begin; k < end; k += lanes) {
    const auto at = static_cast<std::ptrdiff_t>(k);
    kernels_->combine_rows(rows, steps, x + at * steps.x, base ? base + at * steps.base : nullptr, y + at * steps.y,
                           std::min(lanes, end - k), memory.data());
  }
}

void Combination::apply(const double* x, const double* base, double* y, ThreadPool& pool) const {
  const std::size_t step = work_ < 2 * kPiece ? pieces_.size() : 1;
  pool.split(pieces_.size(), step, [=](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t piece = begin; piece < end; ++piece) {
      const Run& run = runs_[pieces_[piece].run];
      if (run.repeats > 1) repeated(run, pieces_[piece].begin, pieces_[piece].end, x, base, y);
      else once(run, x, base, y);
    }
  });
}

}  // namespace robotraj::native
