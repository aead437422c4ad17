#include "check.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <numeric>
#include <utility>

namespace robotraj::tests {
namespace {

using native::Csr;
using native::ThreadPool;

std::vector<std::pair<const char*, Test>>& all() {
  static std::vector<std::pair<const char*, Test>> tests;
  return tests;
}
int failures = 0;

/// y = (objective, product, |x|^2), derivatives dense.
class Functions final : public native::PointBlock {
 public:
  explicit Functions(bool saturates) : PointBlock({1, 4, 0, 3, 12, 10, 0}), saturates_(saturates) {}
  void prepare(std::size_t) override {}
  void evaluate(native::Evaluation which, const double* v, const double*, const double* m, double* out,
                ThreadPool&) override {
    using native::Evaluation;
    double y[3];
    switch (which) {
      case Evaluation::values: return values(v, out);
      case Evaluation::jacobian: return jacobian(v, out);
      case Evaluation::cost:
        values(v, y);
        *out = y[0];
        return;
      case Evaluation::gradient: return gradient(v, out);
      case Evaluation::hessian: return hessian(v, m, out);
      case Evaluation::convex_hessian: {
        const double without_negative[] = {std::max(0.0, m[0]), m[1], m[2]};
        return hessian(v, without_negative, out);
      }
    }
  }
  bool saturates() const override { return saturates_; }

 private:
  static void values(const double* v, double* y) {
    y[0] = v[0] * v[3] * (v[0] + v[1] + v[2]) + v[2];
    y[1] = v[0] * v[1] * v[2] * v[3];
    y[2] = v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3];
  }
  static void jacobian(const double* v, double* nonzeros) {
    gradient(v, nonzeros);
    for (int j = 0; j < 4; ++j) {
      nonzeros[4 + j] = 1.0;
      for (int k = 0; k < 4; ++k) nonzeros[4 + j] *= k == j ? 1.0 : v[k];
      nonzeros[8 + j] = 2.0 * v[j];
    }
  }
  static void gradient(const double* v, double* gradient) {
    gradient[0] = v[3] * (2.0 * v[0] + v[1] + v[2]);
    gradient[1] = v[0] * v[3];
    gradient[2] = v[0] * v[3] + 1.0;
    gradient[3] = v[0] * (v[0] + v[1] + v[2]);
  }
  static void hessian(const double* v, const double* m, double* nonzeros) {
    const double objective[] = {2.0 * v[3], v[3], v[3], 2.0 * v[0] + v[1] + v[2], 0.0, 0.0, v[0], 0.0, v[0], 0.0};
    for (int i = 0, e = 0; i < 4; ++i)
      for (int j = i; j < 4; ++j, ++e) {
        double product = i == j ? 0.0 : 1.0;
        for (int k = 0; k < 4; ++k) product *= k == i || k == j ? 1.0 : v[k];
        nonzeros[e] = m[0] * objective[e] + m[1] * product + (i == j ? 2.0 * m[2] : 0.0);
      }
  }

  bool saturates_;
};

/// Ones at (row[i], column[i]).
Csr ones(std::size_t rows, std::size_t columns, const std::vector<std::int64_t>& row,
         const std::vector<std::int64_t>& column) {
  const std::vector<double> data(row.size(), 1.0);
  return Csr::summed(rows, columns, row.size(), row.data(), column.data(), data.data());
}

Csr identity(std::size_t n) {
  std::vector<std::int64_t> each(n);
  std::iota(each.begin(), each.end(), 0);
  return ones(n, n, each, each);
}

}  // namespace

const std::vector<double> its_lower = {25.0, 1.0, 1.0, 1.0, 1.0};
const std::vector<double> its_upper = {std::numeric_limits<double>::infinity(), 5.0, 5.0, 5.0, 5.0};
const std::vector<double> its_start = {1.0, 5.0, 5.0, 1.0};

native::Stages its_stages() { return {{4}, {0}, {1}, {5}}; }

std::shared_ptr<native::Program> hock_schittkowski_71(bool saturates) {
  native::LinearPart linear;
  linear.rows = ones(6, 4, {2, 3, 4, 5}, {0, 1, 2, 3});
  linear.offset = {-40.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  linear.cost.assign(4, 0.0);
  linear.jacobian = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1};
  native::Pattern jacobian, hessian;
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 4; ++column)
      if (row < 2 || column == row - 2) jacobian.add(row, column);
  for (int i = 0; i < 4; ++i)
    for (int j = i; j < 4; ++j) hessian.add(i, j);
  native::Term term;
  term.block = std::make_shared<Functions>(saturates);
  term.gather = term.gradient = identity(4);
  term.gather_offset.assign(4, 0.0);
  term.scatter = ones(6, 3, {0, 1}, {2, 1});
  term.weights = {1.0};
  term.jacobian = ones(12, 12, {0, 1, 2, 3, 4, 5, 6, 7}, {8, 9, 10, 11, 4, 5, 6, 7});
  term.hessian = native::Stacked(identity(10));
  return std::make_shared<native::Program>(std::move(linear), std::move(jacobian), std::move(hessian),
                                           std::vector<native::Term>{std::move(term)}, 2);
}

Started::Started(std::vector<double> x, double mu, double objective_scale, bool saturates)
    : layout(its_stages()),
      problem(hock_schittkowski_71(saturates), layout),
      algorithm(problem, options, progress),
      run(algorithm.run) {
  problem.lower = its_lower;
  problem.upper = its_upper;
  problem.objective_scale = objective_scale;
  problem.bounds_changed();
  run.set_barrier(mu);
  interior_point::start_cold(run, x.data());
}

double slope(const std::function<double(const std::vector<double>&)>& function, const std::vector<double>& x,
             const std::vector<double>& step) {
  constexpr double h = 1e-6;
  std::vector<double> ahead = x, behind = x;
  for (std::size_t i = 0; i < x.size(); ++i) {
    ahead[i] += h * step[i];
    behind[i] -= h * step[i];
  }
  return (function(ahead) - function(behind)) / (2.0 * h);
}

Named::Named(const char* name, Test test) { all().emplace_back(name, test); }

void check(bool holds, const char* what, const char* file, int line) {
  if (holds) return;
  std::printf("%s:%d: %s does not hold\n", file, line, what);
  ++failures;
}

}  // namespace robotraj::tests

int main() {
  for (const auto& [name, test] : robotraj::tests::all()) {
    std::printf("%s\n", name);
    test();
  }
  std::printf("%zu tests, %d failures\n", robotraj::tests::all().size(), robotraj::tests::failures);
  return robotraj::tests::failures > 0;
}
