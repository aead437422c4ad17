// Rows of a sparse matrix whose entries are sums of the chain rule's products.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "sparse/sparse.hpp"

namespace robotraj::native {

/// One product of the chain rule: factor times nonzero `source`, at the local number `at` of its entry.
struct ChainProduct {
  std::int32_t at;
  std::int32_t source;
  double factor;
};

/// Compressed rows written one group of rows after the other.
class ProductRows {
 public:
  explicit ProductRows(std::size_t columns) : columns_(columns) {}

  /// Appends `many` rows made of products in any order; those of one row and source are added up.
  void append(const std::vector<ChainProduct>& products, std::size_t many) {
    next_.assign(many + 1, 0);
    for (const ChainProduct& product : products) ++next_[product.at + 1];
    for (std::size_t row = 0; row < many; ++row) next_[row + 1] += next_[row];
    sorted_.resize(products.size());
    begin_.assign(next_.begin(), next_.end());
    for (const ChainProduct& product : products) sorted_[begin_[product.at]++] = product;
    const auto by_source = [](const ChainProduct& a, const ChainProduct& b) { return a.source < b.source; };
    for (std::size_t row = 0; row < many; ++row) {
      const auto first = sorted_.begin() + next_[row], last = sorted_.begin() + next_[row + 1];
      if (!std::is_sorted(first, last, by_source)) std::stable_sort(first, last, by_source);
    }
    append_sorted(sorted_, many);
  }

  /// The same for products that ascend by row and source.
  void append_sorted(const std::vector<ChainProduct>& products, std::size_t many) {
    // Memory for all, released at the end.
    const std::size_t before = indices_.size();
    indices_.resize(before + products.size());
    data_.resize(before + products.size());
    std::int32_t* index = indices_.data() + before;
    double* value = data_.data() + before;
    auto product = products.begin();
    for (std::size_t row = 0; row < many; ++row) {
      std::int32_t known = -1;
      for (; product != products.end() && static_cast<std::size_t>(product->at) == row; ++product) {
        if (product->source == known) {
          *(value - 1) += product->factor;
        } else {
          known = *index++ = product->source;
          *value++ = product->factor;
        }
      }
      starts_.push_back(static_cast<std::int32_t>(index - indices_.data()));
    }
    indices_.resize(starts_.back());
    data_.resize(indices_.size());
  }

  Csr matrix() { return Csr(columns_, std::move(starts_), std::move(indices_), std::move(data_)); }

 private:
  std::size_t columns_;
  std::vector<std::int32_t> starts_{0}, indices_;
  std::vector<double> data_;
  std::vector<std::int32_t> next_, begin_;
  std::vector<ChainProduct> sorted_;
};

}  // namespace robotraj::native
