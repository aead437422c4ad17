// Sparse combinations against single products: repetition changes their memory only, not their values.
#include <algorithm>
#include <cmath>
#include <random>

#include "check.hpp"
#include "kernels/packed.hpp"
#include "sparse/combination.hpp"

namespace robotraj::tests {
namespace {

using native::Combination;
using native::Csr;
using native::Numbers;
using Places = std::vector<std::int32_t>;

struct Random {
  std::mt19937 random{3};
  std::normal_distribution<double> normal;

  Numbers numbers(std::size_t n) {
    Numbers drawn(n);
    for (double& each : drawn) each = normal(random);
    return drawn;
  }
};

/// Entries that are added one by one.
struct Entries {
  std::vector<std::int64_t> rows, columns;
  Numbers values;

  void add(std::size_t row, std::size_t column, double value) {
    rows.push_back(static_cast<std::int64_t>(row));
    columns.push_back(static_cast<std::int64_t>(column));
    values.push_back(value);
  }
  /// `stages` times the same random block, each `columns` further on, some rows of it empty.
  void add_staircase(Random& its, std::size_t first, std::size_t stages, std::size_t rows, std::size_t columns,
                     std::size_t overlap) {
    std::bernoulli_distribution present(0.3);
    for (std::size_t row = 0; row < rows; ++row)
      for (std::size_t column = 0; column < columns + overlap && row % 7 != 3; ++column)
        if (present(its.random)) {
          const double value = its.normal(its.random);
          for (std::size_t k = 0; k < stages; ++k) add(first + k * rows + row, k * columns + column, value);
        }
  }
  void add_random(Random& its, std::size_t first, std::size_t rows, std::size_t columns) {
    std::bernoulli_distribution present(0.1);
    for (std::size_t row = 0; row < rows; ++row)
      for (std::size_t column = 0; column < columns; ++column)
        if (present(its.random)) add(first + row, column, its.normal(its.random));
  }
  Csr matrix(std::size_t height, std::size_t width) const {
    return Csr::summed(height, width, values.size(), rows.data(), columns.data(), values.data());
  }
};

Csr staircase(Random& its, std::size_t stages, std::size_t rows, std::size_t columns, std::size_t overlap) {
  Entries entries;
  entries.add_staircase(its, 0, stages, rows, columns, overlap);
  return entries.matrix(stages * rows, stages * columns + overlap);
}

Numbers product(const Csr& matrix, const Numbers& x) {
  Numbers y(matrix.rows());
  matrix.times(x.data(), y.data());
  return y;
}

bool near(const Numbers& a, const Numbers& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double x, double y) { return std::abs(x - y) <= 1e-12 * (1.0 + std::abs(y)); });
}

/// Whether base + A x is what a single product gives.
bool adds_the_product(Random& its, const Csr& matrix, const Combination& made, std::size_t threads = 1) {
  native::ThreadPool pool(threads);
  const Numbers x = its.numbers(matrix.columns()), base = its.numbers(matrix.rows());
  Numbers found(matrix.rows()), expected = product(matrix, x);
  made.apply(x.data(), base.data(), found.data(), pool);
  for (std::size_t i = 0; i < expected.size(); ++i) expected[i] += base[i];
  return near(found, expected);
}

}  // namespace

ROBOTRAJ_TEST(blocks_that_repeat_are_kept_once) {
  Random its;
  for (const native::Kernels* kernels : native::kernels())
    for (const std::size_t stages : {1, 4, 8, 30, 400}) {
      const Csr matrix = staircase(its, stages, 40, 25, 12);
      const Combination made(native::Stacked(matrix), nullptr, nullptr, kernels);
      for (const std::size_t threads : {1, 2}) CHECK(adds_the_product(its, matrix, made, threads));
      CHECK(made.entries() == (stages < 4 ? matrix.entries() : matrix.entries() / stages));
    }
}

ROBOTRAJ_TEST(sections_and_what_lies_between_them) {
  Random its;
  Entries entries;
  const std::size_t columns = 50 * 20;
  entries.add_random(its, 0, 70, columns);
  entries.add_staircase(its, 70, 50, 33, 20, 0);
  entries.add_random(its, 1720, 45, columns);
  entries.add_staircase(its, 1765, 50, 17, 20, 0);
  entries.add_random(its, 2615, 90, columns);
  const Csr matrix = entries.matrix(2705, columns);
  const Combination made(matrix);
  CHECK(adds_the_product(its, matrix, made));
  // Of the 100 blocks, two are kept.
  std::size_t outside = 0;
  for (const auto& [first, last] : {std::pair{0, 70}, std::pair{1720, 1765}, std::pair{2615, 2705}})
    outside += matrix.starts()[last] - matrix.starts()[first];
  CHECK(made.entries() < outside + (matrix.entries() - outside) / 10);
}

ROBOTRAJ_TEST(one_number_that_differs_is_not_taken_for_the_others) {
  Random its;
  Entries entries;
  entries.add_staircase(its, 0, 60, 40, 25, 12);
  for (const std::size_t entry : {std::size_t{0}, entries.values.size() / 2, entries.values.size() - 1}) {
    Entries changed = entries;
    changed.values[entry] += 1.0;
    const Csr matrix = changed.matrix(60 * 40, 60 * 25 + 12);
    CHECK(adds_the_product(its, matrix, Combination(matrix)));
  }
}

