// Compiled for x86-64-v4.
#define ROBOTRAJ_KERNELS avx512_front_kernels
#define ROBOTRAJ_LANES 8
#include "front_kernels.hpp"
