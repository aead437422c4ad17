// How fatrop's algorithm is started: by its own means, or from a point with multipliers.
#pragma once

#include <fatrop/common/options.hpp>
#include <fatrop/linear_algebra/linear_algebra.hpp>
#include <fatrop/ocp/hessian.hpp>
#include <fatrop/ocp/jacobian.hpp>
#include <fatrop/ip_algorithm/ip_data.hpp>
#include <fatrop/ip_algorithm/ip_eq_mult_initializer.hpp>
#include <fatrop/ip_algorithm/ip_initializer.hpp>
#include <fatrop/ocp/type.hpp>

#include <memory>

#include "solver.hpp"
#include "stage_nlp.hpp"

namespace robotraj::native {

/// fatrop's initializer where a start has no multipliers; else the slacks and multipliers of that start.
///
/// With the slack's distance d to a bound and that bound's multiplier z, both are moved onto d z >= mu: a multiplier
/// smaller than the distance grows, else the distance does. So a solution at mu starts where it ended, and a bound that
/// moved across its row starts at d = z = sqrt(mu) or beyond.
class Initializer : public fatrop::IpInitializerBase {
 public:
  using Data = fatrop::IpData<fatrop::OcpType>;

  Initializer(std::shared_ptr<Data> data, std::shared_ptr<fatrop::IpEqMultInitializerBase> multipliers,
              std::shared_ptr<Program> program, std::shared_ptr<StageNlp> nlp);

  void initialize() override;
  void reset() override { cold_.reset(); }
  void register_options(fatrop::OptionRegistry& registry) override { cold_.register_options(registry); }

  Start start;

 private:
  std::shared_ptr<Data> data_;
  std::shared_ptr<Program> program_;
  std::shared_ptr<StageNlp> nlp_;
  fatrop::IpInitializer<fatrop::OcpType> cold_;
  fatrop::VecRealAllocated y_, lam_, slacks_, lower_duals_, upper_duals_;
};

}  // namespace robotraj::native
