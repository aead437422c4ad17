// Compiled for every processor.
#define ROBOTRAJ_KERNELS plain_kernels
#define ROBOTRAJ_PROCESSOR "any"
#define ROBOTRAJ_LANES 2
#include "kernels.hpp"
