// The inner loops, included by one file for each kind of processor.
//
// Everything here has internal linkage and nothing of the standard library is called: a function compiled for one
// processor must never be taken for another's.
#pragma once

#include "packed.hpp"

#include "parallel/lanes.hpp"
#include "rigid_body/spatial.hpp"
#include "tape/run_tape.hpp"
// The algorithms use the headers above.
#include "barrier_vectors.hpp"
#include "ldl/front_kernels.hpp"
#include "riccati/riccati_substitution.hpp"
#include "rigid_body/rigid_kernel.hpp"
#include "sparse/combine_rows.hpp"

namespace robotraj::native {

const Kernels ROBOTRAJ_KERNELS = {
    ROBOTRAJ_PROCESSOR, kLanes,           sizeof(JointState) / sizeof(Pack),
    run_tape,           inverse_dynamics, multiply,
    combine_rows,       riccati_kernels,  vector_kernels,
    ldl::front_kernels,
};

}  // namespace robotraj::native
