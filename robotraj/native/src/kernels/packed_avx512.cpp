// Compiled for x86-64-v4.
#define ROBOTRAJ_KERNELS avx512_kernels
#define ROBOTRAJ_PROCESSOR "x86-64-v4"
#define ROBOTRAJ_LANES 8
#include "kernels.hpp"
