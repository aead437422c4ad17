#include "tape_block.hpp"

#include <algorithm>
#include <stdexcept>

namespace robotraj::native {

namespace {

void need(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(what);
}

/// Packs at `places` of two arrays that follow each other, the first of `first` packs.
double* gather(const std::vector<std::int32_t>& places, const double* one, std::size_t first, const double* two,
               std::size_t lanes, double* to) {
  for (const std::int32_t place : places) {
    const auto at = static_cast<std::size_t>(place);
    std::copy_n(at < first ? one + at * lanes : two + (at - first) * lanes, lanes, to);
    to += lanes;
  }
  return to;
}

}  // namespace

std::size_t Recipe::called() const {
  std::size_t numbers = 0;
  for (const Call& call : calls) numbers += call.tape->outputs();
  return numbers;
}

TapeBlock::TapeBlock(const PointSizes& sizes, Recipes recipes, std::optional<Torques> torques, const Kernels& kernels)
    : PointBlock(sizes), recipes_(std::move(recipes)), torques_(std::move(torques)), kernels_(kernels) {
  if (torques_) {
    const Pattern pattern = jacobian_pattern(torques_->robot.tree());
    for (std::size_t i = 0; i < pattern.size(); ++i)
      weighing_.push_back({pattern.columns[i], static_cast<std::int32_t>(i), pattern.rows[i]});
    hessian_numbers_ = hessian_pattern(torques_->robot.tree()).size();
    const std::size_t size = torques_->size();
    if (torques_->arguments.empty()) {
      need(torques_->places.size() == size, "the torques need a place for every argument");
      for (const std::int32_t place : torques_->places)
        need(place < static_cast<std::int32_t>(sizes.inputs), "an argument of the torques lies outside v");
    } else {
      using Inputs = std::vector<std::size_t>;
      need(torques_->arguments.outputs() >= size, "the tape of the torques' arguments gives too few");
      need(torques_->arguments.inputs() == Inputs{sizes.inputs, sizes.constants} &&
               torques_->curvature.inputs() == Inputs{sizes.inputs, sizes.constants, size},
           "the tapes of the torques' arguments take others than their block has");
    }
  }
  for (std::size_t i = 0; i < recipes_.size(); ++i)
    check(recipes_[i], i >= static_cast<std::size_t>(Evaluation::hessian));
}

TapeBlock::Parts TapeBlock::parts(const Recipe& recipe) const {
  Parts parts{};
  parts.jacobian = 1 + recipe.tape.outputs();
  parts.hessian = parts.jacobian + (recipe.jacobian ? weighing_.size() : 0);
  parts.arguments = parts.hessian + (recipe.hessian ? hessian_numbers_ : 0);
  parts.curvature = parts.arguments + (torques_ ? torques_->arguments.outputs() : 0);
  parts.calls = parts.curvature + (recipe.hessian ? torques_->curvature.outputs() : 0);
  parts.made = parts.calls + recipe.called();
  parts.end = parts.made + recipe.made;
  return parts;
}

void TapeBlock::check(const Recipe& recipe, bool multiplied) const {
  if (recipe.tape.empty()) return;
  std::vector<std::size_t> expected = {sizes().inputs, sizes().constants};
  if (torques_) expected.push_back(torques_->robot.tree().rates());
  if (multiplied) expected.push_back(sizes().outputs);
  need(recipe.tape.inputs() == expected, "a tape takes other arguments than its block has");
  need(torques_ || (!recipe.jacobian && !recipe.hessian), "derivatives of torques where there are none");
  if (recipe.hessian) {
    need(recipe.tape.outputs() >= torques_->robot.tree().rates(), "the tape gives no multipliers");
    need(recipe.jacobian || torques_->curvature.outputs() == 0, "curved arguments need the Jacobian of the torques");
  }
  for (const Call& call : recipe.calls) check(call, multiplied);
  const std::size_t end = parts(recipe).end;
  need(recipe.result + recipe.results <= end, "the result lies outside the buffer");
  for (const Product& each : recipe.products)
    for (const std::int32_t place : {each.out, each.left, each.right})
      need(place >= 0 && place < static_cast<std::int32_t>(end), "a product lies outside the buffer");
}

void TapeBlock::check(const Call& call, bool multiplied) const {
  std::vector<std::size_t> given = {call.inputs.size(), 0};
  if (multiplied) given.push_back(call.multipliers.size());
  need(call.tape && call.tape->inputs() == given, "a tape that is called takes other arguments than it is given");
  const auto inside = [](const std::vector<std::int32_t>& places, std::size_t size) {
    return std::all_of(places.begin(), places.end(),
                       [&](std::int32_t place) { return place >= 0 && static_cast<std::size_t>(place) < size; });
  };
  need(inside(call.inputs, sizes().inputs + sizes().constants) && inside(call.multipliers, sizes().outputs),
       "a call reads what lies outside v, c or m");
}

void TapeBlock::prepare(std::size_t threads) {
  const std::size_t lanes = kernels_.lanes;
  std::size_t tape = 0, buffer = 0, given = 0;
  if (torques_) tape = std::max(torques_->arguments.memory(), torques_->curvature.memory());
  for (const Recipe& recipe : recipes_) {
    tape = std::max(tape, recipe.tape.memory());
    buffer = std::max(buffer, parts(recipe).end);
    for (const Call& call : recipe.calls) {
      tape = std::max(tape, call.tape->memory());
      given = std::max(given, call.inputs.size() + call.multipliers.size());
    }
  }
  while (work_.size() < threads) {
    Work work;
    work.v.resize(sizes().inputs * lanes);
    work.c.resize(sizes().constants * lanes);
    work.m.resize(sizes().outputs * lanes);
    if (torques_) {
      work.x.resize(torques_->size() * lanes);
      work.g.resize(torques_->size() * lanes);
      work.tau.resize(torques_->robot.tree().rates() * lanes);
      work.states.resize(torques_->robot.tree().count * kernels_.state * lanes);
    }
    work.given.resize(given * lanes);
    work.tape.resize(tape * lanes);
    work.buffer.resize(buffer * lanes);
    work_.push_back(std::move(work));
  }
}

void TapeBlock::run_tape(const Tape& tape, std::initializer_list<const double*> arguments, Packs& memory,
                         double* result) const {
  kernels_.run(tape.code(), arguments.begin(), memory.data(), result);
}

const double* TapeBlock::arguments(Work& work, double* into) const {
  if (!torques_->arguments.empty()) {
    run_tape(torques_->arguments, {work.v.data(), work.c.data()}, work.tape, into);
    return into;
  }
  double* to = work.x.data();
  for (const std::int32_t place : torques_->places) {
    if (place < 0) std::fill_n(to, kernels_.lanes, 0.0);
    else std::copy_n(work.v.data() + place * kernels_.lanes, kernels_.lanes, to);
    to += kernels_.lanes;
  }
  return work.x.data();
}

void TapeBlock::run_calls(const Recipe& recipe, Work& work, double* results) const {
  const std::size_t lanes = kernels_.lanes;
  for (const Call& call : recipe.calls) {
    double* inputs = work.given.data();
    double* multipliers = gather(call.inputs, work.v.data(), sizes().inputs, work.c.data(), lanes, inputs);
    gather(call.multipliers, work.m.data(), sizes().outputs, nullptr, lanes, multipliers);
    run_tape(*call.tape, {inputs, nullptr, multipliers}, work.tape, results);
    results += call.tape->outputs() * lanes;
  }
}

void TapeBlock::run_pack(const Recipe& recipe, Work& work) const {
  const std::size_t lanes = kernels_.lanes;
  double* buffer = work.buffer.data();
  const Parts at = parts(recipe);
  const bool reads = torques_ && recipe.tape.reads(2), derived = recipe.jacobian || recipe.hessian;
  const double* x = reads || derived ? arguments(work, buffer + at.arguments * lanes) : nullptr;
  const auto differentiate = [&](bool derivatives) {
    const Tree tree = torques_->robot.tree();
    const double *w = x + tree.positions() * lanes, *a = w + tree.rates() * lanes;
    kernels_.rigid(tree, {x, w, a, buffer + lanes, work.states.data(), work.tau.data(),
                          derivatives && recipe.jacobian ? buffer + at.jacobian * lanes : nullptr,
                          derivatives && recipe.hessian ? buffer + at.hessian * lanes : nullptr});
  };
  // The Hessian's multipliers come from the tape, the tape's torques from the inverse dynamics.
  if (reads) differentiate(!recipe.hessian);
  run_tape(recipe.tape, {work.v.data(), work.c.data(), torques_ ? work.tau.data() : work.m.data(), work.m.data()},
           work.tape, buffer + lanes);
  if (derived && (recipe.hessian || !reads)) differentiate(true);
  if (at.calls > at.curvature) {
    std::fill(work.g.begin(), work.g.end(), 0.0);
    kernels_.multiply(weighing_.data(), weighing_.size(), buffer + at.jacobian * lanes, buffer + lanes, work.g.data());
    run_tape(torques_->curvature, {work.v.data(), work.c.data(), work.g.data()}, work.tape,
             buffer + at.curvature * lanes);
  }
  run_calls(recipe, work, buffer + at.calls * lanes);
  std::fill_n(buffer, lanes, 1.0);
  std::fill(buffer + at.made * lanes, buffer + at.end * lanes, 0.0);
  kernels_.multiply(recipe.products.data(), recipe.products.size(), buffer, buffer, buffer);
}

std::size_t TapeBlock::effort(const Recipe& recipe) const {
  // Measured on a core of 2023; only its order of magnitude matters.
  const bool derived = recipe.jacobian || recipe.hessian;
  const std::size_t a_joint = derived ? 1000 : torques_ && recipe.tape.reads(2) ? 450 : 0;
  std::size_t instructions = recipe.tape.code().count;
  for (const Call& call : recipe.calls) instructions += call.tape->code().count;
  return 3 * instructions + 2 * recipe.products.size() + (torques_ ? a_joint * torques_->robot.tree().count : 0);
}

void TapeBlock::evaluate(Evaluation which, const double* v, const double* c, const double* m, double* out,
                         ThreadPool& pool) {
  if (which == Evaluation::convex_hessian && !saturates()) which = Evaluation::hessian;
  const Recipe& recipe = recipes_[static_cast<std::size_t>(which)];
  const std::size_t inputs = sizes().inputs, constants = sizes().constants, outputs = sizes().outputs;
  const std::size_t lanes = kernels_.lanes;
  // Waking a thread, and waiting for one that has no core at the moment, costs more than little work does.
  constexpr std::size_t worthwhile = 200000;
  const bool alone = sizes().count / lanes * effort(recipe) < worthwhile;
  const std::size_t step = alone ? sizes().count : kMostLanes;
  pool.split(sizes().count, step, [&](std::size_t thread, std::size_t begin, std::size_t end) {
    Work& work = work_[thread];
    for (std::size_t point = begin; point < end; point += lanes) {
      const std::size_t points = std::min(lanes, end - point);
      load(v + point * inputs, inputs, points, lanes, work.v.data());
      load(c + point * constants, constants, points, lanes, work.c.data());
      if (m) load(m + point * outputs, outputs, points, lanes, work.m.data());
      run_pack(recipe, work);
      store(work.buffer.data() + recipe.result * lanes, recipe.results, points, lanes, out + point * recipe.results);
    }
  });
}

}  // namespace robotraj::native
