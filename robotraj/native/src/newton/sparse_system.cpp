#include "sparse_system.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace robotraj::native {

namespace {

// Of pivots, beside the largest entry of their column. Diagonals of rows are the regularisation, some 1e-8 and less, which
// this accepts where there is no better pivot: rows are not delayed to larger fronts, and refinement restores the digits.
constexpr double kThreshold = 1e-10;
constexpr double kSmall = 1e-20;  // pivots below it are zero
constexpr int kFew = 12;          // entries of inequalities that are eliminated

std::vector<std::int32_t> in_order(std::size_t count) {
  std::vector<std::int32_t> places(count);
  std::iota(places.begin(), places.end(), 0);
  return places;
}

/// Calls visit(row, first entry, end) for every row of a pattern that is sorted by rows.
template <class Visit>
void each_row(const Pattern& pattern, const Visit& visit) {
  for (std::size_t e = 0; e < pattern.size();) {
    const std::size_t begin = e;
    const std::int32_t row = pattern.rows[e];
    while (e < pattern.size() && pattern.rows[e] == row) ++e;
    visit(row, begin, e);
  }
}

/// Returns sum + a row's product with z, and adds y times the row to `to`. The sum stays in a register.
double multiply_row(const StageValues& values, const Pattern& pattern, std::size_t e, std::size_t end, const double* z,
                    double y, double sum, double* to) {
  for (; e < end; ++e) {
    const std::int32_t column = pattern.columns[e];
    sum += values[e] * z[column];
    to[column] += values[e] * y;
  }
  return sum;
}

/// Collects entries of the lower triangle; the number of an entry is its place once they are sorted.
class Entries {
 public:
  explicit Entries(int n) : n_(n) {}

  /// Returns a number for `places`.
  int add(int row, int column) {
    keys_.push_back({std::max(row, column), std::min(row, column)});
    return static_cast<int>(keys_.size()) - 1;
  }
  ldl::Pattern pattern() {
    // Sorted by rows, then by columns without changing the order of rows.
    const std::vector<int> by_rows = sorted(in_order(keys_.size()), &Key::row);
    const std::vector<int> order = sorted(by_rows, &Key::column);
    ldl::Pattern pattern;
    pattern.n = n_;
    pattern.starts.assign(static_cast<std::size_t>(n_) + 1, 0);
    places_.resize(keys_.size());
    const Key* last = nullptr;
    for (const int number : order) {
      const Key& key = keys_[static_cast<std::size_t>(number)];
      if (!last || last->row != key.row || last->column != key.column) {
        pattern.rows.push_back(key.row);
        ++pattern.starts[static_cast<std::size_t>(key.column) + 1];
      }
      last = &key;
      places_[static_cast<std::size_t>(number)] = static_cast<std::int32_t>(pattern.rows.size()) - 1;
    }
    std::partial_sum(pattern.starts.begin(), pattern.starts.end(), pattern.starts.begin());
    return pattern;
  }
  std::int32_t place(int number) const { return places_[static_cast<std::size_t>(number)]; }

 private:
  struct Key {
    int row, column;
  };
  /// Numbers of keys in ascending order of one of their members; equal ones stay in the given order.
  std::vector<int> sorted(const std::vector<int>& numbers, int Key::*member) const {
    const auto of = [&](int number) {
      return static_cast<std::size_t>(keys_[static_cast<std::size_t>(number)].*member);
    };
    std::vector<std::size_t> next(static_cast<std::size_t>(n_) + 1, 0);
    for (const int number : numbers) ++next[of(number) + 1];
    std::partial_sum(next.begin(), next.end(), next.begin());
    std::vector<int> found(numbers.size());
    for (const int number : numbers) found[next[of(number)]++] = number;
    return found;
  }

  int n_;
  std::vector<Key> keys_;
  std::vector<std::int32_t> places_;
};

}  // namespace

SparseMatrices::SparseMatrices(const Layout& layout, const Pattern& jacobian, const Pattern& hessian,
                               const std::vector<int>& groups)
    : NewtonMatrices(layout), jacobian_(jacobian), hessian_(hessian), groups_(groups) {
  jacobian_places = in_order(jacobian_size_ = jacobian.size());
  hessian_places = in_order(hessian_size_ = hessian.size());
}