ROBOTRAJ_TEST(empty_rows_leave_the_base) {
  Random its;
  for (const std::size_t rows : {0, 1, 15, 129}) {
    const Csr matrix = Entries().matrix(rows, 3);
    CHECK(adds_the_product(its, matrix, Combination(matrix)));
    CHECK(Combination(matrix).entries() == 0);
  }
}

ROBOTRAJ_TEST(results_may_have_places_of_their_own) {
  Random its;
  native::ThreadPool pool(1);
  for (const native::Kernels* kernels : native::kernels())
    for (const std::size_t rows : {7, 40}) {
      const Csr matrix = staircase(its, 50, rows, 25, 12);
      // Every stage leaves a gap, its first two rows are dropped, and one row has another place than those like it.
      Places places;
      for (std::size_t i = 0; i < matrix.rows(); ++i)
        places.push_back(i % rows < 2 ? -1 : static_cast<std::int32_t>(i + 3 * (i / rows)));
      places[31 * rows + 5] = static_cast<std::int32_t>(60 * rows);
      const Combination made(native::Stacked(matrix), places.data(), nullptr, kernels);
      const Numbers x = its.numbers(matrix.columns()), sums = product(matrix, x);
      Numbers found = its.numbers(60 * rows + 200), expected = found;
      made.apply(x.data(), found.data(), found.data(), pool);
      for (std::size_t i = 0; i < places.size(); ++i)
        if (places[i] >= 0) expected[places[i]] += sums[i];
      CHECK(near(found, expected));
      CHECK(made.entries() < 0.2 * matrix.entries());
    }
}

ROBOTRAJ_TEST(a_base_that_stays_is_kept_with_the_rows) {
  Random its;
  native::ThreadPool pool(1);
  for (const native::Kernels* kernels : native::kernels())
    for (const std::size_t stages : {3, 50}) {
      const Csr matrix = staircase(its, stages, 40, 25, 12);
      const Numbers x = its.numbers(matrix.columns()), of_stage = its.numbers(40), sums = product(matrix, x);
      Numbers base;
      for (std::size_t k = 0; k < stages; ++k) base.insert(base.end(), of_stage.begin(), of_stage.end());
      for (std::size_t k = 0; k < stages; k += 20) base[40 * k + 7] += 1.0;  // one number is not taken for the others
      for (const bool backwards : {false, true}) {
        Places order(matrix.rows());
        for (std::size_t i = 0; i < order.size(); ++i)
          order[i] = static_cast<std::int32_t>(backwards ? order.size() - 1 - i : i);
        const Combination made(native::Stacked(matrix), order.data(), base.data(), kernels);
        Numbers kept(base.size()), given = its.numbers(base.size()), of_kept(base.size()), of_given = given;
        made.apply(x.data(), nullptr, kept.data(), pool);
        made.apply(x.data(), given.data(), given.data(), pool);
        for (std::size_t i = 0; i < sums.size(); ++i) {
          of_kept[order[i]] = base[i] + sums[i];
          of_given[order[i]] += sums[i];
        }
        CHECK(near(kept, of_kept) && near(given, of_given));
        CHECK(made.entries() < 0.5 * matrix.entries() || stages == 3);
      }
    }
}

ROBOTRAJ_TEST(stacked_blocks_are_their_rows) {
  Random its;
  native::ThreadPool pool(1);
  const std::size_t rows = 20, repeats = 9;
  Entries entries;
  entries.add_staircase(its, 0, 1, rows, 8, 4);
  const Csr block = entries.matrix(rows, 8 * repeats + 4);
  native::Stacking stacking(block.columns());
  stacking.append(block);
  for (std::size_t k = 1; k < repeats; ++k) CHECK(stacking.repeat(8));
  const native::Stacked stacked = stacking.stacked();
  CHECK(stacked.kept() == block.entries() && stacked.entries() == repeats * block.entries());
  const Numbers x = its.numbers(stacked.columns());
  Numbers sums(stacked.rows());
  for (std::size_t k = 0; k < repeats; ++k) block.times(x.data() + 8 * k, sums.data() + k * rows);
  // In their order, moved alike, and one moved apart from the others.
  Places in_order, moved;
  for (std::size_t i = 0; i < stacked.rows(); ++i) {
    in_order.push_back(static_cast<std::int32_t>(i));
    moved.push_back(i % rows == 2 ? -1 : static_cast<std::int32_t>(2 * i));
  }
  Places apart = moved;
  apart[4 * rows + 5] = static_cast<std::int32_t>(2 * stacked.rows());
  for (const Places& places : {in_order, moved, apart})
    for (const Combination& made : {Combination(stacked, places.data()), Combination::adding(stacked, places.data())}) {
      Numbers found = its.numbers(2 * stacked.rows() + 1), expected = found;
      made.apply(x.data(), found.data(), found.data(), pool);
      for (std::size_t i = 0; i < places.size(); ++i)
        if (places[i] >= 0) expected[places[i]] += sums[i];
      CHECK(near(found, expected));
    }
}

}  // namespace robotraj::tests
