// Passes over slacks, bounds and multipliers from Python, for tests against their formulas.
#include "arrays.hpp"
#include "bindings.hpp"
#include "kernels/vector_kernels.hpp"

#include <nanobind/stl/string.h>

#include <vector>

namespace nb = nanobind;

namespace robotraj::native {

namespace {

using Numbers = std::vector<double>;

/// Bounds of slacks, and operations on vectors of their length.
class SlackVectors {
 public:
  SlackVectors(const Doubles& lower, const Doubles& upper, const std::string& processor)
      : lower_(lower.data(), lower.data() + lower.size()),
        upper_(checked(upper, lower.size(), "upper"), upper.data() + upper.size()),
        run_(vector_kernels_of(processor)) {}

  nb::tuple measures(const Doubles& x) const {
    const double* numbers = of(x);
    return nb::make_tuple(run_.largest(numbers, count()), run_.absolute_sum(numbers, count()),
                          run_.finite(numbers, count()));
  }
  Result add(const Doubles& x, const Doubles& y) const {
    Numbers out(lower_.size());
    run_.add(of(x), of(y), count(), out.data());
    return to_numpy(std::move(out));
  }
  nb::tuple distances(const Doubles& s) const {
    Numbers below(lower_.size()), above(lower_.size());
    const DistanceSums sums = run_.distances(bounds(), of(s), below.data(), above.data());
    const double logarithm = log_sum(sums, bounds(), below.data(), above.data());
    return nb::make_tuple(to_numpy(std::move(below)), to_numpy(std::move(above)), logarithm, sums.single);
  }
  nb::tuple barrier(const Doubles& below, const Doubles& above, double mu, double damping, const Doubles& ds) const {
    Numbers gradient(lower_.size());
    run_.barrier_gradient(bounds(), of(below), of(above), mu, damping, gradient.data());
    const double slope = run_.barrier_slope(bounds(), of(below), of(above), mu, damping, of(ds));
    return nb::make_tuple(to_numpy(std::move(gradient)), slope);
  }
  nb::tuple complementarity(const Doubles& below, const Doubles& above, const Doubles& lower_duals,
                            const Doubles& upper_duals, double mu) const {
    Numbers lower(lower_.size()), upper(lower_.size());
    run_.complementarity(lower_.data(), of(lower_duals), of(below), mu, count(), lower.data());
    run_.complementarity(upper_.data(), of(upper_duals), of(above), mu, count(), upper.data());
    const double largest =
        run_.largest_complementarity(bounds(), of(lower_duals), of(below), of(upper_duals), of(above), mu);
    return nb::make_tuple(to_numpy(std::move(lower)), to_numpy(std::move(upper)), largest);
  }
  double longest_step(const Doubles& below, const Doubles& above, const Doubles& ds, double tau) const {
    return run_.longest_step(bounds(), of(below), of(above), of(ds), tau);
  }
  double longest_dual_step(const Doubles& lower_duals, const Doubles& lower_step, const Doubles& upper_duals,
                           const Doubles& upper_step, double tau) const {
    return run_.longest_dual_step(bounds(), of(lower_duals), of(lower_step), of(upper_duals), of(upper_step), tau);
  }
  Result clamped(const Doubles& distance, const Doubles& z, double mu, double kappa) const {
    Numbers out(of(z), of(z) + lower_.size());
    run_.clamp_duals(lower_.data(), of(distance), mu, kappa, count(), out.data());
    return to_numpy(std::move(out));
  }

