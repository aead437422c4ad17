// The inner loops, compiled once for each kind of processor.
#pragma once

#include <string>
#include <vector>

#include "ldl/front.hpp"
#include "riccati/riccati.hpp"
#include "rigid_body/rigid_tree.hpp"
#include "sparse/repeated_rows.hpp"
#include "tape/tape.hpp"
#include "vector_kernels.hpp"

namespace robotraj::native {

/// Inverse dynamics tau = RNEA(q, w, a) of a pack of points and, where their arrays are given, derivatives; arrays of
/// packs.
struct RigidArguments {
  const double* q;
  const double* w;
  const double* a;
  const double* test;  ///< l, for the Hessian
  double* states;      ///< `Kernels::state` packs a joint
  double* tau;
  double* jacobian;  ///< d tau/dx in the order of `jacobian_pattern`; may be null
  double* hessian;   ///< d^2 (l' tau)/dx^2 in the order of `hessian_pattern`; may be null
};

/// One of the chain rule's terms: out[out] += left[left] * right[right].
struct Product {
  std::int32_t out, left, right;
};

struct Kernels {
  const char* processor;
  std::size_t lanes;  ///< points in a pack
  std::size_t state;  ///< packs that a joint's work memory takes
  void (*run)(const TapeCode& tape, const double* const* arguments, double* memory, double* result);
  void (*rigid)(const Tree& tree, const RigidArguments& arguments);
  void (*multiply)(const Product* terms, std::size_t count, const double* left, const double* right, double* out);
  /// y = base + A x of `count` repeats, at most as many as a pack holds; base may be null. `memory` holds a pack for
  /// each number that is read and for each row.
  void (*combine_rows)(const RepeatedRows& rows, const RepeatSteps& steps, const double* x, const double* base,
                       double* y, std::size_t count, double* memory);
  RiccatiKernels riccati;
  VectorKernels vectors;
  ldl::FrontKernels fronts;
};

/// Those that this processor runs, the fastest first.
const std::vector<const Kernels*>& kernels();

/// The fastest or, with a name, those compiled for that processor.
/// Throws std::invalid_argument where this one does not run them.
const Kernels& kernels_of(const std::string& processor);

// One file each.
extern const Kernels plain_kernels;
#ifdef ROBOTRAJ_X86_KERNELS
extern const Kernels avx2_kernels;
extern const Kernels avx512_kernels;
#endif

}  // namespace robotraj::native
