#include "linear_part.hpp"

#include <algorithm>

#include "kernels/packed.hpp"
#include "parallel/pack.hpp"

namespace robotraj::native {

std::vector<double> LinearPart::at(const double* constants, std::size_t count) const {
  const std::size_t in = this->constants(), out = numbers_.outputs();
  const Kernels& kernels = kernels_of("");
  const std::size_t lanes = kernels.lanes;
  std::vector<double> found(count * out);
  Packs c(in * lanes), memory(numbers_.memory() * lanes), results(out * lanes);
  const double* arguments[] = {c.data()};
  for (std::size_t point = 0; point < count; point += lanes) {
    const std::size_t points = std::min(lanes, count - point);
    load(constants + point * in, in, points, lanes, c.data());
    kernels.run(numbers_.code(), arguments, memory.data(), results.data());
    store(results.data(), out, points, lanes, found.data() + point * out);
  }
  return found;
}

}  // namespace robotraj::native
