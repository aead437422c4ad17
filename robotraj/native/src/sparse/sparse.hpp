// Compressed sparse rows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace robotraj::native {

/// A sparse matrix in compressed rows. Its indices are checked once, when it is made; copies share them.
class Csr {
 public:
  Csr() : Csr(0, {0}, {}, {}) {}
  /// Throws std::invalid_argument where the arrays do not describe a rows x columns matrix.
  Csr(std::size_t rows, std::size_t columns, std::vector<std::int32_t> starts, std::vector<std::int32_t> indices,
      std::vector<double> data);
  /// The same for arrays that are known to fit.
  Csr(std::size_t columns, std::vector<std::int32_t> starts, std::vector<std::int32_t> indices,
      std::vector<double> data);

  /// Sums entries (rows[i], columns[i]) in their order; columns ascend in every row.
  /// Throws std::invalid_argument where one lies outside.
  static Csr summed(std::size_t rows, std::size_t columns, std::size_t entries, const std::int64_t* row,
                    const std::int64_t* column, const double* data);

  std::size_t rows() const { return rows_; }
  std::size_t columns() const { return columns_; }
  std::size_t entries() const { return arrays_->data.size(); }
  const std::int32_t* starts() const { return arrays_->starts.data(); }
  const std::int32_t* indices() const { return arrays_->indices.data(); }
  const double* data() const { return arrays_->data.data(); }

  /// y = A x for a single product; see Combination for many.
  void times(const double* x, double* y) const;

  Csr transposed() const;

  /// A B, columns ascending in every row.
  Csr times(const Csr& other) const;

  /// X of X = E + C X for this square C without circles: row i of E is the unit vector variable[i], or zero where that
  /// is negative. Throws std::invalid_argument for circular definitions.
  Csr resolved(const std::vector<std::int64_t>& variable, std::size_t columns) const;

  /// The same without entries that are exactly zero.
  Csr pruned() const;

  /// The entry at (row, column), 0 where there is none.
  double at(std::size_t row, std::size_t column) const;

  /// Whether a row has no entry.
  bool empty(std::size_t row) const { return starts()[row] == starts()[row + 1]; }

 private:
  struct Arrays {
    std::vector<std::int32_t> starts;
    std::vector<std::int32_t> indices;
    std::vector<double> data;
  };

  std::size_t rows_;
  std::size_t columns_;
  std::shared_ptr<const Arrays> arrays_;
};

}  // namespace robotraj::native
