// The sparse symmetric factorisation from Python, for tests against a dense solver.
#include "arrays.hpp"
#include "bindings.hpp"
#include "ldl/factors.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace nb = nanobind;

namespace robotraj::native {
namespace {

using ldl::Factors;

ldl::Pattern checked_pattern(const Indices& starts, const Indices& rows) {
  ldl::Pattern pattern{static_cast<int>(starts.size()) - 1, narrow(starts), narrow(rows)};
  const std::vector<int>& begins = pattern.starts;
  if (pattern.n < 0 || begins.front() != 0 || begins.back() != static_cast<int>(rows.size()) ||
      !std::is_sorted(begins.begin(), begins.end()))
    throw std::invalid_argument("starts must ascend from 0 to the number of rows");
  for (int column = 0; column < pattern.n; ++column)
    for (int e = pattern.starts[column]; e < pattern.starts[column + 1]; ++e)
      if (pattern.rows[e] < column || pattern.rows[e] >= pattern.n)
        throw std::invalid_argument("entries must be in the lower triangle");
  return pattern;
}

}  // namespace

void bind_ldl(nb::module_& m) {
  nb::class_<Factors>(m, "SymmetricFactors")
      .def(
          "__init__",
          [](Factors* self, const Indices& starts, const Indices& rows, const std::string& processor,
             const std::vector<int>& groups) {
            ldl::Pattern pattern = checked_pattern(starts, rows);
            if (groups.size() % static_cast<std::size_t>(std::max(1, pattern.n)) != 0)
              throw std::invalid_argument("groups must have a number for each row, once or more");
            new (self) Factors(std::move(pattern), groups, processor);
          },
          nb::arg("starts"), nb::arg("rows"), nb::arg("processor") = "", nb::arg("groups") = std::vector<int>())
      .def(
          "factorise",
          [](Factors& self, const Doubles& values, double threshold, double small) {
            const double* from = checked(values, self.pattern().rows.size(), "values");
            std::vector<double> placed(self.pattern().rows.size());
            for (std::size_t e = 0; e < placed.size(); ++e) placed[self.tree().place_of[e]] = from[e];
            const ldl::Inertia found = self.factorise(placed.data(), threshold, small);
            return nb::make_tuple(found.negative, found.zero, found.delayed);
          },
          nb::arg("values"), nb::arg("threshold") = 1e-8, nb::arg("small") = 1e-20)
      .def(
          "solve",
          [](Factors& self, const Doubles& b) {
            const double* from = checked(b, self.pattern().n, "b");
            std::vector<double> x(from, from + self.pattern().n);
            self.solve(x.data());
            return to_numpy(std::move(x));
          },
          nb::arg("b"))
      .def_prop_ro("products", [](const Factors& self) { return self.tree().products; })
      .def_prop_ro("largest_front", [](const Factors& self) { return self.tree().largest; });
}

}  // namespace robotraj::native
