#include "solver.hpp"

#include <fatrop/common/options.hpp>
#include <fatrop/common/printing.hpp>
#include <fatrop/ip_algorithm/ip_algorithm.hpp>
#include <fatrop/ip_algorithm/ip_convergence_check.hpp>
#include <fatrop/ip_algorithm/ip_data.hpp>
#include <fatrop/ip_algorithm/ip_eq_mult_initializer.hpp>
#include <fatrop/ip_algorithm/ip_linesearch.hpp>
#include <fatrop/ip_algorithm/ip_mu_update.hpp>
#include <fatrop/ip_algorithm/ip_nlp_orig.hpp>
#include <fatrop/linear_algebra/linear_algebra.hpp>
#include <fatrop/ocp/aug_system_solver.hpp>
#include <fatrop/ocp/hessian.hpp>
#include <fatrop/ocp/jacobian.hpp>
#include <fatrop/ocp/pd_solver_orig.hpp>
#include <fatrop/ocp/pd_system_orig.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>

#include "restoration.hpp"
#include "search_direction.hpp"
#include "stage_step.hpp"
#include "warm_start.hpp"
#include "watch.hpp"

namespace robotraj::native {

namespace {

const char* status_of(fatrop::IpSolverReturnFlag flag) {
  switch (flag) {
    case fatrop::IpSolverReturnFlag::Success: return "solved";
    case fatrop::IpSolverReturnFlag::StopAtAcceptablePoint: return "acceptable";
    case fatrop::IpSolverReturnFlag::MaxIterExceeded: return "iteration limit";
    case fatrop::IpSolverReturnFlag::LocalInfeasibility: return "infeasible";
    case fatrop::IpSolverReturnFlag::LineSearchFailed: return "line search failed";
    case fatrop::IpSolverReturnFlag::ErrorInStepComputation: return "step failed";
    default: return "failed";
  }
}

/// Set an option in a registry that has it.
void set_option(fatrop::OptionRegistry& registry, const std::string& name, const Option& value) {
  const auto type = registry.get_option_type(name);
  if (type == fatrop::OptionTypeId::Unknown) return;
  const auto* number = std::get_if<int>(&value);
  if (number && type == fatrop::OptionTypeId::Scalar)
    registry.set_option(name, static_cast<double>(*number));
  else
    std::visit([&](const auto& plain) { registry.set_option(name, plain); }, value);
}

/// Add the names of a registry, which it tells only in what it prints: "  name of type n".
void collect_names(const fatrop::OptionRegistry& registry, std::set<std::string>& names) {
  std::ostringstream printed;
  printed << registry;
  std::istringstream lines(printed.str());
  std::string line;
  while (std::getline(lines, line)) {
    const auto end = line.find(" of type ");
    if (line.rfind("  ", 0) == 0 && end != std::string::npos) names.insert(line.substr(2, end - 2));
  }
}

}  // namespace

/// fatrop's parts, joined as its own builder joins them, with our start, search direction and log in their places.
struct Solver::Algorithm {
  using Solve = fatrop::PdSolverOrig<Ocp>;

