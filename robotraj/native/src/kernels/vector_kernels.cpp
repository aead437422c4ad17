#include "vector_kernels.hpp"

#include <cmath>

namespace robotraj::native {

double log_sum(const DistanceSums& sums, const Bounds& bounds, const double* below, const double* above) {
  if (sums.regular) return std::log(sums.mantissa) + sums.exponent * std::log(2.0);
  double result = 0.0;
  for (int i = 0; i < bounds.count; ++i) {
    if (!std::isinf(bounds.lower[i])) result += std::log(below[i]);
    if (!std::isinf(bounds.upper[i])) result += std::log(above[i]);
  }
  return result;
}

}  // namespace robotraj::native
