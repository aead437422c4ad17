// Elimination of a front's pivots, one or two rows at a time, for one kind of processor.
//
// Duff and Reid, ACM Transactions on Mathematical Software 9 (1983): a candidate waits where every pivot of one or two
// rows would give it large multipliers. Candidates that are left at the end are delayed to the next front.
#pragma once

#include "front_substitution.hpp"
#include "front_update.hpp"

namespace robotraj::native::ldl {
namespace {

template <class Number>
ROBOTRAJ_INLINE void swap_numbers(Number& x, Number& y) {
  const Number kept = x;
  x = y;
  y = kept;
}

/// A pivot of this size beside the largest number of its column is accepted without a search for a larger one.
constexpr double kGood = 1e-4;

class Elimination {
 public:
  Elimination(Front& front, const PivotRule& rule) : f_(front), ld_(front.ld), rule_(rule), w_(front.memory) {}

  Pivots run() {
    double threshold = rule_.threshold;
    int end = f_.candidates, begun = 0;
    for (;;) {
      if (done_ == end) {
        if (end == f_.candidates) break;
        if (done_ == begun) {
          // No pivot is left within the threshold. The last front accepts any other.
          if (!rule_.last || threshold == 0.0) break;
          threshold = 0.0;
        }
        end = f_.candidates;
        begun = done_;
      }
      if (done_ - panel_ >= kPanel) flush();
      if (!pivot(threshold)) swap(done_, --end);
      // The second row of a pivot may be one that was delayed.
      if (done_ > end) end = done_;
    }
    flush();
    if (rule_.last) finish();
    found_.count = done_;
    return found_;
  }

 private:
  double& at(int i, int j) { return f_.entries[j * ld_ + i]; }

  /// Column j of the Schur complement after all pivots so far, from row `done_` on. Returns the largest number below it.
  double column(int j, double* out) {
    const int k = done_;
    for (int i = (j > k ? j : k) / kStep * kStep; i < ld_; i += kStep)
      *packs(out + i) = *packs(f_.entries + j * ld_ + i);
    for (int i = k; i < j; ++i) out[i] = at(j, i);
    update_column(f_.entries + panel_ * ld_, w_ + j, ld_, k - panel_, k, out);
    return largest(out, k + 1, ld_);
  }

  /// The largest number of a column among rows `begin` to `end`.
  double largest(const double* x, int begin, int end) const {
    double most = 0.0;
    int i = begin;
    for (; i < end && i % kStep != 0; ++i) most = magnitude(x[i]) > most ? magnitude(x[i]) : most;
    Pack high{};
    for (; i + kStep <= end; i += kStep) {
      const Pack size = *packs(x + i) < 0.0 ? -*packs(x + i) : *packs(x + i);
      high = size > high ? size : high;
    }
    for (int lane = 0; lane < kStep; ++lane) most = high[lane] > most ? high[lane] : most;
    for (; i < end; ++i) most = magnitude(x[i]) > most ? magnitude(x[i]) : most;
    return most;
  }

  /// The same below row `done_`, but for row `without`.
  double rest(double* x, int without) const {
    const double kept = x[without];
    x[without] = 0.0;
    const double most = largest(x, done_ + 1, ld_);
    x[without] = kept;
    return most;
  }

  /// The row of the largest number among the candidates below the first.
  int partner(const double* x) const {
    const double most = largest(x, done_ + 1, f_.candidates);
    if (!(most > rule_.small)) return -1;
    int row = done_ + 1;
    while (row < f_.candidates - 1 && magnitude(x[row]) != most) ++row;
    return row;
  }

