// Any point block from Python: its sizes, and one evaluation at a time for tests and checks.
#include "point_block.hpp"

#include "bindings/arrays.hpp"
#include "bindings/bindings.hpp"

#include <nanobind/stl/shared_ptr.h>

namespace nb = nanobind;

namespace robotraj::native {

namespace {

Result evaluate(PointBlock& block, Evaluation which, const Doubles& v, const Doubles& c, const double* m,
                std::size_t threads) {
  const PointSizes& sizes = block.sizes();
  if ((which == Evaluation::cost || which == Evaluation::gradient) && sizes.costed < 0)
    throw std::invalid_argument("no output of this block carries cost");
  const double* inputs = checked(v, sizes.inputs * sizes.count, "v");
  const double* constants = checked(c, sizes.constants * sizes.count, "c");
  std::vector<double> result(sizes.results(which) * sizes.count);
  {
    // A thread that waits for the block releases the interpreter, which the thread that uses it may need.
    nb::gil_scoped_release released;
    block.alone(threads, [&](ThreadPool& pool) { block.evaluate(which, inputs, constants, m, result.data(), pool); });
  }
  return to_numpy(std::move(result));
}

}  // namespace

void bind_point_block(nb::module_& m) {
  auto block = nb::class_<PointBlock>(m, "PointBlock")
                   .def_prop_ro("count", [](const PointBlock& b) { return b.sizes().count; })
                   .def_prop_ro("inputs", [](const PointBlock& b) { return b.sizes().inputs; })
                   .def_prop_ro("constants", [](const PointBlock& b) { return b.sizes().constants; })
                   .def_prop_ro("outputs", [](const PointBlock& b) { return b.sizes().outputs; })
                   .def_prop_ro("jacobian_nonzeros", [](const PointBlock& b) { return b.sizes().jacobian; })
                   .def_prop_ro("hessian_nonzeros", [](const PointBlock& b) { return b.sizes().hessian; })
                   .def_prop_ro("costed", [](const PointBlock& b) { return b.sizes().costed; });
  const std::pair<const char*, Evaluation> functions[] = {{"values", Evaluation::values},
                                                          {"jacobian", Evaluation::jacobian},
                                                          {"cost", Evaluation::cost},
                                                          {"gradient", Evaluation::gradient}};
  for (const auto& [name, which] : functions)
    block.def(
        name,
        [which = which](PointBlock& b, const Doubles& v, const Doubles& c, std::size_t threads) {
          return evaluate(b, which, v, c, nullptr, threads);
        },
        nb::arg("v"), nb::arg("c"), nb::arg("threads") = 1);
  block.def(
      "hessian",
      [](PointBlock& b, const Doubles& v, const Doubles& c, const Doubles& m, std::size_t threads) {
        const double* multipliers = checked(m, b.sizes().outputs * b.sizes().count, "m");
        return evaluate(b, Evaluation::hessian, v, c, multipliers, threads);
      },
      nb::arg("v"), nb::arg("c"), nb::arg("m"), nb::arg("threads") = 1);
}

}  // namespace robotraj::native
