// The log of a solve, and where it may be ended.
#pragma once

#include <fatrop/ip_algorithm/ip_data.hpp>
#include <fatrop/ip_algorithm/ip_iteration_output.hpp>

#include <algorithm>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "solver.hpp"

namespace robotraj::native {

using Ocp = fatrop::OcpType;
using Data = fatrop::IpData<Ocp>;

/// Takes the place of fatrop's printing: keeps the log, and asks once an iteration whether to go on.
class Watch : public fatrop::IpIterationOutputBase {
 public:
  /// `stage` is the algorithm it stands in, `data` the original problem's, which has most of what is logged.
  Watch(std::shared_ptr<Data> stage, std::shared_ptr<Data> data, StageNlp& nlp, std::vector<Iteration>& trace)
      : stage_(std::move(stage)), data_(std::move(data)), nlp_(nlp), trace_(trace) {}

  void print_header() override {}
  void output_current_iteration() override {
    auto& iterate = stage_->current_iterate();
    auto& original = data_->current_iterate();
    trace_.push_back({original.obj_value() / nlp_.objective_scale, original.constr_viol_inf(),
                      std::max(iterate.dual_infeasibility_x_inf(), iterate.dual_infeasibility_s_inf()), iterate.mu()});
    // fatrop also writes the line after the last iteration, without the call that precedes the others.
    const bool going_on = nlp_.iterating || stage_ != data_;
    nlp_.iterating = false;
    if (going_on && check && *check)
      (*check)(static_cast<int>(stage_->iteration_number()), trace_.back()[0], trace_.back()[1]);
  }

  const std::function<void(int, double, double)>* check = nullptr;

 private:
  std::shared_ptr<Data> stage_, data_;
  StageNlp& nlp_;
  std::vector<Iteration>& trace_;
};

}  // namespace robotraj::native
