// Compiled for x86-64-v3.
#define ROBOTRAJ_KERNELS avx2_kernels
#define ROBOTRAJ_PROCESSOR "x86-64-v3"
#define ROBOTRAJ_LANES 4
#include "kernels.hpp"
