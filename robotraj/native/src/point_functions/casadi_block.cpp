#include "casadi_block.hpp"

#include "bindings/arrays.hpp"
#include "bindings/bindings.hpp"

#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <iterator>
#include <limits>

namespace nb = nanobind;

namespace robotraj::native {

PointFunction::PointFunction(const std::string& name, const std::string& text, std::size_t batch,
                             const std::vector<std::size_t>& arguments, std::size_t results)
    : batch_(batch), widths_(arguments), results_(results) {
  if (batch == 0) throw std::invalid_argument(name + " takes 0 points a call, expected at least 1");
  function_ = casadi::Function::deserialize(text);
  const auto refuse = [&](const std::string& what, casadi_int have, std::size_t want) {
    throw std::invalid_argument(name + " has " + std::to_string(have) + " " + what + ", expected " +
                                std::to_string(want));
  };
  if (function_.n_in() != static_cast<casadi_int>(arguments.size()))
    refuse("arguments", function_.n_in(), arguments.size());
  if (function_.n_out() != 1) refuse("results", function_.n_out(), 1);
  for (std::size_t i = 0; i < arguments.size(); ++i)
    if (function_.nnz_in(static_cast<casadi_int>(i)) != static_cast<casadi_int>(arguments[i] * batch))
      refuse("numbers in argument " + std::to_string(i), function_.nnz_in(static_cast<casadi_int>(i)),
             arguments[i] * batch);
  if (function_.nnz_out(0) != static_cast<casadi_int>(results * batch))
    refuse("numbers in its result", function_.nnz_out(0), results * batch);
}

void PointFunction::prepare(std::size_t threads) {
  if (function_.is_null()) return;
  std::size_t tail = results_;
  for (const std::size_t width : widths_) tail += width;
  while (memories_.size() < threads)
    memories_.push_back({static_cast<int>(function_.checkout()), std::vector<const double*>(function_.sz_arg()),
                         std::vector<double*>(function_.sz_res()), std::vector<casadi_int>(function_.sz_iw()),
                         std::vector<double>(function_.sz_w()), std::vector<double>(tail * batch_)});
}

void PointFunction::call(Memory& memory, double* result) const {
  memory.results[0] = result;
  int failed = 1;
  try {
    failed = function_(memory.arguments.data(), memory.results.data(), memory.integers.data(), memory.reals.data(),
                       memory.handle);
  } catch (const std::exception&) {
    // No caller would catch an exception of a pool's thread; the solver refuses numbers that are not finite.
  }
  if (failed) std::fill_n(result, results_ * batch_, std::numeric_limits<double>::quiet_NaN());
}

void PointFunction::evaluate(std::size_t count, const double* const* arguments, double* result, ThreadPool& pool) {
  pool.split(count, batch_, [&](std::size_t thread, std::size_t begin, std::size_t end) {
    Memory& memory = memories_[thread];
    std::size_t point = begin;
    for (; point + batch_ <= end; point += batch_) {
      for (std::size_t i = 0; i < widths_.size(); ++i) memory.arguments[i] = arguments[i] + point * widths_[i];
      call(memory, result + point * results_);
    }
    if (point == end) return;
    double* scratch = memory.tail.data();
    for (std::size_t i = 0; i < widths_.size(); ++i) {
      memory.arguments[i] = scratch;
      for (std::size_t k = 0; k < batch_; ++k, scratch += widths_[i])
        std::copy_n(arguments[i] + std::min(point + k, end - 1) * widths_[i], widths_[i], scratch);
    }
    call(memory, scratch);
    std::copy_n(scratch, (end - point) * results_, result + point * results_);
  });
}

CasadiBlock::CasadiBlock(const PointSizes& sizes, const Functions& functions) : PointBlock(sizes) {
  const char* const names[] = {"values", "jacobian", "cost", "gradient", "hessian"};
  for (const auto& [name, given] : functions) {
    const auto known = std::find(std::begin(names), std::end(names), name);
    if (known == std::end(names))
      throw std::invalid_argument("'" + name +
                                  "' is no evaluation of a block: values, jacobian, cost, gradient or hessian");
    const auto which = static_cast<Evaluation>(known - std::begin(names));
    std::vector<std::size_t> arguments = {sizes.inputs, sizes.constants};
    if (which == Evaluation::hessian) arguments.push_back(sizes.outputs);
    functions_[known - std::begin(names)] =
        PointFunction(name, given.first, given.second, arguments, sizes.results(which));
  }
  const bool costs = sizes.costed >= 0;
  const bool wanted[] = {!functions.count("cost"), sizes.jacobian > 0, costs, costs, sizes.hessian > 0};
  for (std::size_t i = 0; i < functions_.size(); ++i)
    if (wanted[i] && !functions.count(names[i]))
      throw std::invalid_argument(std::string("the function '") + names[i] + "' is missing");
}

void CasadiBlock::prepare(std::size_t threads) {
  for (PointFunction& function : functions_) function.prepare(threads);
}

void CasadiBlock::evaluate(Evaluation which, const double* v, const double* c, const double* m, double* out,
                           ThreadPool& pool) {
  // Its functions do not saturate.
  if (which == Evaluation::convex_hessian) which = Evaluation::hessian;
  const double* const arguments[] = {v, c, m};
  functions_[static_cast<std::size_t>(which)].evaluate(sizes().count, arguments, out, pool);
}

void bind_casadi_block(nb::module_& m) {
  nb::class_<CasadiBlock, PointBlock>(m, "CasadiBlock")
      .def(
          "__init__",
          [](CasadiBlock* self, std::size_t count, std::size_t inputs, std::size_t constants, std::size_t outputs,
             const std::map<std::string, std::pair<nb::bytes, std::size_t>>& functions, std::size_t jacobian,
             std::size_t hessian, std::ptrdiff_t costed) {
            CasadiBlock::Functions given;
            for (const auto& [name, pair] : functions)
              given[name] = {std::string(pair.first.c_str(), pair.first.size()), pair.second};
            new (self) CasadiBlock({count, inputs, constants, outputs, jacobian, hessian, costed}, given);
          },
          nb::arg("count"), nb::arg("inputs"), nb::arg("constants"), nb::arg("outputs"), nb::arg("functions"),
          nb::arg("jacobian") = 0, nb::arg("hessian") = 0, nb::arg("costed") = -1);
}

}  // namespace robotraj::native