std::unique_ptr<NewtonSolver> SparseMatrices::solver() const { return std::make_unique<SparseSolver>(*this); }

void SparseMatrices::transposed_times(const StageValues& values, const double* lam, const double* y,
                                      double* out) const {
  std::copy_n(y, layout_.columns, out);
  for (std::size_t e = 0; e < jacobian_.size(); ++e) out[jacobian_.columns[e]] += values[e] * lam[jacobian_.rows[e]];
}

SparseSolver::SparseSolver(const SparseMatrices& matrices) : matrices_(matrices) {
  const Layout& layout = matrices.layout();
  const Pattern &jacobian = matrices.jacobian(), &hessian = matrices.hessian();
  // Rows of the matrix, -1 for those that are eliminated.
  std::vector<int> row_of(static_cast<std::size_t>(layout.rows), -1);
  int size = layout.columns;
  for (int row = 0; row < layout.inequality_rows; ++row) row_of[static_cast<std::size_t>(row)] = size++;
  auto entry = std::lower_bound(jacobian.rows.begin(), jacobian.rows.end(), layout.inequality_rows);
  for (int i = 0; i < layout.slacks; ++i) {
    const int row = layout.inequality_rows + i;
    const auto end = std::upper_bound(entry, jacobian.rows.end(), row);
    if (end - entry > kFew) {
      row_of[static_cast<std::size_t>(row)] = size++;
      kept_.push_back(i);
    } else {
      const auto at = [&](auto place) { return static_cast<std::size_t>(place - jacobian.rows.begin()); };
      eliminated_.push_back({i, at(entry), at(end)});
    }
    entry = end;
  }
  Entries entries(size);
  for (int k = 0; k < size; ++k) diagonal_.push_back(entries.add(k, k));
  for (std::size_t e = 0; e < hessian.size(); ++e)
    of_hessian_.push_back(entries.add(hessian.rows[e], hessian.columns[e]));
  for (std::size_t e = 0; e < jacobian.size(); ++e) {
    const int row = row_of[static_cast<std::size_t>(jacobian.rows[e])];
    of_jacobian_.push_back(row < 0 ? -1 : entries.add(row, jacobian.columns[e]));
  }
  for (const Eliminated& each : eliminated_)
    for (std::size_t e = each.begin; e < each.end; ++e)
      for (std::size_t other = each.begin; other <= e; ++other)
        products_.push_back(entries.add(jacobian.columns[e], jacobian.columns[other]));
  std::vector<int> groups;
  const std::vector<int>& given = matrices.groups();
  for (auto numbers = given.begin(); numbers != given.end(); numbers += layout.columns + layout.rows) {
    const std::size_t begin = groups.size();
    groups.insert(groups.end(), numbers, numbers + layout.columns);
    groups.resize(begin + static_cast<std::size_t>(size));
    for (int row = 0; row < layout.rows; ++row)
      if (const int at = row_of[static_cast<std::size_t>(row)]; at >= 0)
        groups[begin + static_cast<std::size_t>(at)] = numbers[layout.columns + row];
  }
  factors_ = std::make_unique<ldl::Factors>(entries.pattern(), groups);
  for (auto* places : {&diagonal_, &of_hessian_, &of_jacobian_, &products_})
    for (std::int32_t& place : *places)
      place = place < 0 ? -1 : factors_->tree().place_of[static_cast<std::size_t>(entries.place(place))];
  values_.resize(factors_->pattern().rows.size());
  right_.resize(static_cast<std::size_t>(size));
}

