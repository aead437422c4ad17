#include "packed.hpp"

#include <cmath>
#include <stdexcept>

namespace robotraj::native {

const std::vector<const Kernels*>& kernels() {
  static const std::vector<const Kernels*> found = [] {
    std::vector<const Kernels*> each;
#ifdef ROBOTRAJ_X86_KERNELS
    // The levels x86-64-v3 and v4 by their features, whose names all compilers know.
    const bool v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
                    __builtin_cpu_supports("bmi2");
    const bool v4 = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                    __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
                    __builtin_cpu_supports("avx512vl");
    if (v4) each.push_back(&avx512_kernels);
    if (v3) each.push_back(&avx2_kernels);
#endif
    each.push_back(&plain_kernels);
    return each;
  }();
  return found;
}

const Kernels& kernels_of(const std::string& processor) {
  for (const Kernels* each : kernels())
    if (processor.empty() || processor == each->processor) return *each;
  throw std::invalid_argument("this processor does not run what was compiled for '" + processor + "'");
}

const VectorKernels& vector_kernels_of() { return kernels().front()->vectors; }

const RiccatiKernels& riccati_kernels_of() { return kernels().front()->riccati; }

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
