// Memory that is never cleared and only grows: pages that are not touched cost nothing.
#pragma once

#include <cstddef>
#include <cstring>
#include <memory>

#include "parallel/pack.hpp"

namespace robotraj::native::ldl {

/// Numbers, aligned for packs.
class Buffer {
 public:
  double* data() { return memory_.get(); }

  /// Room for at least this many numbers; the first `kept` of them stay as they are.
  void reserve(std::size_t numbers, std::size_t kept = 0) {
    if (numbers <= size_) return;
    const std::size_t size = kept > 0 ? numbers + numbers / 2 : numbers;
    std::unique_ptr<double[], Free> memory(Aligned<double>{}.allocate(size));
    if (kept > 0) std::memcpy(memory.get(), memory_.get(), kept * sizeof(double));
    memory_ = std::move(memory);
    size_ = size;
  }

 private:
  struct Free {
    void operator()(double* memory) const { Aligned<double>{}.deallocate(memory, 0); }
  };
  std::unique_ptr<double[], Free> memory_;
  std::size_t size_ = 0;
};

}  // namespace robotraj::native::ldl
