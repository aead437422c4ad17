#include "stage_matrices.hpp"

#include "riccati_solver.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

namespace robotraj::native {

namespace {

/// Rows with more of their entries than this are kept whole: vector products are faster than single ones.
bool is_wide(std::size_t entries, int n) { return entries >= 8 && 3 * entries >= static_cast<std::size_t>(n); }

void need_inside(std::int32_t column, int n, const char* what, const Pattern& pattern, std::size_t entry,
                 std::size_t stage) {
  if (column < 0 || column >= n)
    throw std::invalid_argument(std::string(what) + " entry (" + std::to_string(pattern.rows[entry]) + ", " +
                                std::to_string(pattern.columns[entry]) + ") joins stage " + std::to_string(stage) +
                                " with another");
}

}  // namespace

bool StageMatrices::RowPattern::operator==(const RowPattern& other) const {
  return wide == other.wide && thin == other.thin && starts == other.starts && columns == other.columns;
}

bool StageMatrices::Shape::operator==(const Shape& other) const {
  return nu == other.nu && nx == other.nx && next == other.next && equality_count == other.equality_count &&
         inequality_count == other.inequality_count && dynamics == other.dynamics && equalities == other.equalities &&
         inequalities == other.inequalities;
}

StageMatrices::StageMatrices(const Layout& layout, const Pattern& jacobian, const Pattern& hessian,
                             const RiccatiKernels& run)
    : NewtonMatrices(layout), run_(run) {
  const auto by_rows = [](const Pattern& pattern) {
    for (std::size_t e = 1; e < pattern.size(); ++e)
      if (pattern.rows[e] < pattern.rows[e - 1] ||
          (pattern.rows[e] == pattern.rows[e - 1] && pattern.columns[e] <= pattern.columns[e - 1]))
        return false;
    return true;
  };
  if (!by_rows(jacobian) || !by_rows(hessian))
    throw std::invalid_argument("derivatives of stages come by rows, each from the first column to the last");
  stages_.resize(layout.count());
  jacobian_places.assign(jacobian.size(), -1);
  hessian_places.resize(hessian.size());
  place_jacobian(jacobian);
  place_hessian(hessian);
  constexpr auto most = static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());
  if (std::max(jacobian_size_, hessian_size_) > most)
    throw std::invalid_argument("a program of more than 2^31 derivatives");
  int length = 0;
  for (const Shape& shape : shapes_) length = std::max(length, padded(shape.nu + shape.nx));
  memory_.resize(length);
}

std::unique_ptr<NewtonSolver> StageMatrices::solver() const { return std::make_unique<RiccatiSolver>(*this); }

int StageMatrices::size_of(const RowPattern& rows, int ld) {
  return static_cast<int>(rows.wide.size()) * ld + padded(static_cast<int>(rows.columns.size()));
}

StageMatrices::RowPattern StageMatrices::pattern_of(const std::vector<Entry>& entries, int count, int n,
                                                    std::size_t first) {
  RowPattern rows;
  rows.starts.push_back(0);
  const int ld = padded(n);
  const auto each_row = [&](bool wide, auto&& use) {
    std::size_t begin = 0, end = 0;
    for (std::int32_t row = 0; row < count; ++row, begin = end) {
      while (end < entries.size() && entries[end].row == row) ++end;
      if (is_wide(end - begin, n) == wide) use(row, begin, end);
    }
  };
  each_row(true, [&](std::int32_t row, std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e)
      jacobian_places[entries[e].entry] = static_cast<std::int32_t>(first) + entries[e].column;
    rows.wide.push_back(row);
    first += ld;
  });
  each_row(false, [&](std::int32_t row, std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) {
      jacobian_places[entries[e].entry] = static_cast<std::int32_t>(first++);
      rows.columns.push_back(entries[e].column);
    }
    rows.thin.push_back(row);
    rows.starts.push_back(static_cast<std::int32_t>(rows.columns.size()));
  });
  return rows;
}

