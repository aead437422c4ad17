// Patterns of sparse matrices on their way to NumPy: tuples of rows and columns.
#pragma once

#include <cstdint>
#include <vector>

#include "arrays.hpp"
#include "sparse/pattern.hpp"

namespace nanobind::detail {

template <>
struct type_caster<robotraj::native::Pattern> {
  NB_TYPE_CASTER(robotraj::native::Pattern, const_name("tuple"))

  bool from_python(handle, std::uint8_t, cleanup_list*) noexcept { return false; }
  static handle from_cpp(const robotraj::native::Pattern& pattern, rv_policy, cleanup_list*) noexcept {
    const auto wide = [](const std::vector<std::int32_t>& indices) {
      return robotraj::native::to_numpy(std::vector<std::int64_t>(indices.begin(), indices.end()));
    };
    return make_tuple(wide(pattern.rows), wide(pattern.columns)).release();
  }
};

}  // namespace nanobind::detail
