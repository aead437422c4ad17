#include "packed.hpp"

namespace robotraj::native {

const std::vector<const Kernels*>& kernels() {
  static const std::vector<const Kernels*> found = [] {
    std::vector<const Kernels*> each;
#ifdef ROBOTRAJ_X86_KERNELS
    if (__builtin_cpu_supports("x86-64-v4")) each.push_back(&avx512_kernels);
    if (__builtin_cpu_supports("x86-64-v3")) each.push_back(&avx2_kernels);
#endif
    each.push_back(&plain_kernels);
    return each;
  }();
  return found;
}

const RiccatiKernels& riccati_for_processor() { return kernels().front()->riccati; }

}  // namespace robotraj::native
