// Compiled for x86-64-v3.
#define ROBOTRAJ_KERNELS avx2_front_kernels
#define ROBOTRAJ_LANES 4
#include "front_kernels.hpp"
