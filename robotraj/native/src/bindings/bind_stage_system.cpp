// Newton's system of stages from Python, for tests against a dense solver.
#include "arrays.hpp"
#include "bindings.hpp"
#include "newton/riccati_solver.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <memory>
#include <optional>

namespace nb = nanobind;

namespace robotraj::native {

namespace {

/// A program's matrices and the solver of its systems; rows are [dynamics, equalities, inequalities].
class StageSystem {
 public:
  StageSystem(const Indices& controls, const Indices& states, const Indices& equalities, const Indices& inequalities,
              const Pattern& jacobian, const Pattern& hessian, const std::string& processor)
      : layout_(Stages{sizes(controls), sizes(states), sizes(equalities), sizes(inequalities)}),
        matrices_(layout_, jacobian, hessian, riccati_kernels_of(processor)),
        solver_(matrices_),
        jacobian_(matrices_.empty_jacobian()),
        hessian_(matrices_.empty_hessian()) {}

  void fill(const Doubles& jacobian, const Doubles& hessian) {
    matrices_.fill_jacobian(Numbers(jacobian.data(), jacobian.data() + jacobian.size()), jacobian_);
    matrices_.fill_hessian(Numbers(hessian.data(), hessian.data() + hessian.size()), hessian_);
  }

  nb::tuple solve(const std::optional<Doubles>& dx, const std::optional<Doubles>& de, const Doubles& ds,
                  const Doubles& f, const Doubles& g) {
    Numbers z(columns()), lam(rows());
    const double* residuals = checked(g, rows(), "g");
    const NewtonSystem system{dx ? checked(*dx, columns(), "dx") : nullptr,
                              de ? de->data() : nullptr,
                              ds.data(),
                              checked(f, columns(), "f"),
                              residuals,
                              residuals + layout_.inequality_rows,
                              z.data(),
                              lam.data()};
    Pivots pivots = Pivots::good;
    if (dx) pivots = solver_.factorise_and_solve(jacobian_, hessian_, system, nullptr);
    else solver_.solve(jacobian_, system);
    const char* const names[] = {"good", "indefinite", "dependent"};
    return nb::make_tuple(names[static_cast<int>(pivots)], to_numpy(std::move(z)), to_numpy(std::move(lam)));
  }

  /// Residual of z and lam, and its largest magnitude but for the inequalities.
  nb::tuple residual(const Doubles& dx, const std::optional<Doubles>& de, const Doubles& f, const Doubles& g,
                     const Doubles& z, const Doubles& lam) {
    Numbers step(checked(z, columns(), "z"), z.data() + z.size());
    Numbers multipliers(checked(lam, rows(), "lam"), lam.data() + lam.size());
    const double* residuals = checked(g, rows(), "g");
    Numbers gradient(columns()), left(rows());
    const double greatest = solver_.residual(
        jacobian_, hessian_,
        {checked(dx, columns(), "dx"), de ? de->data() : nullptr, nullptr, checked(f, columns(), "f"), residuals,
         residuals + layout_.inequality_rows, step.data(), multipliers.data()},
        0, matrices_.count(),
        {gradient.data(), left.data(), left.data() + layout_.equality_rows, left.data() + layout_.inequality_rows});
    return nb::make_tuple(to_numpy(std::move(gradient)), to_numpy(std::move(left)), greatest);
  }

  Result jacobian_times(const Doubles& x) const {
    Numbers out(rows());
    matrices_.jacobian_times(jacobian_, checked(x, columns(), "x"), 0.0, out.data(), out.data());
    return to_numpy(std::move(out));
  }
  Result transposed_times(const Doubles& lam) const {
    Numbers out(columns());
    matrices_.transposed_times(jacobian_, checked(lam, rows(), "lam"), 0.0, out.data(), out.data());
    return to_numpy(std::move(out));
  }
  Result hessian_times(const Doubles& x) const {
    Numbers out(columns());
    matrices_.hessian_times(hessian_, checked(x, columns(), "x"), 0.0, out.data(), out.data());
    return to_numpy(std::move(out));
  }

 private:
  static std::vector<int> sizes(const Indices& array) { return {array.data(), array.data() + array.size()}; }
  std::size_t columns() const { return static_cast<std::size_t>(layout_.columns); }
  std::size_t rows() const { return static_cast<std::size_t>(layout_.rows); }

  Layout layout_;
  StageMatrices matrices_;
  RiccatiSolver solver_;
  StageValues jacobian_, hessian_;
};

}  // namespace

void bind_stage_system(nb::module_& m) {
  nb::class_<StageSystem>(m, "StageSystem")
      .def(
          "__init__",
          [](StageSystem* self, const Indices& controls, const Indices& states, const Indices& equalities,
             const Indices& inequalities, const Narrow& jacobian_rows, const Narrow& jacobian_columns,
             const Narrow& hessian_rows, const Narrow& hessian_columns, const std::string& processor) {
            new (self) StageSystem(controls, states, equalities, inequalities,
                                   Pattern{copied(jacobian_rows), copied(jacobian_columns)},
                                   Pattern{copied(hessian_rows), copied(hessian_columns)}, processor);
          },
          nb::arg("controls"), nb::arg("states"), nb::arg("equalities"), nb::arg("inequalities"),
          nb::arg("jacobian_rows"), nb::arg("jacobian_columns"), nb::arg("hessian_rows"), nb::arg("hessian_columns"),
          nb::arg("processor") = "")
      .def("fill", &StageSystem::fill, nb::arg("jacobian"), nb::arg("hessian"))
      .def("solve", &StageSystem::solve, nb::arg("dx").none(), nb::arg("de").none(), nb::arg("ds"), nb::arg("f"),
           nb::arg("g"))
      .def("residual", &StageSystem::residual, nb::arg("dx"), nb::arg("de").none(), nb::arg("f"), nb::arg("g"),
           nb::arg("z"), nb::arg("lam"))
      .def("jacobian_times", &StageSystem::jacobian_times, nb::arg("x"))
      .def("transposed_times", &StageSystem::transposed_times, nb::arg("lam"))
      .def("hessian_times", &StageSystem::hessian_times, nb::arg("x"));
}

}  // namespace robotraj::native
