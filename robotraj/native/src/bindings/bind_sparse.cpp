// Sparse matrices from Python: SciPy's arrays, whichever integers they have.
#include "arrays.hpp"
#include "bindings.hpp"
#include "sparse/stacked.hpp"

namespace nb = nanobind;

namespace robotraj::native {

namespace {

template <typename Matrix>
Result times(const Matrix& self, const Doubles& x) {
  std::vector<double> y(self.rows());
  self.times(checked(x, self.columns(), "x"), y.data());
  return to_numpy(std::move(y));
}

/// An array of a matrix, which lives as long as the array does.
template <typename Number>
nb::ndarray<nb::numpy, const Number, nb::ndim<1>> shared(const Csr& matrix, const Number* first, std::size_t length) {
  nb::capsule owner(new Csr(matrix), [](void* p) noexcept { delete static_cast<Csr*>(p); });
  return {first, {length}, owner};
}

}  // namespace

void bind_sparse(nb::module_& m) {
  nb::class_<Csr>(m, "Csr")
      .def(nb::new_(
               [](std::size_t rows, std::size_t columns, const Narrow& starts, const Narrow& indices,
                  const Doubles& data) { return Csr(rows, columns, copied(starts), copied(indices), copied(data)); }),
           nb::arg("rows"), nb::arg("columns"), nb::arg("starts"), nb::arg("indices"), nb::arg("data"))
      .def_static(
          "summed",
          [](std::size_t rows, std::size_t columns, const Indices& row, const Indices& column, const Doubles& data) {
            return Csr::summed(rows, columns, data.size(), checked(row, data.size(), "row"),
                               checked(column, data.size(), "column"), data.data());
          },
          nb::arg("rows"), nb::arg("columns"), nb::arg("row"), nb::arg("column"), nb::arg("data"))
      .def("__matmul__", times<Csr>, nb::arg("x"))
      .def("__matmul__", nb::overload_cast<const Csr&>(&Csr::times, nb::const_), nb::arg("other"))
      .def(
          "resolved",
          [](const Csr& self, const Indices& variable, std::size_t columns) {
            return self.resolved({variable.data(), variable.data() + variable.size()}, columns);
          },
          nb::arg("variable"), nb::arg("columns"))
      .def("pruned", &Csr::pruned)
      .def("transposed", &Csr::transposed)
      .def_prop_ro(
          "starts", [](const Csr& a) { return shared(a, a.starts(), a.rows() + 1); }, nb::rv_policy::move)
      .def_prop_ro(
          "indices", [](const Csr& a) { return shared(a, a.indices(), a.entries()); }, nb::rv_policy::move)
      .def_prop_ro(
          "data", [](const Csr& a) { return shared(a, a.data(), a.entries()); }, nb::rv_policy::move)
      .def_prop_ro("rows", &Csr::rows)
      .def_prop_ro("columns", &Csr::columns)
      .def_prop_ro("entries", &Csr::entries);
  nb::class_<Stacked>(m, "Stacked")
      .def(nb::init<const Csr&>(), nb::arg("matrix"))
      .def("__matmul__", times<Stacked>, nb::arg("x"))
      .def_prop_ro("rows", &Stacked::rows)
      .def_prop_ro("columns", &Stacked::columns)
      .def_prop_ro("entries", &Stacked::entries)
      .def_prop_ro("kept", &Stacked::kept);
  nb::implicitly_convertible<Csr, Stacked>();
}

}  // namespace robotraj::native
