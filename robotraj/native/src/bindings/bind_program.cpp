// The program and its solver from Python.
#include "arrays.hpp"
#include "bindings.hpp"
#include "interior_point/solver.hpp"

#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <atomic>
#include <chrono>
#include <limits>
#include <optional>

namespace nb = nanobind;

namespace robotraj::native {

namespace {

using interior_point::Options;
using interior_point::Outcome;
using interior_point::Solver;
using interior_point::Start;
using interior_point::Stop;

/// A program with the solver that is kept for it.
struct Solved {
  std::shared_ptr<Program> program;
  std::unique_ptr<Solver> solver;
  std::atomic<bool> busy{false};
};

/// Refuses a second call, from another thread or from a callback: both would use the same memory.
class Alone {
 public:
  explicit Alone(std::atomic<bool>& busy) : busy_(busy) {
    if (busy_.exchange(true))
      throw std::runtime_error(
          "this program is busy in another call, which works in the same memory; work meanwhile takes a second "
          "program");
  }
  ~Alone() { busy_.store(false); }
  Alone(const Alone&) = delete;
  Alone& operator=(const Alone&) = delete;

 private:
  std::atomic<bool>& busy_;
};

/// Calls Python once an iteration, which may end the solve.
class Check {
 public:
  Check(nb::object callback, double time_limit)
      : callback_(std::move(callback)), time_limit_(time_limit), began_(Clock::now()), last_(began_), looked_(began_) {}

  void operator()(int iteration, double objective, double infeasibility) {
    const auto now = Clock::now();
    // The next iteration may take as long as the last one; the first one follows a start of unknown length.
    const double next = iteration > 0 ? seconds(now - last_) : 0.0;
    if (seconds(now - began_) + next > time_limit_) throw Stop{"time limit"};
    last_ = now;
    // Ctrl-C is checked only at intervals, since the interpreter's lock may be held by another thread.
    if (callback_.is_none() && seconds(now - looked_) < 0.05) return;
    looked_ = now;
    nb::gil_scoped_acquire held;
    bool stop = false;
    try {
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
      if (!callback_.is_none()) stop = nb::cast<bool>(nb::bool_(callback_(iteration, objective, infeasibility)));
    } catch (nb::python_error& error) {
      if (error.matches(PyExc_KeyboardInterrupt)) throw Stop{"interrupted"};
      raised.emplace(error);
      stop = true;
    }
    if (stop) throw Stop{"stopped"};
  }

  std::optional<nb::python_error> raised;

