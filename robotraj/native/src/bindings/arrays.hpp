// NumPy arrays in and out.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace robotraj::native {

/// A contiguous vector of doubles, read only.
using Doubles = nanobind::ndarray<const double, nanobind::ndim<1>, nanobind::c_contig, nanobind::device::cpu>;
/// A contiguous vector of indices, read only.
using Indices = nanobind::ndarray<const std::int64_t, nanobind::ndim<1>, nanobind::c_contig, nanobind::device::cpu>;
/// The same of 32 bits.
using Narrow = nanobind::ndarray<const std::int32_t, nanobind::ndim<1>, nanobind::c_contig, nanobind::device::cpu>;
/// An array for Python; NumPy owns its memory.
template <typename Number>
using Owned = nanobind::ndarray<nanobind::numpy, Number, nanobind::ndim<1>>;
using Result = Owned<double>;

/// Moves a vector into a NumPy array without a copy.
template <typename Number>
Owned<Number> to_numpy(std::vector<Number> values) {
  auto* kept = new std::vector<Number>(std::move(values));
  nanobind::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<Number>*>(p); });
  return Owned<Number>(kept->data(), {kept->size()}, owner);
}

/// The numbers of an array from Python, as a vector.
template <typename Array>
auto copied(const Array& array) {
  return std::vector<std::remove_const_t<typename Array::Scalar>>(array.data(), array.data() + array.size());
}

/// Indices of 32 bits; refuses those that have more.
inline std::int32_t narrow(std::int64_t index) {
  if (index != static_cast<std::int32_t>(index)) throw std::invalid_argument("an index has more than 32 bits");
  return static_cast<std::int32_t>(index);
}
inline std::vector<std::int32_t> narrow(const Indices& indices) {
  std::vector<std::int32_t> found;
  for (std::size_t i = 0; i < indices.size(); ++i) found.push_back(narrow(indices.data()[i]));
  return found;
}

/// Refuses numbers that are not finite, by name.
inline const Doubles& finite(const Doubles& array, const std::string& name) {
  if (!std::all_of(array.data(), array.data() + array.size(), [](double number) { return std::isfinite(number); }))
    throw std::invalid_argument(name + " has a number that is not finite");
  return array;
}

/// Refuses a vector of the wrong length by name.
template <typename Array>
const auto* checked(const Array& array, std::size_t length, const std::string& name) {
  if (array.size() != length)
    throw std::invalid_argument(name + " has " + std::to_string(array.size()) + " entries, expected " +
                                std::to_string(length));
  return array.data();
}

}  // namespace robotraj::native
