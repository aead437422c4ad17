#include "stage_matrices.hpp"

#include "riccati_solver.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace robotraj::native {

namespace {

/// Rows with more of their entries than this are kept whole: vector products are faster than single ones.
bool is_wide(std::size_t entries, int n) { return entries >= 8 && 3 * entries >= static_cast<std::size_t>(n); }

void scale(double alpha, const double* y, int count, double* out) {
  if (alpha == 1.0 && y == out) return;
  for (int i = 0; i < count; ++i) out[i] = alpha * y[i];
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
    : NewtonMatrices(layout), run_(run), jacobian_entries_(jacobian.size()), hessian_entries_(hessian.size()) {
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
  place_jacobian(jacobian);
  place_hessian(hessian);
  constexpr auto most = static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());
  if (std::max(jacobian_size_, hessian_size_) > most)
    throw std::invalid_argument("a program of more than 2^31 derivatives");
  int length = kBlock;
  for (const Shape& shape : shapes_)
    length = std::max({length, padded(shape.nu + shape.nx), shape.next, shape.equality_count, shape.inequality_count});
  memory_.resize(2 * static_cast<std::size_t>(padded(length)));
}

std::unique_ptr<NewtonSolver> StageMatrices::solver() const { return std::make_unique<RiccatiSolver>(*this); }

void StageMatrices::append(Runs& runs, std::size_t place, std::int32_t entry) {
  const auto at = static_cast<std::int32_t>(place);
  if (!runs.empty() && runs.back().place + runs.back().count == at && runs.back().entry + runs.back().count == entry)
    ++runs.back().count;
  else runs.push_back({at, entry, 1});
}

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
      append(jacobian_runs_, first + static_cast<std::size_t>(entries[e].column), entries[e].entry);
    rows.wide.push_back(row);
    first += static_cast<std::size_t>(ld);
  });
  each_row(false, [&](std::int32_t row, std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) {
      append(jacobian_runs_, first++, entries[e].entry);
      rows.columns.push_back(entries[e].column);
    }
    rows.thin.push_back(row);
    rows.starts.push_back(static_cast<std::int32_t>(rows.columns.size()));
  });
  return rows;
}

