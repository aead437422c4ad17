// Options and outcome of a solve.
#include "bindings.hpp"

#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "arrays.hpp"
#include "interior_point/solver.hpp"

namespace nb = nanobind;

namespace robotraj::native {

using interior_point::Options;
using interior_point::Outcome;

/// Calls `use` with the name and the member of every option.
template <typename Use>
static void each_option(Use&& use) {
  use("tolerance", &Options::tolerance);
  use("acceptable_tolerance", &Options::acceptable_tolerance);
  use("acceptable_iterations", &Options::acceptable_iterations);
  use("violation_tolerance", &Options::violation_tolerance);
  use("objective_change", &Options::objective_change);
  use("max_iterations", &Options::max_iterations);
  use("processor_limit", &Options::processor_limit);
  use("initial_barrier", &Options::initial_barrier);
  use("barrier_factor", &Options::barrier_factor);
  use("barrier_decrease", &Options::barrier_decrease);
  use("barrier_power", &Options::barrier_power);
  use("adaptive_barrier", &Options::adaptive_barrier);
  use("bound_relaxation", &Options::bound_relaxation);
  use("bound_push", &Options::bound_push);
  use("bound_fraction", &Options::bound_fraction);
  use("elimination_tolerance", &Options::elimination_tolerance);
  use("pivot_tolerance", &Options::pivot_tolerance);
  use("first_correction", &Options::first_correction);
  use("correction_increase", &Options::correction_increase);
  use("correction_decrease", &Options::correction_decrease);
  use("row_correction", &Options::row_correction);
  use("least_row_correction", &Options::least_row_correction);
}

/// Options by their names; the others keep their defaults.
static void set_options(Options* self, const nb::kwargs& given) {
  new (self) Options();
  for (const auto& [key, value] : given) {
    const auto name = nb::cast<std::string>(key);
    std::string known;
    bool found = false;
    each_option([&, &value = value](const char* each, auto member) {
      known += std::string(" ") + each;
      if (name != each) return;
      if (!nb::try_cast(value, self->*member)) throw std::invalid_argument("option '" + name + "' is no number");
      found = true;
    });
    if (!found) throw std::invalid_argument("there is no option '" + name + "'; there are" + known);
  }
}

void bind_solver(nb::module_& m) {
  auto options = nb::class_<Options>(m, "Options").def("__init__", set_options);
  each_option([&](const char* name, auto member) { options.def_rw(name, member); });

  nb::class_<Outcome>(m, "Outcome")
      .def_prop_ro(
          "y", [](const Outcome& o) { return to_numpy(o.y); }, nb::rv_policy::move)
      .def_prop_ro(
          "lam", [](const Outcome& o) { return to_numpy(o.lam); }, nb::rv_policy::move)
      .def_prop_ro(
          "lower_duals", [](const Outcome& o) { return to_numpy(o.lower_duals); }, nb::rv_policy::move)
      .def_prop_ro(
          "upper_duals", [](const Outcome& o) { return to_numpy(o.upper_duals); }, nb::rv_policy::move)
      .def_ro("status", &Outcome::status)
      .def_ro("message", &Outcome::message)
      .def_ro("iterations", &Outcome::iterations)
      .def_ro("objective", &Outcome::objective)
      .def_ro("violation", &Outcome::violation)
      .def_ro("mu", &Outcome::mu)
      .def_prop_ro("times",
                   [](const Outcome& o) {
                     return std::map<std::string, double>{{"functions", o.functions},
                                                          {"combinations", o.combinations},
                                                          {"linear algebra", o.linear_algebra},
                                                          {"total", o.total}};
                   })
      .def_ro("trace", &Outcome::trace);
}

}  // namespace robotraj::native
