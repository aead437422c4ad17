#include "sparse.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace robotraj::native {

Csr::Csr(std::size_t rows, std::size_t columns, std::vector<std::int32_t> starts, std::vector<std::int32_t> indices,
         std::vector<double> data)
    : Csr(columns, std::move(starts), std::move(indices), std::move(data)) {
  const std::vector<std::int32_t>& begins = arrays_->starts;
  if (std::max(entries(), columns) > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
    throw std::invalid_argument("a sparse matrix has more than 2^31 entries");
  if (rows_ != rows || begins.front() != 0 || static_cast<std::size_t>(begins.back()) != entries() ||
      arrays_->indices.size() != entries())
    throw std::invalid_argument("the row starts of a sparse matrix of " + std::to_string(rows) + " rows and " +
                                std::to_string(entries()) + " entries do not fit it");
  if (!std::is_sorted(begins.begin(), begins.end()))
    throw std::invalid_argument("the row starts of a sparse matrix decrease");
  for (const std::int32_t column : arrays_->indices)
    if (column < 0 || static_cast<std::size_t>(column) >= columns)
      throw std::invalid_argument("column " + std::to_string(column) + " in a sparse matrix of " +
                                  std::to_string(columns) + " columns");
}

Csr::Csr(std::size_t columns, std::vector<std::int32_t> starts, std::vector<std::int32_t> indices,
         std::vector<double> data)
    : rows_(starts.size() - 1),
      columns_(columns),
      arrays_(std::make_shared<const Arrays>(Arrays{std::move(starts), std::move(indices), std::move(data)})) {}

void Csr::times(const double* x, double* y) const {
  for (std::size_t row = 0; row < rows_; ++row) {
    double sum = 0.0;
    for (std::int32_t i = starts()[row]; i < starts()[row + 1]; ++i) sum += data()[i] * x[indices()[i]];
    y[row] = sum;
  }
}

Csr Csr::transposed() const {
  std::vector<std::int32_t> begins(columns_ + 1, 0), rows(entries());
  std::vector<double> values(entries());
  for (std::size_t i = 0; i < entries(); ++i) ++begins[indices()[i] + 1];
  for (std::size_t column = 0; column < columns_; ++column) begins[column + 1] += begins[column];
  std::vector<std::int32_t> next(begins.begin(), begins.end() - 1);
  for (std::size_t row = 0; row < rows_; ++row)
    for (std::int32_t i = starts()[row]; i < starts()[row + 1]; ++i) {
      const std::int32_t slot = next[indices()[i]]++;
      rows[slot] = static_cast<std::int32_t>(row);
      values[slot] = data()[i];
    }
  return Csr(rows_, std::move(begins), std::move(rows), std::move(values));
}

Csr Csr::summed(std::size_t rows, std::size_t columns, std::size_t entries, const std::int64_t* row,
                const std::int64_t* column, const double* data) {
  for (std::size_t i = 0; i < entries; ++i)
    if (row[i] < 0 || static_cast<std::size_t>(row[i]) >= rows || column[i] < 0 ||
        static_cast<std::size_t>(column[i]) >= columns)
      throw std::invalid_argument("entry (" + std::to_string(row[i]) + ", " + std::to_string(column[i]) +
                                  ") of a sparse matrix of " + std::to_string(rows) + " rows and " +
                                  std::to_string(columns) + " columns");
  std::vector<std::int32_t> begins(rows + 1, 0);
  for (std::size_t i = 0; i < entries; ++i) ++begins[row[i] + 1];
  for (std::size_t r = 0; r < rows; ++r) begins[r + 1] += begins[r];
  bool ordered = true;
  for (std::size_t i = 1; ordered && i < entries; ++i)
    ordered = row[i - 1] < row[i] || (row[i - 1] == row[i] && column[i - 1] < column[i]);
  if (ordered) return Csr(columns, std::move(begins), {column, column + entries}, {data, data + entries});
  // By rows first, each in the order given, then by columns.
  std::vector<std::int32_t> order(entries);
  std::vector<std::int32_t> next(begins.begin(), begins.end() - 1);
  for (std::size_t i = 0; i < entries; ++i) order[next[row[i]]++] = static_cast<std::int32_t>(i);
  const auto before = [column](std::int32_t a, std::int32_t b) { return column[a] < column[b]; };
  std::vector<std::int32_t> starts{0}, indices;
  std::vector<double> sums;
  starts.reserve(rows + 1);
  indices.reserve(entries);
  sums.reserve(entries);
  for (std::size_t r = 0; r < rows; ++r) {
    const auto first = order.begin() + begins[r], last = order.begin() + begins[r + 1];
    if (!std::is_sorted(first, last, before)) std::stable_sort(first, last, before);
    const std::size_t own = indices.size();
    for (auto i = first; i != last; ++i) {
      const auto at = static_cast<std::int32_t>(column[*i]);
      if (indices.size() > own && indices.back() == at) {
        sums.back() += data[*i];
      } else {
        indices.push_back(at);
        sums.push_back(data[*i]);
      }
    }
    starts.push_back(static_cast<std::int32_t>(indices.size()));
  }
  return Csr(columns, std::move(starts), std::move(indices), std::move(sums));
}

Csr Csr::times(const Csr& other) const {
  if (columns_ != other.rows_)
    throw std::invalid_argument("a matrix of " + std::to_string(columns_) + " columns times one of " +
                                std::to_string(other.rows_) + " rows");
  std::vector<std::int32_t> begins{0}, columns, seen(other.columns_, -1), own;
  std::vector<double> values, sum(other.columns_);
  begins.reserve(rows_ + 1);
  for (std::size_t row = 0; row < rows_; ++row) {
    own.clear();
    for (std::int32_t i = starts()[row]; i < starts()[row + 1]; ++i) {
      const std::int32_t inner = indices()[i];
      for (std::int32_t j = other.starts()[inner]; j < other.starts()[inner + 1]; ++j) {
        const std::int32_t column = other.indices()[j];
        if (seen[column] != static_cast<std::int32_t>(row)) {
          seen[column] = static_cast<std::int32_t>(row);
          sum[column] = 0.0;
          own.push_back(column);
        }
        sum[column] += data()[i] * other.data()[j];
      }
    }
    if (!std::is_sorted(own.begin(), own.end())) std::sort(own.begin(), own.end());
    for (const std::int32_t column : own) {
      columns.push_back(column);
      values.push_back(sum[column]);
    }
    begins.push_back(static_cast<std::int32_t>(columns.size()));
  }
  return Csr(other.columns_, std::move(begins), std::move(columns), std::move(values));
}

Csr Csr::resolved(const std::vector<std::int64_t>& variable, std::size_t columns) const {
  if (rows_ != columns_ || variable.size() != rows_)
    throw std::invalid_argument("definitions need a square matrix and a variable for each row");
  enum class State : char { untouched, open, done };
  std::vector<State> state(rows_, State::untouched);
  // Rows of X in the order in which they are found.
  std::vector<std::size_t> begin(rows_), end(rows_);
  std::vector<std::int32_t> found;
  std::vector<double> values, sum(columns);
  std::vector<std::size_t> seen(columns, rows_);
  const auto find = [&](std::size_t row) {
    begin[row] = found.size();
    const auto add = [&](std::size_t column, double value) {
      if (seen[column] != row) {
        seen[column] = row;
        sum[column] = 0.0;
        found.push_back(static_cast<std::int32_t>(column));
      }
      sum[column] += value;
    };
    if (variable[row] >= 0) {
      if (static_cast<std::size_t>(variable[row]) >= columns) throw std::invalid_argument("a variable lies outside");
      add(variable[row], 1.0);
    }
    for (std::int32_t i = starts()[row]; i < starts()[row + 1]; ++i)
      for (std::size_t j = begin[indices()[i]]; j < end[indices()[i]]; ++j) add(found[j], data()[i] * values[j]);
    std::sort(found.begin() + static_cast<std::ptrdiff_t>(begin[row]), found.end());
    std::size_t kept = begin[row];
    for (std::size_t j = begin[row]; j < found.size(); ++j)
      if (sum[found[j]] != 0.0) found[kept++] = found[j];
    found.resize(kept);
    for (std::size_t j = begin[row]; j < kept; ++j) values.push_back(sum[found[j]]);
    end[row] = kept;
    state[row] = State::done;
  };
  std::vector<std::int32_t> begins{0}, order;
  std::vector<double> ordered;
  // A stack of rows, each with its next entry: the rows that its entries name are resolved first. Chains of
  // definitions are as long as the mesh, too long for recursive calls.
  std::vector<std::pair<std::size_t, std::int32_t>> asked;
  const auto ask = [&](std::size_t row) {
    if (state[row] == State::done) return;
    if (state[row] == State::open) throw std::invalid_argument("definitions go round in a circle");
    state[row] = State::open;
    asked.emplace_back(row, starts()[row]);
  };
  for (std::size_t row = 0; row < rows_; ++row) {
    ask(row);
    while (!asked.empty()) {
      auto& [open, next] = asked.back();
      if (next < starts()[open + 1]) {
        ask(indices()[next++]);
      } else {
        find(open);
        asked.pop_back();
      }
    }
  }
  begins.reserve(rows_ + 1);
  order.reserve(found.size());
  ordered.reserve(found.size());
  for (std::size_t row = 0; row < rows_; ++row) {
    order.insert(order.end(), found.begin() + begin[row], found.begin() + end[row]);
    ordered.insert(ordered.end(), values.begin() + begin[row], values.begin() + end[row]);
    begins.push_back(static_cast<std::int32_t>(order.size()));
  }
  return Csr(columns, std::move(begins), std::move(order), std::move(ordered));
}

Csr Csr::pruned() const {
  std::vector<std::int32_t> begins{0}, columns;
  std::vector<double> values;
  begins.reserve(rows_ + 1);
  columns.reserve(entries());
  values.reserve(entries());
  for (std::size_t row = 0; row < rows_; ++row) {
    for (std::int32_t i = starts()[row]; i < starts()[row + 1]; ++i) {
      if (data()[i] == 0.0) continue;
      columns.push_back(indices()[i]);
      values.push_back(data()[i]);
    }
    begins.push_back(static_cast<std::int32_t>(columns.size()));
  }
  return Csr(columns_, std::move(begins), std::move(columns), std::move(values));
}

double Csr::at(std::size_t row, std::size_t column) const {
  double sum = 0.0;
  for (std::int32_t i = starts()[row]; i < starts()[row + 1]; ++i)
    if (static_cast<std::size_t>(indices()[i]) == column) sum += data()[i];
  return sum;
}

}  // namespace robotraj::native