  explicit Algorithm(const std::shared_ptr<Program>& program, const std::shared_ptr<StageNlp>& nlp)
      : original(std::make_shared<fatrop::IpNlpOrig<Ocp>>(nlp)), data(std::make_shared<Data>(original)) {
    const fatrop::ProblemInfo<Ocp>& info = nlp->info();
    // Where the systems are solved here, fatrop's solver of them is asked for nothing: as small as can be.
    const auto system = std::make_shared<fatrop::AugSystemSolver<Ocp>>(
        nlp->parts() ? fatrop::ProblemInfo<Ocp>(fatrop::ProblemDims<Ocp>(1, {0}, {1}, {0}, {0})) : info);
    solve = std::make_shared<Solve>(info, system);
    restoration = std::make_shared<LateRestoration>([this, &stages = *nlp] {
      auto made = std::make_unique<Restoration>(original, data, solve, search, stages, trace);
      made->watch->check = watch->check;
      for (const auto& [name, value] : given) set_option(made->options, name, value);
      return made;
    });
    std::shared_ptr<fatrop::IpSearchDirBase> direction;
    if (nlp->parts()) direction = direct(std::make_unique<StageStep>(*nlp->parts()));
    else direction = direct(std::make_unique<FatropStep<Solve>>(data->current_iterate(), solve));
    search = std::make_shared<fatrop::IpLinesearch<Solve, Ocp>>(data, solve, restoration);
    const auto multipliers = std::make_shared<fatrop::IpEqMultInitializer<Ocp>>(data, solve);
    start = std::make_shared<Initializer>(data, multipliers, program, nlp);
    const auto barrier = std::make_shared<fatrop::IpMonotoneMuUpdate<Ocp>>(data, search);
    const auto converged = std::make_shared<fatrop::IpConvergenceCheck<Ocp>>(data);
    watch = std::make_shared<Watch>(data, data, *nlp, trace);
    algorithm = std::make_unique<fatrop::IpAlgorithm<Ocp>>(direction, search, start, barrier, multipliers, converged,
                                                           watch, data);

    original->register_options(options);
    data->register_options(options);
    system->register_options(options);
    if (nlp->parts()) nlp->parts()->serve(options);
    direction->register_options(options);
    search->register_options(options);
    multipliers->register_options(options);
    start->register_options(options);
    barrier->register_options(options);
    converged->register_options(options);
    // fatrop takes a pivot below 1e-6 of its diagonal for a negative one. Near a solution every active bound adds
    // 1 / mu to a diagonal: that is not curvature lost, and damping it would end Newton's convergence.
    options.set_option("linsol_pivot_tol", 1e-14);
  }

  template <typename Step>
  std::shared_ptr<fatrop::IpSearchDirBase> direct(std::unique_ptr<Step> step) const {
    return std::make_shared<SearchDirection<Step>>(data, std::move(step));
  }

  /// Whether there is such an option; the restoration phase has some of its own.
  bool knows(const std::string& name) {
    return options.get_option_type(name) != fatrop::OptionTypeId::Unknown ||
           restoration->now().options.get_option_type(name) != fatrop::OptionTypeId::Unknown;
  }
  void set(const std::string& name, const Option& value) {
    set_option(options, name, value);
    if (Restoration* made = restoration->made()) set_option(made->options, name, value);
    given[name] = value;
  }
  void check(const std::function<void(int, double, double)>* asked) {
    watch->check = asked;
    if (Restoration* made = restoration->made()) made->watch->check = asked;
  }

