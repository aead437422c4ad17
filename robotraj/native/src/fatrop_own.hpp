// fatrop's own functions, found by name behind those that stand in for them.
#pragma once

#include <dlfcn.h>

#include <cstdlib>

#define EXPORTED extern "C" __attribute__((visibility("default")))
/// Calls fatrop's own function of this name.
#define PASS_ON(name, ...)                                                                                     \
  static const auto own = robotraj::native::original<decltype(&name)>(#name, __builtin_return_address(0)); \
  return own(__VA_ARGS__)
// A macro's name is replaced before it is made a string, or pasted.
#define PASS(name, ...) PASS_ON(name, __VA_ARGS__)

namespace robotraj::native {

/// fatrop's own function, found from a place in the library that calls: fatrop itself, or one that needs it.
template <typename Function>
Function original(const char* name, void* caller) {
  Dl_info calling{};
  void* const library = dladdr(caller, &calling) ? dlopen(calling.dli_fname, RTLD_NOLOAD | RTLD_LAZY) : nullptr;
  void* const found = library ? dlsym(library, name) : nullptr;
  if (!found) std::abort();
  return reinterpret_cast<Function>(found);
}

}  // namespace robotraj::native
