#include "solver.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "start.hpp"

namespace robotraj::interior_point {

namespace {

const char* status_of(End end) {
  switch (end) {
    case End::solved: return "solved";
    case End::acceptable: return "acceptable";
    case End::settled: return "settled";
    case End::iteration_limit: return "iteration limit";
    case End::processor_limit: return "time limit";
    case End::infeasible: return "infeasible";
    case End::line_search_failed: return "line search failed";
    case End::step_failed: return "step failed";
    case End::invalid_number: return "invalid number";
    default: return "failed";
  }
}

constexpr double kLargestEstimate = 1e6;  // of the rows' multipliers where those of the bounds are known

bool finite(const Numbers& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double each) { return std::isfinite(each); });
}

}  // namespace

Solver::Solver(std::shared_ptr<native::Program> program, native::Stages stages)
    : layout_(std::move(stages)), problem_(std::move(program), layout_), algorithm_(problem_, options_, progress_) {
  algorithm_.restoration = [this]() -> Restoration& {
    if (!restoration_) restoration_ = std::make_unique<Restoration>(problem_, options_, progress_);
    return *restoration_;
  };
  algorithm_.line = [this] {
    Iterate& at = *algorithm_.run.current;
    return Iteration{at.objective() / problem_.objective_scale, at.largest_violation(), at.largest_infeasibility(),
                     algorithm_.run.mu};
  };
}

Solver::~Solver() = default;

void Solver::begin(const Start& start) {
  const int slacks = layout_.slacks;
  problem_.objective_scale = start.objective_scale;
  for (int i = 0; i < slacks; ++i) {
    const auto room = [&](double bound) { return options_.bound_relaxation * std::max(1.0, std::abs(bound)); };
    problem_.lower[i] = std::isfinite(start.lower[i]) ? start.lower[i] - room(start.lower[i])
                                                      : -std::numeric_limits<double>::infinity();
    problem_.upper[i] =
        std::isfinite(start.upper[i]) ? start.upper[i] + room(start.upper[i]) : std::numeric_limits<double>::infinity();
  }
  problem_.bounds_changed();
  algorithm_.run.mu = options_.initial_barrier;
  const bool of_bounds = start.lower_duals && start.upper_duals;
  if (!start.lam && !of_bounds) return start_cold(algorithm_.run, start.y);
  Numbers rows(layout_.rows, 0.0), lower(slacks), upper(slacks);
  if (start.lam) std::copy_n(start.lam, rows.size(), rows.begin());
  for (double& each : rows) each *= start.objective_scale;
  for (int i = 0; i < slacks; ++i) {
    const double lam = rows[layout_.inequality_rows + i];
    lower[i] = start.lower_duals ? start.objective_scale * start.lower_duals[i] : std::max(0.0, -lam);
    upper[i] = start.upper_duals ? start.objective_scale * start.upper_duals[i] : std::max(0.0, lam);
  }
  start_warm(algorithm_.run, start.y, {rows.data(), lower.data(), upper.data()});
  if (!start.lam) estimate_multipliers(algorithm_.run, kLargestEstimate);
}

Outcome Solver::solve(const Start& start, const Options& options, std::function<void(int, double, double)> check) {
  const auto began = std::chrono::steady_clock::now();
  options_ = options;
  progress_.iterations = 0;
  progress_.trace.clear();
  progress_.check = std::move(check);
  problem_.program().times.clear();
  algorithm_.run.direction.seconds = 0.0;
  if (restoration_) restoration_->clear_seconds();

  Outcome outcome;
  try {
    begin(start);
    outcome.status = status_of(algorithm_.iterate(options_.initial_barrier));
  } catch (const Stop& stop) {
    outcome.status = stop.status;
  } catch (const std::exception& error) {
    outcome.status = "failed";
    outcome.message = error.what();
  }
  progress_.check = nullptr;
  collect(start, outcome);
  outcome.total = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return outcome;
}

Numbers Solver::iterate() const {
  const double* x = algorithm_.run.current->at->x;
  return {x, x + layout_.columns};
}

void Solver::collect(const Start& start, Outcome& outcome) {
  const Run& run = algorithm_.run;
  const Room& at = run.current->at;
  native::Program& program = problem_.program();
  outcome.functions = program.times.functions;
  outcome.combinations = program.times.combinations;
  outcome.linear_algebra = run.direction.seconds + (restoration_ ? restoration_->seconds() : 0.0);
  outcome.iterations = progress_.iterations;
  outcome.mu = run.mu;
  outcome.trace = progress_.trace;
  outcome.y = iterate();
  outcome.lam.assign(at->rows, at->rows + layout_.rows);
  outcome.lower_duals.assign(at->lower, at->lower + layout_.slacks);
  outcome.upper_duals.assign(at->upper, at->upper + layout_.slacks);
  for (Numbers* multipliers : {&outcome.lam, &outcome.lower_duals, &outcome.upper_duals})
    for (double& each : *multipliers) each /= problem_.objective_scale;
  program.set_point(outcome.y.data());
  outcome.objective = program.objective();
  const Numbers& values = program.row_values();
  for (int i = 0; i < layout_.rows; ++i) {
    const int k = i - layout_.inequality_rows;
    const double value = values[i];
    const double broken = k < 0 ? std::abs(value) : std::max(start.lower[k] - value, value - start.upper[k]);
    if (!(broken <= outcome.violation)) outcome.violation = broken;
    if (std::isnan(broken)) break;
  }
  // A largest magnitude ignores NaN.
  const bool claimed = outcome.status == "solved" || outcome.status == "acceptable" || outcome.status == "settled";
  if (claimed && !(std::isfinite(outcome.objective) && std::isfinite(outcome.violation) && finite(outcome.y) &&
                   finite(outcome.lam) && finite(outcome.lower_duals) && finite(outcome.upper_duals)))
    outcome.status = "invalid number";
}

}  // namespace robotraj::interior_point