void StageMatrices::place_jacobian(const Pattern& pattern) {
  const std::size_t count = stages_.size();
  // Rows are [dynamics, equalities, inequalities], each stage after stage; where those of each kind and stage begin.
  std::array<std::vector<std::int32_t>, 3> first_row;
  std::int32_t row = 0;
  for (std::size_t kind = 0; kind < 3; ++kind)
    for (std::size_t k = 0; k < count; ++k) {
      first_row[kind].push_back(row);
      row += kind == 0   ? (k + 1 < count ? layout_.states[k + 1] : 0)
             : kind == 1 ? layout_.equalities[k]
                         : layout_.inequalities[k];
    }
  const auto begin_of = [&](std::int32_t first) {
    return static_cast<std::size_t>(std::lower_bound(pattern.rows.begin(), pattern.rows.end(), first) -
                                    pattern.rows.begin());
  };
  std::array<std::size_t, 3> next;
  for (std::size_t kind = 0; kind < 3; ++kind)
    next[kind] = begin_of(first_row[kind].empty() ? row : first_row[kind][0]);
  std::vector<Entry> entries;
  for (std::size_t k = 0; k < count; ++k) {
    Shape shape;
    shape.nu = layout_.controls[k];
    shape.nx = layout_.states[k];
    shape.next = k + 1 < count ? layout_.states[k + 1] : 0;
    shape.equality_count = layout_.equalities[k];
    shape.inequality_count = layout_.inequalities[k];
    const int n = shape.nu + shape.nx, ld = padded(n);
    const auto first_column = static_cast<std::int32_t>(layout_.first_column[k]);
    stages_[k].jacobian = jacobian_size_;
    std::size_t at = jacobian_size_;
    RowPattern* const patterns[] = {&shape.dynamics, &shape.equalities, &shape.inequalities};
    const int rows[] = {shape.next, shape.equality_count, shape.inequality_count};
    for (std::size_t kind = 0; kind < 3; ++kind) {
      entries.clear();
      std::size_t& e = next[kind];
      for (; e < pattern.size() && pattern.rows[e] < first_row[kind][k] + rows[kind]; ++e) {
        const std::int32_t column = pattern.columns[e] - first_column;
        // The other entries of the stage are the -1 of the next state, which the recursion does not read from here.
        if (column >= n) continue;
        entries.push_back({pattern.rows[e] - first_row[kind][k], column, static_cast<std::int32_t>(e)});
      }
      *patterns[kind] = pattern_of(entries, rows[kind], n, at);
      at += static_cast<std::size_t>(size_of(*patterns[kind], ld));
    }
    jacobian_size_ = at;
    const auto found = std::find(shapes_.rbegin(), shapes_.rend(), shape);
    stages_[k].shape = static_cast<std::size_t>(shapes_.rend() - found) - 1;
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
      entries.push_back({std::max(row, column), std::min(row, column), static_cast<std::int32_t>(e)});
    }
    const auto before = [](const Entry& a, const Entry& b) {
      return a.column != b.column ? a.column < b.column : a.row < b.row;
    };
    if (!std::is_sorted(entries.begin(), entries.end(), before)) std::sort(entries.begin(), entries.end(), before);
    stages_[k].hessian = hessian_size_;
    for (const Entry& entry : entries)
      append(hessian_runs_, hessian_size_ + static_cast<std::size_t>(column_of(entry.column, ld) + entry.row),
             entry.entry);
    hessian_size_ += static_cast<std::size_t>(trapezoid(n, ld));
  }
}

void StageMatrices::fill(const Numbers& entries, const Runs& runs, StageValues& values) {
  for (const Run& run : runs) std::copy_n(entries.data() + run.entry, run.count, values.data() + run.place);
}

std::vector<std::int32_t> StageMatrices::places(std::size_t entries, const Runs& runs) {
  std::vector<std::int32_t> places(entries, -1);
  for (const Run& run : runs) std::iota(places.begin() + run.entry, places.begin() + run.entry + run.count, run.place);
  return places;
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

void StageMatrices::jacobian_times(const StageValues& values, const double* x, double alpha, const double* y,
                                   double* out) const {
  scale(alpha, y, layout_.rows, out);
  for (std::size_t k = 0; k < count(); ++k) {
    const StageView stage = view(k, &values, nullptr);
    const int n = stage.nu + stage.nx;
    const double* z = x + layout_.first_column[k];
    if (stage.next) {
      double* dynamics = out + layout_.first_dynamics[k];
      const double* next = x + layout_.first_state[k + 1];
      for (int i = 0; i < stage.next; ++i) dynamics[i] -= next[i];
      run_.rows_times(stage.dynamics, stage.next, n, z, dynamics, memory_.data());
    }
    run_.rows_times(stage.equalities, stage.equality_count, n, z, out + layout_.first_equality[k], memory_.data());
    run_.rows_times(stage.inequalities, stage.inequality_count, n, z, out + layout_.first_inequality[k],
                    memory_.data());
  }
}

void StageMatrices::transposed_times(const StageValues& values, const double* lam, double alpha, const double* y,
                                     double* out) const {
  scale(alpha, y, layout_.columns, out);
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

void StageMatrices::hessian_times(const StageValues& values, const double* x, double alpha, const double* y,
                                  double* out) const {
  scale(alpha, y, layout_.columns, out);
  for (std::size_t k = 0; k < count(); ++k) {
    const auto first = layout_.first_column[k];
    run_.hessian_times(values.data() + stages_[k].hessian, layout_.unknowns(k), x + first, out + first, memory_.data());
  }
}

}  // namespace robotraj::native
