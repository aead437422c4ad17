// Elimination of a front's pivots, one or two rows at a time, for one kind of processor.
//
// Duff and Reid, ACM Transactions on Mathematical Software 9 (1983): a candidate waits where every pivot of one or two
// rows would give it large multipliers. Candidates that are left at the end are delayed to the next front.
#pragma once

#include "front_substitution.hpp"
#include "front_update.hpp"

namespace robotraj::native::ldl {
namespace {

ROBOTRAJ_INLINE void swap_numbers(double& x, double& y) {
  const double kept = x;
  x = y;
  y = kept;
}

/// A pivot of this size beside the largest number of its column is accepted without a search for a larger one.
constexpr double kGood = 0.01;

class Elimination {
 public:
  Elimination(Front& front, const PivotRule& rule)
      : f_(front), ld_(front.ld), rule_(rule), w_(front.memory), one_(w_ + (kPanel + 1) * ld_), two_(one_ + ld_) {}

  Pivots run() {
    double threshold = rule_.threshold;
    int end = f_.candidates, begun = 0;
    bool forced = false;
    for (;;) {
      if (done_ == end) {
        if (end == f_.candidates) break;
        if (done_ == begun) {
          // No pivot is left within the threshold. The last front accepts any other.
          if (!rule_.last || forced) break;
          forced = true;
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
    return found_;
  }

 private:
  double& at(int i, int j) { return f_.entries[j * ld_ + i]; }

  /// Column j of the Schur complement after all pivots so far, rows `begin` to `end`. `begin` is `done_` or a
  /// multiple of kStep beyond j; `end` is a multiple of kStep.
  void column(int j, int begin, int end, double* out) {
    const double* own = f_.entries + j * ld_;
    for (int i = (begin > j ? begin : j) / kStep * kStep; i < end; i += kStep) *packs(out + i) = *packs(own + i);
    for (int i = begin; i < j; ++i) out[i] = at(j, i);
    const double* columns[kPanel + 1];
    double factors[kPanel + 1];
    int count = 0;
    for (int p = panel_; p < done_; ++p) {
      const double factor = w_[(p - panel_) * ld_ + j];
      if (factor == 0.0) continue;
      columns[count] = f_.entries + p * ld_;
      factors[count++] = factor;
    }
    if (count == 0) return;
    int i = begin / kStep * kStep;
    for (; i + 2 * kStep <= end; i += 2 * kStep) {
      Pack one = *packs(out + i), two = *packs(out + i + kStep);
      for (int p = 0; p < count; ++p) {
        one -= *packs(columns[p] + i) * factors[p];
        two -= *packs(columns[p] + i + kStep) * factors[p];
      }
      *packs(out + i) = one;
      *packs(out + i + kStep) = two;
    }
    for (; i < end; i += kStep) {
      Pack one = *packs(out + i);
      for (int p = 0; p < count; ++p) one -= *packs(columns[p] + i) * factors[p];
      *packs(out + i) = one;
    }
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
    column(k, k, ld_, one_);
    const double a = one_[k], most = largest(one_, k + 1, ld_);
    const bool alone = magnitude(a) > rule_.small && magnitude(a) >= threshold * most;
    if (alone && magnitude(a) >= kGood * most) return take_one();
    const int r = partner(one_);
    if (r < 0) return alone && take_one();
    column(r, k, ld_, two_);
    const double b = one_[r], c = two_[r], rest_one = rest(one_, r), rest_two = rest(two_, r);
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
      swap(r, k + 1);
      swap_numbers(one_[r], one_[k + 1]);
      swap_numbers(two_[r], two_[k + 1]);
      return take_two();
    }
    if (of_two > of_one) {
      swap(r, k);
      swap_numbers(two_[r], two_[k]);
      double* kept = one_;
      one_ = two_;
      two_ = kept;
      return take_one();
    }
    return of_one >= 0 && take_one();
  }

  bool take_one() {
    const int k = done_++;
    const double inverse = 1.0 / one_[k];
    double *l = f_.entries + k * ld_, *w = w_ + (k - panel_) * ld_;
    for (int i = k / kStep * kStep; i < ld_; i += kStep) {
      *packs(w + i) = *packs(one_ + i);
      *packs(l + i) = *packs(one_ + i) * inverse;
    }
    f_.diagonal[k] = inverse;
    f_.off[k] = 0.0;
    found_.count += 1;
    found_.negative += inverse < 0;
    return true;
  }

  bool take_two() {
    const int k = done_;
    done_ += 2;
    const double a = one_[k], b = one_[k + 1], c = two_[k + 1], det = a * c - b * b;
    const double first = c / det, between = -b / det, second = a / det;
    double *l1 = f_.entries + k * ld_, *l2 = l1 + ld_, *w1 = w_ + (k - panel_) * ld_, *w2 = w1 + ld_;
    for (int i = k / kStep * kStep; i < ld_; i += kStep) {
      const Pack x = *packs(one_ + i), y = *packs(two_ + i);
      *packs(w1 + i) = x;
      *packs(w2 + i) = y;
      *packs(l1 + i) = first * x + between * y;
      *packs(l2 + i) = between * x + second * y;
    }
    l1[k + 1] = 0.0;
    f_.diagonal[k] = first;
    f_.diagonal[k + 1] = second;
    f_.off[k] = between;
    f_.off[k + 1] = 0.0;
    found_.count += 2;
    // A negative determinant has one eigenvalue of each sign.
    found_.negative += det < 0 ? 1 : (a < 0 ? 2 : 0);
    return true;
  }

  /// Rows and columns i and j change places.
  void swap(int i, int j) {
    if (i == j) return;
    if (i > j) {
      const int kept = i;
      i = j;
      j = kept;
    }
    for (int c = 0; c < i; ++c) swap_numbers(at(i, c), at(j, c));
    swap_numbers(at(i, i), at(j, j));
    for (int c = i + 1; c < j; ++c) swap_numbers(at(c, i), at(j, c));
    for (int r = j + 1; r < f_.rows; ++r) swap_numbers(at(r, i), at(r, j));
    for (int p = panel_; p < done_; ++p) swap_numbers(w_[(p - panel_) * ld_ + i], w_[(p - panel_) * ld_ + j]);
    const int kept = f_.order[i];
    f_.order[i] = f_.order[j];
    f_.order[j] = kept;
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
      found_.count += 1;
      found_.zero += 1;
    }
  }

  Front& f_;
  const int ld_;
  const PivotRule rule_;
  double *w_, *one_, *two_;
  int done_ = 0, panel_ = 0;
  Pivots found_{0, 0, 0};
};

Pivots eliminate(Front& front, const PivotRule& rule) { return Elimination(front, rule).run(); }

constexpr FrontKernels front_kernels = {eliminate, add, forward, backward};

}  // namespace
}  // namespace robotraj::native::ldl