  /// `system` and `side` have the rows that SlackSystem and SlackSide name; lam follows from the weights and rows.
  nb::tuple eliminated(const Doubles& system, const Doubles& side) const {
    Numbers inverse(lower_.size()), gradient(lower_.size()), weights(lower_.size()), rows(lower_.size());
    run_.reduce(system_of(system), side_of(side), count(), inverse.data(), gradient.data(), weights.data(),
                rows.data());
    return nb::make_tuple(to_numpy(std::move(inverse)), to_numpy(std::move(gradient)), to_numpy(std::move(weights)),
                          to_numpy(std::move(rows)));
  }
  nb::tuple recovered(const Doubles& system, const Doubles& side, const Doubles& inverse, const Doubles& gradient,
                      const Doubles& lam) const {
    Numbers s(lower_.size()), lower(lower_.size()), upper(lower_.size());
    run_.recover(system_of(system), side_of(side), of(inverse), of(gradient), of(lam), count(),
                 {s.data(), lower.data(), upper.data()});
    return nb::make_tuple(to_numpy(std::move(s)), to_numpy(std::move(lower)), to_numpy(std::move(upper)));
  }
  /// `step` is [s, z_l, z_u]; returns the residuals of the three equations and the change of `rows`.
  nb::tuple residual(const Doubles& system, const Doubles& side, const Doubles& step, const Doubles& lam,
                     const Doubles& rows) const {
    Numbers solution(checked(step, 3 * lower_.size(), "step"), step.data() + step.size());
    Numbers left(3 * lower_.size()), changed(of(rows), of(rows) + lower_.size());
    const auto parts = [this](Numbers& all) {
      return SlackStep{all.data(), all.data() + lower_.size(), all.data() + 2 * lower_.size()};
    };
    const double largest = run_.slack_residual(system_of(system), side_of(side), parts(solution), of(lam), count(),
                                               parts(left), changed.data());
    return nb::make_tuple(to_numpy(std::move(left)), to_numpy(std::move(changed)), largest);
  }

 private:
  int count() const { return static_cast<int>(lower_.size()); }
  Bounds bounds() const { return {lower_.data(), upper_.data(), count()}; }
  const double* of(const Doubles& x) const { return checked(x, lower_.size(), "a vector of the slacks"); }
  SlackSystem system_of(const Doubles& all) const {
    const double* at = checked(all, 6 * lower_.size(), "system");
    const auto row = [&](std::size_t i) { return at + i * lower_.size(); };
    return {row(0), row(1), row(2), row(3), row(4), row(5)};
  }
  SlackSide side_of(const Doubles& all) const {
    const double* at = checked(all, 4 * lower_.size(), "side");
    const auto row = [&](std::size_t i) { return at + i * lower_.size(); };
    return {row(0), row(1), row(2), row(3)};
  }

  Numbers lower_, upper_;
  const VectorKernels& run_;
};

}  // namespace

void bind_vectors(nb::module_& m) {
  nb::class_<SlackVectors>(m, "SlackVectors")
      .def(nb::init<const Doubles&, const Doubles&, const std::string&>(), nb::arg("lower"), nb::arg("upper"),
           nb::arg("processor") = "")
      .def("measures", &SlackVectors::measures, nb::arg("x"))
      .def("add", &SlackVectors::add, nb::arg("x"), nb::arg("y"))
      .def("distances", &SlackVectors::distances, nb::arg("s"))
      .def("barrier", &SlackVectors::barrier, nb::arg("below"), nb::arg("above"), nb::arg("mu"), nb::arg("damping"),
           nb::arg("ds"))
      .def("complementarity", &SlackVectors::complementarity, nb::arg("below"), nb::arg("above"),
           nb::arg("lower_duals"), nb::arg("upper_duals"), nb::arg("mu"))
      .def("longest_step", &SlackVectors::longest_step, nb::arg("below"), nb::arg("above"), nb::arg("ds"),
           nb::arg("tau"))
      .def("longest_dual_step", &SlackVectors::longest_dual_step, nb::arg("lower_duals"), nb::arg("lower_step"),
           nb::arg("upper_duals"), nb::arg("upper_step"), nb::arg("tau"))
      .def("clamped", &SlackVectors::clamped, nb::arg("distance"), nb::arg("z"), nb::arg("mu"), nb::arg("kappa"))
      .def("eliminated", &SlackVectors::eliminated, nb::arg("system"), nb::arg("side"))
      .def("recovered", &SlackVectors::recovered, nb::arg("system"), nb::arg("side"), nb::arg("inverse"),
           nb::arg("gradient"), nb::arg("lam"))
      .def("residual", &SlackVectors::residual, nb::arg("system"), nb::arg("side"), nb::arg("step"), nb::arg("lam"),
           nb::arg("rows"));
}

}  // namespace robotraj::native
