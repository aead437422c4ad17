// Passes over slacks, bounds and multipliers against their formulas, for every kind of processor.
#include <Eigen/Core>

#include <cfloat>
#include <cmath>
#include <limits>
#include <random>

#include "check.hpp"
#include "kernels/packed.hpp"

namespace robotraj::tests {
namespace {

using Eigen::ArrayXd;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Slacks between bounds, of which some have one and some none, with multipliers.
struct Slacks {
  Slacks(int n, const native::VectorKernels& kernels) : run(kernels), size(n) {
    s = numbers();
    const ArrayXd far = sizes(), beyond = sizes();
    lower = (uniform() < 0.7).select(s - far, -kInfinity);
    upper = (uniform() < 0.7).select(s + beyond, kInfinity);
    has_lower = lower.isFinite().cast<double>();
    has_upper = upper.isFinite().cast<double>();
    below = (has_lower > 0).select(s - lower, 1.0);
    above = (has_upper > 0).select(upper - s, 1.0);
    lower_duals = has_lower * sizes();
    upper_duals = has_upper * sizes();
  }

  ArrayXd drawn(const std::function<double()>& next) { return ArrayXd::NullaryExpr(size, next); }
  ArrayXd numbers() {
    return drawn([this] { return normal(random); });
  }
  ArrayXd uniform() {
    return drawn([this] { return unit(random); });
  }
  /// From 1e-6 to 1e3.
  ArrayXd sizes() {
    return drawn([this] { return std::pow(10.0, 9.0 * unit(random) - 6.0); });
  }
  native::Bounds bounds() const { return {lower.data(), upper.data(), size}; }

