// Helpers of the C++ tests: named tests, checks that print their line, and a small problem.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "interior_point/solver.hpp"
#include "interior_point/start.hpp"

namespace robotraj::tests {

using Test = void (*)();

/// Adds a test to those that `main` runs.
struct Named {
  Named(const char* name, Test test);
};

/// Counts a failure and prints its place.
void check(bool holds, const char* what, const char* file, int line);

#define ROBOTRAJ_TEST(name)                                        \
  static void name();                                              \
  static const ::robotraj::tests::Named name##_named{#name, name}; \
  static void name()
#define CHECK(holds) ::robotraj::tests::check(static_cast<bool>(holds), #holds, __FILE__, __LINE__)

/// Problem 71 of Hock and Schittkowski (1981):
///
///     min x1 x4 (x1 + x2 + x3) + x3,   x1 x2 x3 x4 >= 25,   |x|^2 = 40,   1 <= x <= 5,
///
/// with the optimum 17.0140173 at (1, 4.743, 3.8211, 1.3794). Rows are [|x|^2 - 40, the product, x]. Where it
/// saturates, an objective of negative weight has no second derivatives in the convex Hessian.
std::shared_ptr<native::Program> hock_schittkowski_71(bool saturates = false);
native::Stages its_stages();
extern const std::vector<double> its_lower, its_upper, its_start;

/// That problem at a cold start from x.
struct Started {
  explicit Started(std::vector<double> x = its_start, double mu = 0.1, double objective_scale = 1.0,
                   bool saturates = false);

  native::Layout layout;
  interior_point::ProgramProblem problem;
  interior_point::Options options;
  interior_point::Progress progress;
  interior_point::Algorithm algorithm;
  interior_point::Run& run;
};

/// Slope of a function along the direction `step`, by central differences.
double slope(const std::function<double(const std::vector<double>&)>& function, const std::vector<double>& x,
             const std::vector<double>& step);

}  // namespace robotraj::tests