Pivots SparseSolver::factorise_and_solve(const StageValues& jacobian, const StageValues& hessian,
                                         const NewtonSystem& system, Along*) {
  const Layout& layout = matrices_.layout();
  const auto value = [this](std::int32_t place) -> double& { return values_[static_cast<std::size_t>(place)]; };
  std::fill(values_.begin(), values_.end(), 0.0);
  for (std::size_t e = 0; e < of_hessian_.size(); ++e) value(of_hessian_[e]) += hessian[e];
  for (std::size_t e = 0; e < of_jacobian_.size(); ++e)
    if (of_jacobian_[e] >= 0) value(of_jacobian_[e]) += jacobian[e];
  const std::int32_t* diagonal = diagonal_.data();
  for (int i = 0; i < layout.columns; ++i) value(*diagonal++) += system.dx[i];
  for (int i = 0; i < layout.inequality_rows; ++i) value(*diagonal++) -= system.de ? system.de[i] : 0.0;
  for (const int i : kept_) value(*diagonal++) -= system.ds[i];
  const std::int32_t* product = products_.data();
  for (const Eliminated& each : eliminated_)
    for (std::size_t e = each.begin; e < each.end; ++e) {
      const double scaled = jacobian[e] / system.ds[each.row];
      for (std::size_t other = each.begin; other <= e; ++other) value(*product++) += scaled * jacobian[other];
    }
  const ldl::Inertia inertia = factors_->factorise(values_.data(), kThreshold, kSmall);
  const int rows = layout.inequality_rows + static_cast<int>(kept_.size());
  if (inertia.zero > 0 || inertia.negative < rows) return Pivots::dependent;
  if (inertia.negative > rows) return Pivots::indefinite;
  solve(jacobian, system);
  return Pivots::good;
}

void SparseSolver::solve(const StageValues& jacobian, const NewtonSystem& system) {
  const Layout& layout = matrices_.layout();
  double* to = right_.data();
  for (int i = 0; i < layout.columns; ++i) *to++ = -system.f[i];
  for (int i = 0; i < layout.inequality_rows; ++i) *to++ = -system.g[i];
  for (const int i : kept_) *to++ = -system.inequalities[i];
  const std::vector<std::int32_t>& columns = matrices_.jacobian().columns;
  for (const Eliminated& each : eliminated_)
    for (std::size_t e = each.begin; e < each.end; ++e)
      right_[static_cast<std::size_t>(columns[e])] -= jacobian[e] * system.inequalities[each.row] / system.ds[each.row];
  factors_->solve(right_.data());
  const double* from = right_.data();
  std::copy_n(from, layout.columns, system.z);
  from += layout.columns;
  std::copy_n(from, layout.inequality_rows, system.lam);
  from += layout.inequality_rows;
  double* lam = system.lam + layout.inequality_rows;
  for (const int i : kept_) lam[i] = *from++;
  for (const Eliminated& each : eliminated_) {
    double product = 0.0;
    for (std::size_t e = each.begin; e < each.end; ++e) product += jacobian[e] * system.z[columns[e]];
    lam[each.row] = (product + system.inequalities[each.row]) / system.ds[each.row];
  }
}

double SparseSolver::residual(const StageValues& jacobian, const StageValues& hessian, const NewtonSystem& system,
                              std::size_t, std::size_t, StageResidual left) {
  const Layout& layout = matrices_.layout();
  const Pattern &of_rows = matrices_.jacobian(), &of_columns = matrices_.hessian();
  for (int i = 0; i < layout.columns; ++i) left.gradient[i] = system.f[i] + system.dx[i] * system.z[i];
  for (int i = 0; i < layout.inequality_rows; ++i)
    left.equalities[i] = system.g[i] - (system.de ? system.de[i] * system.lam[i] : 0.0);
  std::copy_n(system.inequalities, layout.slacks, left.inequalities);
  each_row(of_columns, [&](std::int32_t i, std::size_t e, std::size_t end) {
    double sum = left.gradient[i];
    if (of_columns.columns[e] == i) sum += hessian[e] * system.z[i], ++e;
    sum = multiply_row(hessian, of_columns, e, end, system.z, system.z[i], sum, left.gradient);
    left.gradient[i] = sum;
  });
  each_row(of_rows, [&](std::int32_t row, std::size_t e, std::size_t end) {
    double& of_row =
        row < layout.inequality_rows ? left.equalities[row] : left.inequalities[row - layout.inequality_rows];
    of_row = multiply_row(jacobian, of_rows, e, end, system.z, system.lam[row], of_row, left.gradient);
  });
  double most = 0.0;
  for (int i = 0; i < layout.columns; ++i) most = std::max(most, std::abs(left.gradient[i]));
  for (int i = 0; i < layout.inequality_rows; ++i) most = std::max(most, std::abs(left.equalities[i]));
  return most;
}

}  // namespace robotraj::native