  const native::VectorKernels& run;
  const int size;
  std::mt19937 random{4};
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit;
  ArrayXd s, lower, upper, has_lower, has_upper, below, above, lower_duals, upper_duals;
};

double largest(const ArrayXd& x) { return x.size() ? x.abs().maxCoeff() : 0.0; }
bool near(double a, double b, double tolerance) { return std::abs(a - b) <= tolerance * (1.0 + std::abs(b)); }
bool near(const ArrayXd& a, const ArrayXd& b, double tolerance) {
  return ((a - b).abs() <= tolerance * (1.0 + b.abs())).all();
}

/// Calls test(slacks) for lengths below a register, of whole registers and with a rest, and every kind of processor.
template <typename Test>
void for_each(Test&& test) {
  for (const native::Kernels* kernels : native::kernels())
    for (const int n : {0, 1, 3, 8, 40, 1203}) {
      Slacks its(n, kernels->vectors);
      test(its);
    }
}

/// The sum of the logarithms of slacks' distances from their bounds.
double logarithm(const native::VectorKernels& run, const ArrayXd& s, const ArrayXd& lower, const ArrayXd& upper) {
  ArrayXd below(s.size()), above(s.size());
  const native::Bounds bounds{lower.data(), upper.data(), static_cast<int>(s.size())};
  const native::DistanceSums sums = run.distances(bounds, s.data(), below.data(), above.data());
  return native::log_sum(sums, bounds, below.data(), above.data());
}

}  // namespace

ROBOTRAJ_TEST(magnitudes_and_sums) {
  for_each([](Slacks& its) {
    const ArrayXd x = its.numbers(), y = its.numbers();
    ArrayXd sum(its.size);
    its.run.add(x.data(), y.data(), its.size, sum.data());
    CHECK((sum == x + y).all());
    CHECK(its.run.largest(x.data(), its.size) == largest(x));
    CHECK(near(its.run.absolute_sum(x.data(), its.size), x.abs().sum(), 1e-13));
    CHECK(its.run.finite(x.data(), its.size));
    for (const double broken : {std::nan(""), kInfinity, -kInfinity})
      for (const int place : {0, its.size / 2, its.size - 1})
        if (its.size > 0) {
          ArrayXd wrong = x;
          wrong[place] = broken;
          CHECK(!its.run.finite(wrong.data(), its.size));
        }
  });
}

ROBOTRAJ_TEST(distances_and_the_sum_of_their_logarithms) {
  for_each([](Slacks& its) {
    ArrayXd below(its.size), above(its.size);
    const auto sums = its.run.distances(its.bounds(), its.s.data(), below.data(), above.data());
    CHECK((below == its.below).all() && (above == its.above).all());
    CHECK(near(native::log_sum(sums, its.bounds(), below.data(), above.data()), (below.log() + above.log()).sum(),
               1e-12));
    const ArrayXd single = below * its.has_lower * (1 - its.has_upper) + above * its.has_upper * (1 - its.has_lower);
    CHECK(near(sums.single, single.sum(), 1e-13));
  });
}

ROBOTRAJ_TEST(sums_of_logarithms_neither_overflow_nor_vanish) {
  for_each([](Slacks& its) {
    const ArrayXd none = ArrayXd::Constant(its.size, kInfinity), zero = ArrayXd::Zero(its.size);
    for (const double distance : {1e-300, 1e300, 5e-324})
      CHECK(near(logarithm(its.run, zero, zero - distance, none), its.size * std::log(distance), 1e-12));
    if (its.size == 0) return;
    CHECK(logarithm(its.run, none, zero, none) == kInfinity);
    for (const int place : {0, its.size - 1}) {
      // A slack at its bound, and one beyond it.
      ArrayXd s = zero + 1.0;
      s[place] = 0.0;
      CHECK(logarithm(its.run, s, zero, none) == -kInfinity);
      s[place] = -1.0;
      CHECK(std::isnan(logarithm(its.run, s, zero, none)));
    }
  });
}

ROBOTRAJ_TEST(gradient_and_slope_of_the_barrier) {
  for_each([](Slacks& its) {
    const double mu = 0.03, damping = 1e-5;
    const ArrayXd ds = its.numbers();
    ArrayXd gradient(its.size);
    its.run.barrier_gradient(its.bounds(), its.below.data(), its.above.data(), mu, damping, gradient.data());
    const ArrayXd expected = its.has_upper * mu / its.above - its.has_lower * mu / its.below +
                             damping * its.has_lower * (1 - its.has_upper) -
                             damping * its.has_upper * (1 - its.has_lower);
    CHECK(near(gradient, expected, 1e-13));
    const double slope =
        its.run.barrier_slope(its.bounds(), its.below.data(), its.above.data(), mu, damping, ds.data());
    CHECK(near(slope, (expected * ds).sum(), 1e-10));
  });
}

ROBOTRAJ_TEST(complementarity) {
  for_each([](Slacks& its) {
    const double mu = 0.1;
    ArrayXd lower(its.size), upper(its.size);
    its.run.complementarity(its.lower.data(), its.lower_duals.data(), its.below.data(), mu, its.size, lower.data());
    its.run.complementarity(its.upper.data(), its.upper_duals.data(), its.above.data(), mu, its.size, upper.data());
    CHECK(near(lower, its.has_lower * (its.lower_duals * its.below - mu), 1e-13));
    CHECK(near(upper, its.has_upper * (its.upper_duals * its.above - mu), 1e-13));
    const double most = its.run.largest_complementarity(its.bounds(), its.lower_duals.data(), its.below.data(),
                                                        its.upper_duals.data(), its.above.data(), mu);
    CHECK(near(most, std::max(largest(lower), largest(upper)), 1e-14));
  });
}

ROBOTRAJ_TEST(steps_to_the_boundary) {
  for_each([](Slacks& its) {
    const double tau = 0.99;
    for (const double scale : {1e-8, 1.0}) {
      const ArrayXd ds = scale * its.numbers(), dl = scale * its.numbers(), du = scale * its.numbers();
      double primal = 1.0, dual = 1.0;
      for (int i = 0; i < its.size; ++i) {
        if (its.has_lower[i] && ds[i] < 0) primal = std::min(primal, tau * its.below[i] / -ds[i]);
        if (its.has_upper[i] && ds[i] > 0) primal = std::min(primal, tau * its.above[i] / ds[i]);
        if (its.has_lower[i] && dl[i] < 0) dual = std::min(dual, tau * its.lower_duals[i] / -dl[i]);
        if (its.has_upper[i] && du[i] < 0) dual = std::min(dual, tau * its.upper_duals[i] / -du[i]);
      }
      CHECK(
          near(its.run.longest_step(its.bounds(), its.below.data(), its.above.data(), ds.data(), tau), primal, 1e-14));
      CHECK(near(its.run.longest_dual_step(its.bounds(), its.lower_duals.data(), dl.data(), its.upper_duals.data(),
                                           du.data(), tau),
                 dual, 1e-14));
    }
  });
}

ROBOTRAJ_TEST(multipliers_are_kept_near_the_central_path) {
  for_each([](Slacks& its) {
    const double mu = 0.02, kappa = 10.0;
    ArrayXd z = its.sizes();
    const ArrayXd expected = its.has_lower * z.max(mu / (kappa * its.below)).min(kappa * mu / its.below);
    its.run.clamp_duals(its.lower.data(), its.below.data(), mu, kappa, its.size, z.data());
    CHECK(near(z, expected, 1e-14));
  });
}

ROBOTRAJ_TEST(slacks_are_eliminated_and_found_again) {
  for_each([](Slacks& its) {
    const int n = its.size;
    const ArrayXd damping = 0.1 + its.uniform(), relaxation = its.uniform(), products = its.numbers();
    const ArrayXd f = its.numbers(), cl = its.numbers(), cu = its.numbers(), g = its.numbers();
    const native::SlackSystem system{its.below.data(),       its.above.data(), its.lower_duals.data(),
                                     its.upper_duals.data(), damping.data(),   relaxation.data()};
    const native::SlackSide side{f.data(), cl.data(), cu.data(), g.data()};
    ArrayXd inverse(n), gradient(n), weights(n), rows(n), s(n), zl(n), zu(n);
    its.run.reduce(system, side, n, inverse.data(), gradient.data(), weights.data(), rows.data());
    // Multipliers that solve A x - weights lam = -rows for A x = products.
    const ArrayXd lam = (products + rows) / weights;
    its.run.recover(system, side, inverse.data(), gradient.data(), lam.data(), n, {s.data(), zl.data(), zu.data()});
    const ArrayXd terms = 1 + lam.abs() + (its.lower_duals * s / its.below).abs() +
                          (its.upper_duals * s / its.above).abs() + (cl / its.below).abs() + (cu / its.above).abs();
    CHECK(largest((damping * s - lam - zl + zu + f) / terms) < 1e-12);
    CHECK(largest((its.lower_duals * s + its.below * zl + cl) / (1 + (its.lower_duals * s).abs())) < 1e-12);
    CHECK(largest((-its.upper_duals * s + its.above * zu + cu) / (1 + (its.upper_duals * s).abs())) < 1e-12);
    CHECK(largest((products - s - relaxation * lam + g) / (1 + s.abs())) < 1e-12);

    // The residuals of any other point.
    s = its.numbers(), zl = its.numbers(), zu = its.numbers();
    ArrayXd first(n), second(n), third(n), changed = rows;
    const double most = its.run.slack_residual(system, side, {s.data(), zl.data(), zu.data()}, lam.data(), n,
                                               {first.data(), second.data(), third.data()}, changed.data());
    CHECK(near(first, f + damping * s - lam - zl + zu, 1e-11));
    CHECK(near(second, cl + its.lower_duals * s + its.below * zl, 1e-11));
    CHECK(near(third, cu - its.upper_duals * s + its.above * zu, 1e-11));
    CHECK(near(changed, rows - s - relaxation * lam, 1e-11));
    CHECK(most == std::max({largest(first), largest(second), largest(third)}));
  });
}

}  // namespace robotraj::tests
