// Additions of children to a front, and substitutions with its columns of L, for one kind of processor.
#pragma once

#include "front.hpp"
#include "parallel/lanes.hpp"

namespace robotraj::native::ldl {
namespace {

/// Adds a child's lower triangle of `count` rows, `step` numbers a column, at `places`.
void add(const double* block, int step, int count, const int* places, double* entries, int ld) {
  for (int j = 0; j < count; ++j) {
    const double* from = block + j * step;
    double* to = entries + places[j] * ld;
    int i = j;
    // Few rows follow each other in the parent too. Four are read before one is written: no two have the same place.
    for (; i + 4 <= count; i += 4) {
      const int* at = places + i;
      const double one = to[at[0]] + from[i], two = to[at[1]] + from[i + 1];
      const double three = to[at[2]] + from[i + 2], four = to[at[3]] + from[i + 3];
      to[at[0]] = one;
      to[at[1]] = two;
      to[at[2]] = three;
      to[at[3]] = four;
    }
    for (; i < count; ++i) to[places[i]] += from[i];
  }
}

/// Pivots that are processed together.
constexpr int kTogether = 4;

/// x -= `count` columns of L times x[0], ... of those pivots, from row `begin` on.
template <int Count>
ROBOTRAJ_INLINE void subtract(const double* l, int ld, int begin, const double* pivots, double* x) {
  Pack factor[Count];
  for (int p = 0; p < Count; ++p) factor[p] = Pack{} + pivots[p];
  for (int i = begin; i < ld; i += kStep) {
    Pack sum = *packs(x + i);
#pragma GCC unroll 4
    for (int p = 0; p < Count; ++p) sum -= *packs(l + p * ld + i) * factor[p];
    *packs(x + i) = sum;
  }
}

/// Columns of L have zeros from the block of their diagonal to it, so that whole packs can be worked on.
void forward(const double* l, int ld, int pivots, double* x) {
  int k = 0;
  for (; k + kTogether <= pivots; k += kTogether, l += kTogether * ld) {
    double pivot[kTogether];
    for (int p = 0; p < kTogether; ++p) {
      pivot[p] = x[k + p];
      for (int q = 0; q < p; ++q) pivot[p] -= l[q * ld + k + p] * pivot[q];
    }
    subtract<kTogether>(l, ld, k / kStep * kStep, pivot, x);
  }
  for (; k < pivots; ++k, l += ld) {
    const double pivot = x[k];
    subtract<1>(l, ld, k / kStep * kStep, &pivot, x);
  }
}

template <int Count>
ROBOTRAJ_INLINE void products(const double* l, int ld, int begin, const double* x, double* out) {
  Pack sum[Count] = {};
  for (int i = begin; i < ld; i += kStep)
#pragma GCC unroll 4
    for (int p = 0; p < Count; ++p) sum[p] += *packs(l + p * ld + i) * *packs(x + i);
  for (int p = 0; p < Count; ++p) {
    out[p] = 0.0;
    for (int lane = 0; lane < kStep; ++lane) out[p] += sum[p][lane];
  }
}

void backward(const double* l, int ld, int pivots, double* x) {
  int k = pivots;
  for (; k % kTogether != 0; --k) {
    double product;
    products<1>(l + (k - 1) * ld, ld, (k - 1) / kStep * kStep, x, &product);
    x[k - 1] -= product;
  }
  for (k -= kTogether; k >= 0; k -= kTogether) {
    const double* columns = l + k * ld;
    double product[kTogether];
    products<kTogether>(columns, ld, k / kStep * kStep, x, product);
    // The products hold the old x[k], ..., so each new one still changes those before it.
    for (int p = kTogether - 1; p >= 0; --p) {
      for (int q = p + 1; q < kTogether; ++q) product[p] -= columns[p * ld + k + q] * product[q];
      x[k + p] -= product[p];
    }
  }
}

}  // namespace
}  // namespace robotraj::native::ldl
