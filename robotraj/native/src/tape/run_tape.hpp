// Running a tape for a pack of points, and the terms of the chain rule.
#pragma once

#include "kernels/packed.hpp"
#include "parallel/lanes.hpp"
#include "parallel/sines.hpp"

namespace robotraj::native {
namespace {

/// Bits that make a sum a difference or a product, by `Step`.
struct Signs {
  std::uint64_t flipped, product;
};
const Signs kSigns[] = {{0, 0}, {std::uint64_t{1} << 63, 0}, {0, ~std::uint64_t{0}}};

/// Another operation than the first four. Apart from the loop, which would keep its packs in memory.
__attribute__((noinline)) void run_other(const Instruction& instruction, Pack* memory) {
  const Pack x = memory[instruction.first], y = memory[instruction.second];
  Pack& out = memory[instruction.out];
  if (instruction.step != Step::other) {
    Pack sine, cosine;
    sines(x, sine, cosine);
    out = instruction.step == Step::sine ? sine : cosine;
    return;
  }
  for (std::size_t lane = 0; lane < kLanes; ++lane) out[lane] = compute(instruction.operation, x[lane], y[lane]);
}

void run_tape(const TapeCode& tape, const double* const* arguments, double* numbers, double* result) {
  Pack* memory = packs(numbers);
  Pack* next = memory + tape.work;
  for (std::size_t i = 0; i < tape.arguments; ++i)
    for (std::size_t k = 0; k < tape.inputs[i]; ++k) *next++ = packs(arguments[i])[k];
  for (std::size_t i = 0; i < tape.constant_count; ++i) *next++ = Pack{} + tape.constants[i];
  for (const Instruction *each = tape.instructions, *end = each + tape.count; each != end; ++each) {
    if (__builtin_expect(each->step <= Step::multiply, true)) {
      const Pack x = memory[each->first], y = memory[each->second];
      const Signs& signs = kSigns[static_cast<int>(each->step)];
      const Bits product = Bits{} + signs.product;
      const Pack multiplied = x * y, added = x + (Pack)((Bits)y ^ (Bits{} + signs.flipped));
      memory[each->out] = (Pack)(((Bits)multiplied & product) | ((Bits)added & ~product));
    } else if (each->step == Step::divide) {
      memory[each->out] = memory[each->first] / memory[each->second];
    } else {
      run_other(*each, memory);
    }
  }
  for (std::size_t i = 0; i < tape.outputs; ++i) packs(result)[i] = next[i];
}

void multiply(const Product* terms, std::size_t count, const double* left, const double* right, double* out) {
  for (const Product *each = terms, *end = terms + count; each != end; ++each)
    packs(out)[each->out] += packs(left)[each->left] * packs(right)[each->right];
}

}  // namespace
}  // namespace robotraj::native
