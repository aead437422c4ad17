// fatrop's restoration phase, put together from its own parts and made when it is needed.
#pragma once

#include <fatrop/common/options.hpp>
#include <fatrop/ip_algorithm/ip_algorithm.hpp>
#include <fatrop/ip_algorithm/ip_convergence_check_resto.hpp>
#include <fatrop/ip_algorithm/ip_eq_mult_initializer.hpp>
#include <fatrop/ip_algorithm/ip_initializer_resto.hpp>
#include <fatrop/ip_algorithm/ip_linesearch.hpp>
#include <fatrop/ip_algorithm/ip_mu_update.hpp>
#include <fatrop/ip_algorithm/ip_nlp_orig.hpp>
#include <fatrop/ip_algorithm/ip_nlp_resto.hpp>
#include <fatrop/ip_algorithm/ip_resto_phase_min_cl1.hpp>
#include <fatrop/ocp/pd_solver_orig.hpp>
#include <fatrop/ocp/pd_solver_resto.hpp>
#include <fatrop/ocp/pd_system_orig.hpp>
#include <fatrop/ocp/pd_system_resto.hpp>

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "search_direction.hpp"
#include "watch.hpp"

namespace robotraj::native {

/// fatrop's restoration phase: an algorithm of its own, on the problem of least infeasibility.
struct Restoration {
  using Solve = fatrop::PdSolverOrig<Ocp>;

  Restoration(const std::shared_ptr<fatrop::IpNlpOrig<Ocp>>& original, const std::shared_ptr<Data>& data_original,
              const std::shared_ptr<Solve>& solve, const std::shared_ptr<fatrop::IpLinesearch<Solve, Ocp>>& search,
              StageNlp& nlp, std::vector<Iteration>& trace)
      : nlp_restored(std::make_shared<fatrop::IpNlpResto<Ocp>>(original)),
        data(std::make_shared<Data>(nlp_restored)),
        watch(std::make_shared<Watch>(data, data_original, nlp, trace)) {
    using SolveRestoration = fatrop::PdSolverResto<Ocp>;
    const auto solve_restoration = std::make_shared<SolveRestoration>(nlp.info(), solve);
    using Step = FatropStep<SolveRestoration>;
    const auto direction = std::make_shared<SearchDirection<Step>>(
        data, std::make_unique<Step>(data->current_iterate(), solve_restoration));
    const auto line_search =
        std::make_shared<fatrop::IpLinesearch<SolveRestoration, Ocp>>(data, solve_restoration, nullptr);
    const auto converged = std::make_shared<fatrop::IpConvergenceCheckResto<Ocp>>(data_original, data);
    const auto barrier = std::make_shared<fatrop::IpMonotoneMuUpdate<Ocp>>(data, line_search);
    const auto multipliers = std::make_shared<fatrop::IpEqMultInitializer<Ocp>>(data, solve);
    const auto start = std::make_shared<fatrop::IpInitializerResto<Ocp>>(data_original, data);
    phase = std::make_shared<fatrop::IpRestoPhaseMinCl1<Ocp>>(
        std::make_shared<fatrop::IpAlgorithm<Ocp>>(direction, line_search, start, barrier, multipliers, converged,
                                                   watch, data),
        multipliers, data_original, data, nlp_restored);
    converged->set_line_search_orig(search);
    nlp_restored->register_options(options);
    data->register_options(options);
    direction->register_options(options);
    line_search->register_options(options);
    converged->register_options(options);
    barrier->register_options(options);
    multipliers->register_options(options);
    start->register_options(options);
    phase->register_options(options);
  }

  std::shared_ptr<fatrop::IpNlpResto<Ocp>> nlp_restored;
  std::shared_ptr<Data> data;
  std::shared_ptr<Watch> watch;
  std::shared_ptr<fatrop::IpRestoPhaseMinCl1<Ocp>> phase;
  fatrop::OptionRegistry options;
};

/// A restoration phase that is made when it is first entered: few solves do, and it takes as much memory as the rest.
class LateRestoration : public fatrop::IpRestoPhaseBase {
 public:
  explicit LateRestoration(std::function<std::unique_ptr<Restoration>()> make) : make_(std::move(make)) {}

  /// Null until it was entered or asked for.
  Restoration* made() const { return made_.get(); }
  Restoration& now() {
    if (!made_) made_ = make_();
    return *made_;
  }
  bool perform_restoration() override { return now().phase->perform_restoration(); }
  void reset() override {
    if (made_) made_->phase->reset();
  }
  void register_options(fatrop::OptionRegistry&) override {}  // it has a registry of its own

 private:
  std::function<std::unique_ptr<Restoration>()> make_;
  std::unique_ptr<Restoration> made_;
};

}  // namespace robotraj::native
