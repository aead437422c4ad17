#include "front.hpp"

#include "kernels/packed.hpp"

namespace robotraj::native::ldl {

const FrontKernels& front_kernels_of(const std::string& processor) {
#ifdef ROBOTRAJ_X86_KERNELS
  const Kernels& kernels = kernels_of(processor);
  if (kernels.lanes == 8) return avx512_front_kernels;
  if (kernels.lanes == 4) return avx2_front_kernels;
#else
  kernels_of(processor);
#endif
  return plain_front_kernels;
}

}  // namespace robotraj::native::ldl
