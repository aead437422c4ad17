// Any point block from Python: its sizes, and one evaluation at a time for tests and checks.
#include "point_block.hpp"

#include "bindings/arrays.hpp"
#include "bindings/bindings.hpp"

#include <nanobind/stl/shared_ptr.h>

namespace nb = nanobind;

namespace robotraj::native {

namespace {

/// Runs an evaluation that takes (v, c) and gives `per_point` numbers a point.
template <typename Evaluate>
Result evaluate(PointBlock& block, const Doubles& v, const Doubles& c, std::size_t per_point, std::size_t threads,
                Evaluate&& call) {
  const PointSizes& sizes = block.sizes();
  const double* inputs = checked(v, sizes.inputs * sizes.count, "v");
  const double* constants = checked(c, sizes.constants * sizes.count, "c");
  std::vector<double> result(per_point * sizes.count);
  {
    // A thread that waits for the block releases the interpreter, which the thread that uses it may need.
    nb::gil_scoped_release released;
    block.alone(threads, [&](ThreadPool& pool) { call(inputs, constants, result.data(), pool); });
  }
  return to_numpy(std::move(result));
}

void need_cost(const PointBlock& block) {
  if (block.sizes().costed < 0) throw std::invalid_argument("no output of this block carries cost");
}

}  // namespace

void bind_point_block(nb::module_& m) {
  nb::class_<PointBlock>(m, "PointBlock")
      .def_prop_ro("count", [](const PointBlock& b) { return b.sizes().count; })
      .def_prop_ro("inputs", [](const PointBlock& b) { return b.sizes().inputs; })
      .def_prop_ro("constants", [](const PointBlock& b) { return b.sizes().constants; })
      .def_prop_ro("outputs", [](const PointBlock& b) { return b.sizes().outputs; })
      .def_prop_ro("jacobian_nonzeros", [](const PointBlock& b) { return b.sizes().jacobian; })
      .def_prop_ro("hessian_nonzeros", [](const PointBlock& b) { return b.sizes().hessian; })
      .def_prop_ro("costed", [](const PointBlock& b) { return b.sizes().costed; })
      .def(
          "values",
          [](PointBlock& b, const Doubles& v, const Doubles& c, std::size_t threads) {
            return evaluate(
                b, v, c, b.sizes().outputs, threads,
                [&](const double* v, const double* c, double* out, ThreadPool& pool) { b.values(v, c, out, pool); });
          },
          nb::arg("v"), nb::arg("c"), nb::arg("threads") = 1)
      .def(
          "jacobian",
          [](PointBlock& b, const Doubles& v, const Doubles& c, std::size_t threads) {
            return evaluate(
                b, v, c, b.sizes().jacobian, threads,
                [&](const double* v, const double* c, double* out, ThreadPool& pool) { b.jacobian(v, c, out, pool); });
          },
          nb::arg("v"), nb::arg("c"), nb::arg("threads") = 1)
      .def(
          "cost",
          [](PointBlock& b, const Doubles& v, const Doubles& c, std::size_t threads) {
            need_cost(b);
            return evaluate(b, v, c, 1, threads, [&](const double* v, const double* c, double* out, ThreadPool& pool) {
              b.cost(v, c, out, pool);
            });
          },
          nb::arg("v"), nb::arg("c"), nb::arg("threads") = 1)
      .def(
          "gradient",
          [](PointBlock& b, const Doubles& v, const Doubles& c, std::size_t threads) {
            need_cost(b);
            return evaluate(
                b, v, c, b.sizes().inputs, threads,
                [&](const double* v, const double* c, double* out, ThreadPool& pool) { b.gradient(v, c, out, pool); });
          },
          nb::arg("v"), nb::arg("c"), nb::arg("threads") = 1)
      .def(
          "hessian",
          [](PointBlock& b, const Doubles& v, const Doubles& c, const Doubles& m, std::size_t threads) {
            const double* multipliers = checked(m, b.sizes().outputs * b.sizes().count, "m");
            return evaluate(b, v, c, b.sizes().hessian, threads,
                            [&](const double* v, const double* c, double* out, ThreadPool& pool) {
                              b.hessian(v, c, multipliers, out, pool);
                            });
          },
          nb::arg("v"), nb::arg("c"), nb::arg("m"), nb::arg("threads") = 1);
}

}  // namespace robotraj::native
