// The chain rule's combinations from Python.
#include "arrays.hpp"
#include "bindings.hpp"
#include "program/chains.hpp"

#include <nanobind/stl/vector.h>

namespace nb = nanobind;

namespace robotraj::native {

namespace {

template <typename Matrix>
nb::tuple taken_apart(Combined<Matrix> combined) {
  Pattern& pattern = combined.pattern;
  return nb::make_tuple(nb::make_tuple(to_numpy(std::move(pattern.rows)), to_numpy(std::move(pattern.columns))),
                        to_numpy(std::move(combined.constant)), std::move(combined.parts));
}

}  // namespace

void bind_chains(nb::module_& m) {
  nb::class_<Chain>(m, "Chain")
      .def(
          "__init__",
          [](Chain* self, std::size_t count, std::size_t inputs, std::size_t outputs, const Narrow& jacobian_rows,
             const Narrow& jacobian_columns, const Narrow& hessian_rows, const Narrow& hessian_columns,
             const Csr& scatter, const Csr& reads, const Csr& gather, const Indices& stages) {
            Chain chain{count,
                        inputs,
                        outputs,
                        {copied(jacobian_rows), copied(jacobian_columns)},
                        {copied(hessian_rows), copied(hessian_columns)},
                        scatter,
                        reads,
                        gather,
                        copied(stages)};
            chain.check();
            new (self) Chain(std::move(chain));
          },
          nb::arg("count"), nb::arg("inputs"), nb::arg("outputs"), nb::arg("jacobian_rows"),
          nb::arg("jacobian_columns"), nb::arg("hessian_rows"), nb::arg("hessian_columns"), nb::arg("scatter"),
          nb::arg("reads"), nb::arg("gather"), nb::arg("stages"));
  m.def(
      "jacobian_chain",
      [](const Csr& linear, const std::vector<const Chain*>& chains, const Csr& expressions, const Indices& base,
         const Indices& starts, const Indices& stages) {
        return taken_apart(
            jacobian_chain(linear, chains, {expressions, copied(base)}, {copied(starts), copied(stages)}));
      },
      nb::arg("linear"), nb::arg("chains"), nb::arg("expressions"), nb::arg("base"), nb::arg("starts"),
      nb::arg("stages"));
  m.def(
      "hessian_chain",
      [](const std::vector<const Chain*>& chains, const Indices& starts) {
        return taken_apart(hessian_chain(chains, {copied(starts), {}}));
      },
      nb::arg("chains"), nb::arg("starts"));
}

}  // namespace robotraj::native
