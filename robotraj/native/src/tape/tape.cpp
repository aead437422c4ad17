#include "tape.hpp"

// calculus.hpp uses macros that headers of function.hpp define.
#include <casadi/core/function.hpp>

#include <casadi/core/calculus.hpp>

#include <cstring>
#include <numeric>
#include <unordered_map>

namespace robotraj::native {

namespace {

/// Whether CasADi computes an operation from one or two numbers alone.
bool elementary(casadi_int operation) {
  switch (operation) {
    case casadi::OP_ERFINV:
    case casadi::OP_LOG1P:
    case casadi::OP_EXPM1:
    case casadi::OP_HYPOT:
    case casadi::OP_REMAINDER: return true;
    default: return operation <= casadi::OP_ATAN2;
  }
}

/// Numbers of constants by their bits: 0.0 and -0.0 differ.
class Constants {
 public:
  std::int32_t place(double value) {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    const auto [found, added] = places_.emplace(bits, static_cast<std::int32_t>(values.size()));
    if (added) values.push_back(value);
    return found->second;
  }

  std::vector<double> values;

 private:
  std::unordered_map<std::uint64_t, std::int32_t> places_;
};

}  // namespace

Tape::Tape(const casadi::Function& function) {
  if (!function.is_a("SXFunction") || function.n_out() != 1 || !function.sparsity_out(0).is_dense())
    throw NotATape("a tape is made of a scalar graph with one dense result; " + function.name() + " is none");
  for (casadi_int i = 0; i < function.n_in(); ++i) inputs_.push_back(function.nnz_in(i));
  read_.resize(inputs_.size());
  outputs_ = function.nnz_out(0);
  work_ = function.sz_w();
  std::vector<std::size_t> begin(inputs_.size() + 1, work_);
  std::partial_sum(inputs_.begin(), inputs_.end(), begin.begin() + 1, std::plus<>());
  for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += work_;
  const auto constants_at = static_cast<std::int32_t>(begin.back());

  // Arguments and constants are read in place: an entry of the work vector may be an alias of one of them.
  std::vector<std::int32_t> meant(work_);
  std::iota(meant.begin(), meant.end(), 0);
  Constants constants;
  const std::int32_t minus_zero = constants_at + constants.place(-0.0);
  std::vector<std::pair<std::int32_t, casadi_int>> results;
  const casadi_int count = function.n_instructions();
  instructions_.reserve(count);
  for (casadi_int k = 0; k < count; ++k) {
    const casadi_int operation = function.instruction_id(k);
    const std::vector<casadi_int> out = function.instruction_output(k);
    if (operation == casadi::OP_CONST) {
      meant[out[0]] = constants_at + constants.place(function.instruction_constant(k));
      continue;
    }
    const std::vector<casadi_int> in = function.instruction_input(k);
    if (operation == casadi::OP_INPUT) {
      meant[out[0]] = static_cast<std::int32_t>(begin[in[0]] + in[1]);
      read_[in[0]] = true;
      continue;
    }
    const std::int32_t first = meant[in[0]], second = in.size() > 1 ? meant[in[1]] : first;
    if (operation == casadi::OP_OUTPUT) {
      // The results begin after the constants, once all of these are known.
      results.emplace_back(static_cast<std::int32_t>(instructions_.size()), out[1]);
      instructions_.push_back({0, first, minus_zero, Step::add, 0});
      continue;
    }
    const auto to = static_cast<std::int32_t>(out[0]);
    meant[to] = to;
    Instruction next{to, first, second, Step::add, static_cast<std::int16_t>(operation)};
    switch (operation) {
      case casadi::OP_ASSIGN: next.second = minus_zero; break;
      case casadi::OP_ADD:
      case casadi::OP_TWICE: break;
      case casadi::OP_SUB: next.step = Step::subtract; break;
      case casadi::OP_NEG: next.first = minus_zero, next.second = first, next.step = Step::subtract; break;
      case casadi::OP_MUL:
      case casadi::OP_SQ: next.step = Step::multiply; break;
      case casadi::OP_DIV: next.step = Step::divide; break;
      case casadi::OP_INV:
        next.step = Step::divide, next.first = constants_at + constants.place(1.0), next.second = first;
        break;
      default:
        if (!elementary(operation)) throw NotATape(function.name() + " calls another function");
        next.step = Step::other;
    }
    instructions_.push_back(next);
  }
  constants_ = std::move(constants.values);
  result_ = constants_at + constants_.size();
  for (const auto& [instruction, place] : results)
    instructions_[instruction].out = static_cast<std::int32_t>(result_ + place);
}

TapeCode Tape::code() const {
  return {instructions_.data(), instructions_.size(), inputs_.data(), inputs_.size(),
          constants_.data(),    constants_.size(),    work_,          outputs_};
}

double compute(std::int16_t operation, double x, double y) {
  double result = 0.0;
  casadi::casadi_math<double>::fun(static_cast<unsigned char>(operation), x, y, result);
  return result;
}

}  // namespace robotraj::native
