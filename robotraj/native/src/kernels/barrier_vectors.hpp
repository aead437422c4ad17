// Passes over slacks, bounds and multipliers, for one kind of processor.
#pragma once

#include "riccati/stage_vectors.hpp"
#include "vector_kernels.hpp"

namespace robotraj::native {
namespace {

constexpr double kInfinity = __builtin_inf();

/// A whole pack of every vector.
struct Whole {
  int first;
  Pack of(const double* x, double) const { return load(x + first); }
  void put(double* x, Pack value) const { store(x + first, value); }
};

/// The last numbers; `rest` stands for those that are missing.
struct Part {
  int first, count;
  Pack of(const double* x, double rest) const {
    Pack value = Pack{} + rest;
    for (int i = 0; i < count; ++i) value[i] = x[first + i];
    return value;
  }
  void put(double* x, Pack value) const {
    for (int i = 0; i < count; ++i) x[first + i] = value[i];
  }
};

template <typename Body>
ROBOTRAJ_INLINE void each_pack(int n, const Body& body) {
  int i = 0;
  for (; i + kStep <= n; i += kStep) body(Whole{i});
  if (i < n) body(Part{i, n - i});
}

/// With exchanged arguments these would ignore NaN in `x`.
ROBOTRAJ_INLINE Pack larger(Pack x, Pack than) { return x > than ? x : than; }
ROBOTRAJ_INLINE Pack smaller(Pack x, Pack than) { return x < than ? x : than; }
ROBOTRAJ_INLINE auto bounded(Pack bound) { return magnitudes(bound) != Pack{} + kInfinity; }

ROBOTRAJ_INLINE double least(Pack x) {
  double result = x[0];
  for (int i = 1; i < kStep; ++i) result = x[i] < result ? x[i] : result;
  return result;
}

double largest(const double* x, int n) {
  Pack result{};
  each_pack(n, [&](auto at) { result = larger(magnitudes(at.of(x, 0.0)), result); });
  return greatest(result);
}

double absolute_sum(const double* x, int n) {
  Pack sum{};
  each_pack(n, [&](auto at) { sum += magnitudes(at.of(x, 0.0)); });
  return across(sum);
}

bool finite(const double* x, int n) {
  Pack nothing{};
  each_pack(n, [&](auto at) { nothing += at.of(x, 0.0) * 0.0; });  // NaN of what is not finite
  return across(nothing) == 0.0;
}

void add_vectors(const double* x, const double* y, int n, double* out) {
  each_pack(n, [&](auto at) { at.put(out, at.of(x, 0.0) + at.of(y, 0.0)); });
}

/// A product of many numbers: powers of two are counted, so that it neither overflows nor vanishes.
struct LongProduct {
  Pack mantissa = Pack{} + 1.0;
  Bits exponent{};
  int factors = 0;
  void take(Pack x) {
    const Bits bits = reinterpret_cast<Bits>(x);
    exponent += bits >> 52;
    mantissa *= reinterpret_cast<Pack>((bits & ((1ull << 52) - 1)) | (1023ull << 52));
    // Mantissas are below 2.
    if (++factors < 512) return;
    settle();
  }
  void settle() {
    const Bits bits = reinterpret_cast<Bits>(mantissa);
    exponent += (bits >> 52) - 1023;
    mantissa = reinterpret_cast<Pack>((bits & ((1ull << 52) - 1)) | (1023ull << 52));
    factors = 0;
  }
};

DistanceSums distances(const Bounds& bounds, const double* s, double* below, double* above) {
  const Pack one = Pack{} + 1.0, tiniest = Pack{} + __DBL_MIN__, most = Pack{} + __DBL_MAX__;
  LongProduct product;
  Pack single{};
  Bits good = ~Bits{};
  std::uint64_t taken = 0;
  each_pack(bounds.count, [&](auto at) {
    const Pack slack = at.of(s, 0.0), lower = at.of(bounds.lower, kInfinity), upper = at.of(bounds.upper, kInfinity);
    const auto has_lower = bounded(lower), has_upper = bounded(upper);
    const Pack under = has_lower ? slack - lower : one, over = has_upper ? upper - slack : one;
    at.put(below, under);
    at.put(above, over);
    single += (has_lower & ~has_upper) ? under : (has_upper & ~has_lower) ? over : Pack{};
    good &= reinterpret_cast<Bits>((under >= tiniest) & (under <= most) & (over >= tiniest) & (over <= most));
    product.take(under);
    product.take(over);
    taken += 2;
  });
  product.settle();
  DistanceSums sums{1.0, 0.0, across(single), true};
  std::uint64_t exponents = 0;
  for (int i = 0; i < kStep; ++i) {
    if (good[i] != ~0ull) sums.regular = false;
    sums.mantissa *= product.mantissa[i];
    exponents += product.exponent[i];
  }
  // Every exponent has been counted from 1023 on.
  sums.exponent = static_cast<double>(static_cast<std::int64_t>(exponents - 1023 * taken * kStep));
  return sums;
}

template <typename At>
ROBOTRAJ_INLINE Pack barrier_gradient_at(At at, const Bounds& bounds, const double* below, const double* above,
                                         double mu, double damping) {
  const auto has_lower = bounded(at.of(bounds.lower, kInfinity)), has_upper = bounded(at.of(bounds.upper, kInfinity));
  const Pack nothing{}, kept = nothing + damping;
  const Pack under = has_lower ? -mu / at.of(below, 1.0) : nothing, over = has_upper ? mu / at.of(above, 1.0) : nothing;
  return under + over + ((has_lower & ~has_upper) ? kept : (has_upper & ~has_lower) ? -kept : nothing);
}

void barrier_gradient(const Bounds& bounds, const double* below, const double* above, double mu, double damping,
                      double* out) {
  each_pack(bounds.count, [&](auto at) { at.put(out, barrier_gradient_at(at, bounds, below, above, mu, damping)); });
}

double barrier_slope(const Bounds& bounds, const double* below, const double* above, double mu, double damping,
                     const double* ds) {
  Pack sum{};
  each_pack(bounds.count,
            [&](auto at) { sum += barrier_gradient_at(at, bounds, below, above, mu, damping) * at.of(ds, 0.0); });
  return across(sum);
}

void complementarity(const double* bound, const double* z, const double* distance, double mu, int n, double* out) {
  each_pack(n, [&](auto at) {
    at.put(out, bounded(at.of(bound, kInfinity)) ? at.of(z, 0.0) * at.of(distance, 1.0) - mu : Pack{});
  });
}

double largest_complementarity(const Bounds& bounds, const double* lower_duals, const double* below,
                               const double* upper_duals, const double* above, double mu) {
  const Pack nothing{};
  Pack result{};
  each_pack(bounds.count, [&](auto at) {
    const Pack under = at.of(lower_duals, 0.0) * at.of(below, 1.0) - mu;
    const Pack over = at.of(upper_duals, 0.0) * at.of(above, 1.0) - mu;
    result = larger(bounded(at.of(bounds.lower, kInfinity)) ? magnitudes(under) : nothing, result);
    result = larger(bounded(at.of(bounds.upper, kInfinity)) ? magnitudes(over) : nothing, result);
  });
  return greatest(result);
}

double longest_step(const Bounds& bounds, const double* below, const double* above, const double* ds, double tau) {
  const Pack one = Pack{} + 1.0;
  Pack result = one;
  each_pack(bounds.count, [&](auto at) {
    const Pack step = at.of(ds, 0.0), nothing{};
    const auto down = step<nothing, up = step> nothing;
    const auto meets =
        (down & bounded(at.of(bounds.lower, kInfinity))) | (up & bounded(at.of(bounds.upper, kInfinity)));
    const Pack room = down ? at.of(below, 1.0) : at.of(above, 1.0);
    result = smaller(meets ? tau * room / magnitudes(step) : one, result);
  });
  return least(result);
}

double longest_dual_step(const Bounds& bounds, const double* lower_duals, const double* lower_step,
                         const double* upper_duals, const double* upper_step, double tau) {
  const Pack one = Pack{} + 1.0;
  Pack result = one;
  const auto side = [&](auto at, const double* bound, const double* z, const double* dz) {
    const Pack step = at.of(dz, 0.0);
    const auto meets = (step < Pack{}) & bounded(at.of(bound, kInfinity));
    result = smaller(meets ? -tau * at.of(z, 1.0) / step : one, result);
  };
  each_pack(bounds.count, [&](auto at) {
    side(at, bounds.lower, lower_duals, lower_step);
    side(at, bounds.upper, upper_duals, upper_step);
  });
  return least(result);
}

void clamp_duals(const double* bound, const double* distance, double mu, double kappa, int n, double* z) {
  const double high = kappa * mu, low = mu / kappa;
  each_pack(n, [&](auto at) {
    const Pack inverse = 1.0 / at.of(distance, 1.0);
    const Pack kept = larger(low * inverse, smaller(high * inverse, at.of(z, 0.0)));
    at.put(z, bounded(at.of(bound, kInfinity)) ? kept : Pack{});
  });
}

void reduce(const SlackSystem& system, const SlackSide& side, int n, double* inverse, double* gradient, double* weights,
            double* rows) {
  each_pack(n, [&](auto at) {
    const Pack below = 1.0 / at.of(system.below, 1.0), above = 1.0 / at.of(system.above, 1.0);
    const Pack sigma =
        at.of(system.damping, 1.0) + below * at.of(system.lower_duals, 0.0) + above * at.of(system.upper_duals, 0.0);
    const Pack slope = at.of(side.s, 0.0) + below * at.of(side.lower, 0.0) - above * at.of(side.upper, 0.0);
    const Pack weight = 1.0 / sigma;
    at.put(inverse, weight);
    at.put(gradient, slope);
    at.put(weights, weight + at.of(system.relaxation, 0.0));
    at.put(rows, at.of(side.rows, 0.0) + weight * slope);
  });
}

void recover(const SlackSystem& system, const SlackSide& side, const double* inverse, const double* gradient,
             const double* lam, int n, const SlackStep& step) {
  each_pack(n, [&](auto at) {
    const Pack s = at.of(inverse, 0.0) * (at.of(lam, 0.0) - at.of(gradient, 0.0));
    at.put(step.s, s);
    at.put(step.lower, (-at.of(side.lower, 0.0) - at.of(system.lower_duals, 0.0) * s) / at.of(system.below, 1.0));
    at.put(step.upper, (at.of(system.upper_duals, 0.0) * s - at.of(side.upper, 0.0)) / at.of(system.above, 1.0));
  });
}

double slack_residual(const SlackSystem& system, const SlackSide& side, const SlackStep& step, const double* lam, int n,
                      const SlackStep& residual, double* rows) {
  Pack result{};
  each_pack(n, [&](auto at) {
    const Pack s = at.of(step.s, 0.0), lower = at.of(step.lower, 0.0), upper = at.of(step.upper, 0.0);
    const Pack multiplier = at.of(lam, 0.0);
    const Pack first = at.of(side.s, 0.0) + at.of(system.damping, 0.0) * s - multiplier - lower + upper;
    const Pack second = at.of(side.lower, 0.0) + at.of(system.lower_duals, 0.0) * s + at.of(system.below, 1.0) * lower;
    const Pack third = at.of(side.upper, 0.0) - at.of(system.upper_duals, 0.0) * s + at.of(system.above, 1.0) * upper;
    at.put(residual.s, first);
    at.put(residual.lower, second);
    at.put(residual.upper, third);
    at.put(rows, at.of(rows, 0.0) - s - at.of(system.relaxation, 0.0) * multiplier);
    result = larger(magnitudes(first), larger(magnitudes(second), larger(magnitudes(third), result)));
  });
  return greatest(result);
}

constexpr VectorKernels vector_kernels = {
    largest,       absolute_sum,      finite,
    add_vectors,   distances,         barrier_gradient,
    barrier_slope, complementarity,   largest_complementarity,
    longest_step,  longest_dual_step, clamp_duals,
    reduce,        recover,           slack_residual,
};

}  // namespace
}  // namespace robotraj::native
