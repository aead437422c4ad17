#include "casadi_block.hpp"

#include "bindings/arrays.hpp"
#include "bindings/bindings.hpp"

#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <limits>
#include <sstream>

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

void PointFunction::evaluate(std::size_t count, std::initializer_list<const double*> arguments, double* result,
                             ThreadPool& pool) {
  pool.split(count, batch_, [&](std::size_t thread, std::size_t begin, std::size_t end) {
    Memory& memory = memories_[thread];
    std::size_t point = begin;
    for (; point + batch_ <= end; point += batch_) {
      for (std::size_t i = 0; i < widths_.size(); ++i) memory.arguments[i] = arguments.begin()[i] + point * widths_[i];
      call(memory, result + point * results_);
    }
    if (point == end) return;
    double* scratch = memory.tail.data();
    for (std::size_t i = 0; i < widths_.size(); ++i) {
      memory.arguments[i] = scratch;
      for (std::size_t k = 0; k < batch_; ++k, scratch += widths_[i])
        std::copy_n(arguments.begin()[i] + std::min(point + k, end - 1) * widths_[i], widths_[i], scratch);
    }
    call(memory, scratch);
    std::copy_n(scratch, (end - point) * results_, result + point * results_);
  });
}

CasadiBlock::CasadiBlock(const PointSizes& sizes, const Functions& functions) : PointBlock(sizes) {
  const std::vector<std::size_t> point = {sizes.inputs, sizes.constants};
  const std::vector<std::size_t> weighed = {sizes.inputs, sizes.constants, sizes.outputs};
  for (const auto& [name, given] : functions) {
    const auto& [text, batch] = given;
    const auto make = [&name = name, &text = text, batch = batch](const std::vector<std::size_t>& arguments,
                                                                  std::size_t results) {
      return PointFunction(name, text, batch, arguments, results);
    };
    if (name == "values") values_ = make(point, sizes.outputs);
    else if (name == "jacobian") jacobian_ = make(point, sizes.jacobian);
    else if (name == "cost") cost_ = make(point, 1);
    else if (name == "gradient") gradient_ = make(point, sizes.inputs);
    else if (name == "hessian") hessian_ = make(weighed, sizes.hessian);
    else
      throw std::invalid_argument("'" + name +
                                  "' is no evaluation of a block: values, jacobian, cost, gradient or hessian");
  }
  const auto need = [&](const char* name, bool wanted) {
    if (wanted && !functions.count(name))
      throw std::invalid_argument(std::string("the function '") + name + "' is missing");
  };
  need("values", !functions.count("cost"));
  need("jacobian", sizes.jacobian > 0);
  need("cost", sizes.costed >= 0);
  need("gradient", sizes.costed >= 0);
  need("hessian", sizes.hessian > 0);
}

void CasadiBlock::prepare(std::size_t threads) {
  for (PointFunction* function : {&values_, &jacobian_, &cost_, &gradient_, &hessian_}) function->prepare(threads);
}

void CasadiBlock::values(const double* v, const double* c, double* y, ThreadPool& pool) {
  values_.evaluate(sizes().count, {v, c}, y, pool);
}

void CasadiBlock::jacobian(const double* v, const double* c, double* nonzeros, ThreadPool& pool) {
  jacobian_.evaluate(sizes().count, {v, c}, nonzeros, pool);
}

void CasadiBlock::cost(const double* v, const double* c, double* cost, ThreadPool& pool) {
  cost_.evaluate(sizes().count, {v, c}, cost, pool);
}

void CasadiBlock::gradient(const double* v, const double* c, double* gradient, ThreadPool& pool) {
  gradient_.evaluate(sizes().count, {v, c}, gradient, pool);
}

void CasadiBlock::hessian(const double* v, const double* c, const double* m, double* nonzeros, ThreadPool& pool) {
  hessian_.evaluate(sizes().count, {v, c, m}, nonzeros, pool);
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