void StageMatrices::place_jacobian(const Pattern& pattern) {
  const std::vector<int>* const first_rows[] = {&layout_.first_dynamics, &layout_.first_equality,
                                                &layout_.first_inequality};
  std::size_t next[3];
  for (std::size_t kind = 0; kind < 3; ++kind)
    next[kind] =
        std::lower_bound(pattern.rows.begin(), pattern.rows.end(), first_rows[kind]->front()) - pattern.rows.begin();
  std::vector<Entry> entries;
  for (std::size_t k = 0; k < stages_.size(); ++k) {
    Shape shape{layout_.controls[k],
                layout_.states[k],
                layout_.next_states(k),
                layout_.equalities[k],
                layout_.inequalities[k],
                {},
                {},
                {}};
    const int n = shape.nu + shape.nx, ld = padded(n);
    stages_[k].jacobian = jacobian_size_;
    RowPattern* const patterns[] = {&shape.dynamics, &shape.equalities, &shape.inequalities};
    const int rows[] = {shape.next, shape.equality_count, shape.inequality_count};
    for (std::size_t kind = 0; kind < 3; ++kind) {
      entries.clear();
      const int first = (*first_rows[kind])[k];
      for (std::size_t& e = next[kind]; e < pattern.size() && pattern.rows[e] < first + rows[kind]; ++e) {
        const std::int32_t row = pattern.rows[e] - first, column = pattern.columns[e] - layout_.first_column[k];
        // The -1 of the next state, which the recursion does not read from here.
        if (kind == 0 && pattern.columns[e] == layout_.first_state[k + 1] + row) continue;
        need_inside(column, n, "Jacobian", pattern, e, k);
        entries.push_back({row, column, static_cast<std::int32_t>(e)});
      }
      *patterns[kind] = pattern_of(entries, rows[kind], n, jacobian_size_);
      jacobian_size_ += size_of(*patterns[kind], ld);
    }
    const auto found = std::find(shapes_.rbegin(), shapes_.rend(), shape);
    stages_[k].shape = shapes_.rend() - found - 1;
    if (found == shapes_.rend()) {
      stages_[k].shape = shapes_.size();
      shapes_.push_back(std::move(shape));
    }
  }
}

void StageMatrices::place_hessian(const Pattern& pattern) {
  std::vector<Entry> entries;
  std::size_t e = 0;
  for (std::size_t k = 0; k < stages_.size(); ++k) {
    const int n = layout_.unknowns(k), ld = padded(n);
    const auto first = static_cast<std::int32_t>(layout_.first_column[k]);
    entries.clear();
    for (; e < pattern.size() && pattern.rows[e] < first + n; ++e) {
      const std::int32_t row = pattern.rows[e] - first, column = pattern.columns[e] - first;
      need_inside(column, n, "Hessian", pattern, e, k);
      entries.push_back({std::max(row, column), std::min(row, column), static_cast<std::int32_t>(e)});
    }
    const auto before = [](const Entry& a, const Entry& b) {
      return a.column != b.column ? a.column < b.column : a.row < b.row;
    };
    if (!std::is_sorted(entries.begin(), entries.end(), before)) std::sort(entries.begin(), entries.end(), before);
    stages_[k].hessian = hessian_size_;
    for (const Entry& entry : entries)
      hessian_places[entry.entry] = static_cast<std::int32_t>(hessian_size_) + column_of(entry.column, ld) + entry.row;
    hessian_size_ += trapezoid(n, ld);
  }
}

StageView StageMatrices::view(std::size_t k, const StageValues* jacobian, const StageValues* hessian) const {
  const Stage& stage = stages_[k];
  const Shape& shape = shapes_[stage.shape];
  StageView view{};
  view.nu = shape.nu;
  view.nx = shape.nx;
  view.next = shape.next;
  view.equality_count = shape.equality_count;
  view.inequality_count = shape.inequality_count;
  if (hessian) view.hessian = hessian->data() + stage.hessian;
  if (!jacobian) return view;
  const int ld = padded(shape.nu + shape.nx);
  const double* at = jacobian->data() + stage.jacobian;
  const auto rows = [&](const RowPattern& pattern) {
    RowsView result{static_cast<int>(pattern.wide.size()),
                    static_cast<int>(pattern.thin.size()),
                    pattern.wide.data(),
                    pattern.thin.data(),
                    pattern.starts.data(),
                    pattern.columns.data(),
                    at};
    at += size_of(pattern, ld);
    return result;
  };
  view.dynamics = rows(shape.dynamics);
  view.equalities = rows(shape.equalities);
  view.inequalities = rows(shape.inequalities);
  return view;
}

void StageMatrices::transposed_times(const StageValues& values, const double* lam, const double* y, double* out) const {
  if (y != out) std::copy_n(y, layout_.columns, out);
  for (std::size_t k = 0; k < count(); ++k) {
    const StageView stage = view(k, &values, nullptr);
    const double* dynamics = stage.next ? lam + layout_.first_dynamics[k] : nullptr;
    run_.transposed_times(stage, dynamics, lam + layout_.first_equality[k], lam + layout_.first_inequality[k],
                          out + layout_.first_column[k], memory_.data());
    if (!stage.next) continue;
    double* next = out + layout_.first_state[k + 1];
    for (int i = 0; i < stage.next; ++i) next[i] -= dynamics[i];
  }
}

}  // namespace robotraj::native
