// Compiled for every processor.
#define ROBOTRAJ_KERNELS plain_front_kernels
#define ROBOTRAJ_LANES 2
#include "front_kernels.hpp"