 private:
  using Clock = std::chrono::steady_clock;
  static double seconds(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

  nb::object callback_;
  double time_limit_;
  Clock::time_point began_, last_, looked_;
};

using Optional = std::optional<Doubles>;

const double* given(const Optional& array, std::size_t length, const char* name) {
  return array ? checked(*array, length, name) : nullptr;
}

Outcome solve(Solved& self, const Doubles& y, const Doubles& lower, const Doubles& upper, const Options& options,
              const Optional& lam, const Optional& lower_duals, const Optional& upper_duals, double objective_scale,
              nb::object callback, double time_limit) {
  const std::size_t slacks = static_cast<std::size_t>(self.solver->slacks());
  Start start;
  start.y = checked(y, self.program->columns(), "y");
  start.lower = checked(lower, slacks, "lower");
  start.upper = checked(upper, slacks, "upper");
  start.lam = given(lam, self.program->rows(), "lam");
  start.lower_duals = given(lower_duals, slacks, "lower_duals");
  start.upper_duals = given(upper_duals, slacks, "upper_duals");
  start.objective_scale = objective_scale;
  const Alone alone(self.busy);
  Check check(std::move(callback), time_limit);
  Outcome outcome;
  {
    nb::gil_scoped_release released;
    outcome = self.solver->solve(start, options, [&check](int iteration, double objective, double infeasibility) {
      check(iteration, objective, infeasibility);
    });
  }
  if (check.raised) throw nb::python_error(*check.raised);
  return outcome;
}

/// What `evaluate` gives of the program at y.
template <typename Evaluate>
auto at(Solved& self, const Doubles& y, Evaluate&& evaluate) {
  const Alone alone(self.busy);
  self.program->set_point(checked(y, self.program->columns(), "y"));
  return evaluate(*self.program);
}

}  // namespace

void bind_program(nb::module_& m) {
  nb::class_<Term>(m, "Term").def(
      "__init__",
      [](Term* self, std::shared_ptr<PointBlock> block, const Csr& gather, const Doubles& gather_offset,
         const Doubles& constants, std::optional<Csr> scatter, std::optional<Doubles> weights,
         std::optional<Csr> gradient, std::optional<Csr> jacobian, std::optional<Stacked> hessian) {
        new (self) Term{std::move(block),           gather,
                        copied(gather_offset),      copied(constants),
                        scatter.value_or(Csr()),    weights ? copied(*weights) : Numbers(),
                        gradient.value_or(Csr()),   jacobian.value_or(Csr()),
                        hessian.value_or(Stacked())};
      },
      nb::arg("block"), nb::arg("gather"), nb::arg("gather_offset"), nb::arg("constants"),
      nb::arg("scatter") = nb::none(), nb::arg("weights") = nb::none(), nb::arg("gradient") = nb::none(),
      nb::arg("jacobian") = nb::none(), nb::arg("hessian") = nb::none());

  nb::class_<Solved>(m, "Program")
      .def(
          "__init__",
          [](Solved* self, const Indices& controls, const Indices& states, const Indices& equalities,
             const Indices& inequalities, const Csr& linear, const Doubles& offset, const Doubles& cost,
             double cost_offset, const Narrow& jacobian_rows, const Narrow& jacobian_columns,
             const Doubles& jacobian_constants, const Narrow& hessian_rows, const Narrow& hessian_columns,
             const std::vector<Term*>& terms, std::size_t threads, const std::optional<Narrow>& groups) {
            std::vector<Term> copies;
            for (const Term* term : terms) copies.push_back(*term);
            auto program = std::make_shared<Program>(
                LinearPart{linear, copied(offset), copied(cost), cost_offset, copied(jacobian_constants)},
                Pattern{copied(jacobian_rows), copied(jacobian_columns)},
                Pattern{copied(hessian_rows), copied(hessian_columns)}, std::move(copies), threads,
                groups ? copied(*groups) : std::vector<std::int32_t>());
            auto solver = std::make_unique<Solver>(
                program, Stages{narrow(controls), narrow(states), narrow(equalities), narrow(inequalities)});
            new (self) Solved{std::move(program), std::move(solver)};
          },
          nb::arg("controls"), nb::arg("states"), nb::arg("equalities"), nb::arg("inequalities"), nb::arg("linear"),
          nb::arg("offset"), nb::arg("cost"), nb::arg("cost_offset"), nb::arg("jacobian_rows"),
          nb::arg("jacobian_columns"), nb::arg("jacobian_constants"), nb::arg("hessian_rows"),
          nb::arg("hessian_columns"), nb::arg("terms"), nb::arg("threads") = 1, nb::arg("groups") = nb::none())
      .def_prop_ro(
          "iterate", [](const Solved& self) { return to_numpy(self.solver->iterate()); }, nb::rv_policy::move)
      .def_prop_ro("threads", [](const Solved& self) { return self.program->threads(); })
      .def("solve", solve, nb::arg("y"), nb::arg("lower"), nb::arg("upper"), nb::arg("options") = Options(),
           nb::kw_only(), nb::arg("lam") = nb::none(), nb::arg("lower_duals") = nb::none(),
           nb::arg("upper_duals") = nb::none(), nb::arg("objective_scale") = 1.0, nb::arg("callback") = nb::none(),
           nb::arg("time_limit") = std::numeric_limits<double>::infinity())
      .def(
          "set_offsets",
          [](Solved& self, const Doubles& offset, double cost_offset) {
            const Alone alone(self.busy);
            self.program->set_offsets(checked(offset, self.program->rows(), "offset"), cost_offset);
          },
          nb::arg("offset"), nb::arg("cost_offset"))
      .def(
          "set_block_offsets",
          [](Solved& self, std::size_t block, const Doubles& offset) {
            const Alone alone(self.busy);
            const auto& term = self.program->terms().at(block);
            self.program->set_gather_offset(block, checked(offset, term.gather_offset.size(), "offset"));
          },
          nb::arg("block"), nb::arg("offset"))
      .def(
          "set_constants",
          [](Solved& self, std::size_t block, const Doubles& constants) {
            const Alone alone(self.busy);
            const auto& term = self.program->terms().at(block);
            self.program->set_constants(block, checked(constants, term.constants.size(), "constants"));
          },
          nb::arg("block"), nb::arg("constants"))
      .def(
          "rows",
          [](Solved& self, const Doubles& y) {
            return at(self, y, [](Program& program) { return to_numpy(program.row_values()); });
          },
          nb::arg("y"))
      .def(
          "objective",
          [](Solved& self, const Doubles& y) {
            return at(self, y, [](Program& program) { return program.objective(); });
          },
          nb::arg("y"))
      .def(
          "gradient",
          [](Solved& self, const Doubles& y) {
            return at(self, y, [](Program& program) { return to_numpy(program.gradient()); });
          },
          nb::arg("y"))
      .def(
          "jacobian",
          [](Solved& self, const Doubles& y) {
            return at(self, y, [](Program& program) { return to_numpy(program.jacobian()); });
          },
          nb::arg("y"))
      .def(
          "hessian",
          [](Solved& self, const Doubles& y, const Doubles& lam, double lam_f) {
            const double* multipliers = checked(lam, self.program->rows(), "lam");
            return at(self, y, [&](Program& program) { return to_numpy(program.hessian(multipliers, lam_f)); });
          },
          nb::arg("y"), nb::arg("lam"), nb::arg("lam_f") = 1.0);
}

}  // namespace robotraj::native