  /// Eliminates the next candidate, alone or with another; false if neither is accepted.
  bool pivot(double threshold) {
    const int k = done_;
    double *one = w_ + (k - panel_) * ld_, *two = one + ld_;
    const double most = column(k, one), a = one[k];
    const bool alone = magnitude(a) > rule_.small && magnitude(a) >= threshold * most;
    if (alone && magnitude(a) >= kGood * most) return take_one();
    const int r = partner(one);
    if (r < 0) return alone && take_one();
    column(r, two);
    const double b = one[r], c = two[r], rest_one = rest(one, r), rest_two = rest(two, r);
    const double det = magnitude(a * c - b * b);
    const double growth_one = magnitude(c) * rest_one + magnitude(b) * rest_two;
    const double growth_two = magnitude(b) * rest_one + magnitude(a) * rest_two;
    const double growth = growth_one > growth_two ? growth_one : growth_two;
    const bool both = det > rule_.small * magnitude(b) && threshold * growth <= det;
    const double size_two = rest_two > magnitude(b) ? rest_two : magnitude(b);
    const bool other = magnitude(c) > rule_.small && magnitude(c) >= threshold * size_two;
    // The one with the smallest multipliers.
    const double of_one = alone ? magnitude(a) / most : -1.0;
    const double of_two = other ? magnitude(c) / size_two : -1.0;
    const double of_both = both ? (growth > 0 ? det / growth : 1e300) : -1.0;
    if (of_both >= 0 && of_both >= of_one && of_both >= of_two) {
      swap(k + 1, r);
      swap_numbers(one[r], one[k + 1]);
      swap_numbers(two[r], two[k + 1]);
      return take_two();
    }
    if (of_two > of_one) {
      swap(k, r);
      swap_numbers(two[r], two[k]);
      for (int i = k / kStep * kStep; i < ld_; i += kStep) *packs(one + i) = *packs(two + i);
      return take_one();
    }
    return of_one >= 0 && take_one();
  }

  bool take_one() {
    const int k = done_++;
    double *l = f_.entries + k * ld_, *w = w_ + (k - panel_) * ld_;
    const double inverse = 1.0 / w[k];
    for (int i = k / kStep * kStep; i < ld_; i += kStep) *packs(l + i) = *packs(w + i) * inverse;
    f_.diagonal[k] = inverse;
    f_.off[k] = 0.0;
    found_.negative += inverse < 0;
    return true;
  }

  bool take_two() {
    const int k = done_;
    done_ += 2;
    double *l1 = f_.entries + k * ld_, *l2 = l1 + ld_, *w1 = w_ + (k - panel_) * ld_, *w2 = w1 + ld_;
    const double a = w1[k], b = w1[k + 1], c = w2[k + 1], det = a * c - b * b;
    const double first = c / det, between = -b / det, second = a / det;
    for (int i = k / kStep * kStep; i < ld_; i += kStep) {
      const Pack x = *packs(w1 + i), y = *packs(w2 + i);
      *packs(l1 + i) = first * x + between * y;
      *packs(l2 + i) = between * x + second * y;
    }
    l1[k + 1] = 0.0;
    f_.diagonal[k] = first;
    f_.diagonal[k + 1] = second;
    f_.off[k] = between;
    f_.off[k + 1] = 0.0;
    // A negative determinant has one eigenvalue of each sign.
    found_.negative += det < 0 ? 1 : (a < 0 ? 2 : 0);
    return true;
  }

  /// Rows and columns i <= j change places.
  void swap(int i, int j) {
    if (i == j) return;
    double *one = f_.entries + i * ld_, *two = f_.entries + j * ld_;
    for (int c = 0; c < i; ++c) swap_numbers(at(i, c), at(j, c));
    swap_numbers(one[i], two[j]);
    for (int c = i + 1; c < j; ++c) swap_numbers(one[c], at(j, c));
    int r = j + 1;
    for (; r % kStep != 0; ++r) swap_numbers(one[r], two[r]);
    for (; r < ld_; r += kStep) swap_numbers(*packs(one + r), *packs(two + r));
    for (int p = panel_; p < done_; ++p) swap_numbers(w_[(p - panel_) * ld_ + i], w_[(p - panel_) * ld_ + j]);
    swap_numbers(f_.order[i], f_.order[j]);
  }

  /// Updates the rest of the front by the panel's pivots.
  void flush() {
    if (done_ > panel_) update(f_.entries + panel_ * ld_, w_, ld_, f_.rows, done_ - panel_, done_, f_.entries);
    panel_ = done_;
  }

  /// The remaining entries of the last front are zero: they give no pivots and are not divided by.
  void finish() {
    for (; done_ < f_.candidates; ++done_) {
      for (int i = done_ + 1; i < ld_; ++i) at(i, done_) = 0.0;
      f_.diagonal[done_] = f_.off[done_] = 0.0;
      found_.zero += 1;
    }
  }

  Front& f_;
  const int ld_;
  const PivotRule rule_;
  double* w_;  ///< columns of L D of the panel's pivots, and after them those that are tried
  int done_ = 0, panel_ = 0;
  Pivots found_{0, 0, 0};
};

Pivots eliminate(Front& front, const PivotRule& rule) { return Elimination(front, rule).run(); }

constexpr FrontKernels front_kernels = {eliminate, add, forward, backward};

}  // namespace
}  // namespace robotraj::native::ldl