  std::shared_ptr<fatrop::IpNlpOrig<Ocp>> original;
  std::shared_ptr<Data> data;
  std::shared_ptr<Solve> solve;
  std::shared_ptr<LateRestoration> restoration;
  std::shared_ptr<fatrop::IpLinesearch<Solve, Ocp>> search;
  std::shared_ptr<Initializer> start;
  std::shared_ptr<Watch> watch;
  std::unique_ptr<fatrop::IpAlgorithm<Ocp>> algorithm;
  fatrop::OptionRegistry options;
  Options given;
  std::vector<Iteration> trace;
};

Solver::Solver(std::shared_ptr<Program> program, const Stages& stages)
    : program_(std::move(program)),
      nlp_(std::make_shared<StageNlp>(program_, stages)),
      algorithm_(make()) {}

Solver::~Solver() = default;

std::unique_ptr<Solver::Algorithm> Solver::make() const {
  const StageParts::Lent lent(nlp_->parts());  // fatrop's matrices are made now
  return std::make_unique<Algorithm>(program_, nlp_);
}

std::vector<std::string> Solver::option_names() const {
  std::set<std::string> names;
  collect_names(algorithm_->options, names);
  collect_names(algorithm_->restoration->now().options, names);
  return {names.begin(), names.end()};
}

void Solver::set_options(const Options& options) {
  // fatrop does not tell its defaults, so an option that is given up asks for a new algorithm.
  for (const auto& [name, value] : options_)
    if (!options.count(name)) {
      algorithm_ = make();
      break;
    }
  options_ = options;
  for (const auto& [name, value] : options) {
    if (!algorithm_->knows(name)) {
      std::string message = "fatrop has no option '" + name + "'; it has";
      for (const std::string& known : option_names()) message += " " + known;
      throw std::invalid_argument(message);
    }
    try {
      algorithm_->set(name, value);
    } catch (const std::runtime_error& error) {
      throw std::invalid_argument(error.what());
    }
  }
}

Outcome Solver::solve(const Start& start, const Options& options,
                      const std::function<void(int, double, double)>& check) {
  const auto began = std::chrono::steady_clock::now();
  Options wanted = options;
  if (start.mu > 0.0) wanted["mu_init"] = start.mu;
  set_options(wanted);
  nlp_->objective_scale = start.objective_scale;
  std::copy_n(start.y, program_->columns(), nlp_->start.data());
  std::copy_n(start.lower, nlp_->lower.size(), nlp_->lower.data());
  std::copy_n(start.upper, nlp_->upper.size(), nlp_->upper.data());
  Algorithm& run = *algorithm_;
  run.trace.clear();
  run.start->start = start;
  run.check(&check);
  nlp_->iterating = false;
  program_->times.clear();

  Outcome outcome;
  const StageParts::Lent lent(nlp_->parts());
  try {
    outcome.status = status_of(run.algorithm->optimize());
  } catch (const Stop& stop) {
    outcome.status = stop.status;
  } catch (const std::exception& error) {
    outcome.status = "failed";
    outcome.message = error.what();
  }
  collect(outcome);
  outcome.total = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return outcome;
}

void Solver::collect(Outcome& outcome) {
  Algorithm& run = *algorithm_;
  auto& iterate = run.data->current_iterate();
  const std::size_t rows = program_->rows(), slacks = nlp_->lower.size();
  outcome.functions = program_->times.functions;
  outcome.combinations = program_->times.combinations;
  outcome.linear_algebra = run.data->timing_statistics().compute_search_dir.elapsed();
  if (Restoration* made = run.restoration->made())
    outcome.linear_algebra += made->data->timing_statistics().compute_search_dir.elapsed();
  outcome.iterations = static_cast<int>(run.data->iteration_number());
  outcome.mu = iterate.mu();
  outcome.trace = run.trace;
  outcome.y.assign(iterate.primal_x().data(), iterate.primal_x().data() + program_->columns());
  outcome.lam.resize(rows);
  if (rows) nlp_->rows_from_fatrop(iterate.dual_eq().data(), outcome.lam.data());
  if (slacks) {
    outcome.lower_duals.assign(iterate.dual_bounds_l().data(), iterate.dual_bounds_l().data() + slacks);
    outcome.upper_duals.assign(iterate.dual_bounds_u().data(), iterate.dual_bounds_u().data() + slacks);
  }
  for (Numbers* multipliers : {&outcome.lam, &outcome.lower_duals, &outcome.upper_duals})
    for (double& each : *multipliers) each /= nlp_->objective_scale;
  program_->set_point(outcome.y.data());
  outcome.objective = program_->objective();
  const Numbers& values = program_->row_values();
  for (std::size_t i = 0; i < rows; ++i) {
    const bool equality = i < rows - slacks;
    const std::size_t k = equality ? 0 : i - (rows - slacks);
    const double broken =
        equality ? std::abs(values[i]) : std::max(nlp_->lower[k] - values[i], values[i] - nlp_->upper[k]);
    if (!(broken <= outcome.violation)) outcome.violation = broken;
    if (std::isnan(broken)) break;
  }
  // fatrop's norms pass over what is no number.
  const auto finite = [](const Numbers& numbers) {
    return std::all_of(numbers.begin(), numbers.end(), [](double each) { return std::isfinite(each); });
  };
  const bool claimed = outcome.status == "solved" || outcome.status == "acceptable";
  if (claimed && !(std::isfinite(outcome.objective) && std::isfinite(outcome.violation) && finite(outcome.y) &&
                   finite(outcome.lam) && finite(outcome.lower_duals) && finite(outcome.upper_duals)))
    outcome.status = "invalid number";
}

}  // namespace robotraj::native
