// Sparse factors against a dense solve and eigenvalues, and the threads that share points.
#include <Eigen/Dense>

#include <random>

#include "check.hpp"
#include "ldl/factors.hpp"
#include "parallel/thread_pool.hpp"

namespace robotraj::tests {

ROBOTRAJ_TEST(factors_solve_and_count_the_signs_of_eigenvalues) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  std::bernoulli_distribution present(0.3);
  for (const int n : {1, 7, 40, 90}) {
    for (const char* processor : {"", "any"}) {
      Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
      native::ldl::Pattern pattern;
      pattern.n = n;
      pattern.starts = {0};
      std::vector<double> values;
      for (int j = 0; j < n; ++j) {
        for (int i = j; i < n; ++i)
          if (i == j || (i % 3 == 2 && j == i - 1) || present(random)) {
            // Every third row is a constraint, of the variable before it at least.
            const double value = i == j ? (j % 3 == 2 ? 0.0 : 5.0 + std::abs(normal(random))) : normal(random);
            pattern.rows.push_back(i);
            values.push_back(value);
            matrix(i, j) = matrix(j, i) = value;
          }
        pattern.starts.push_back(static_cast<int>(pattern.rows.size()));
      }
      native::ldl::Factors factors(pattern, {}, processor);
      std::vector<double> placed(values.size());
      for (std::size_t e = 0; e < values.size(); ++e) placed[factors.tree().place_of[e]] = values[e];
      const auto inertia = factors.factorise(placed.data(), 1e-6, 1e-20);
      const Eigen::VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix).eigenvalues();
      CHECK(inertia.zero == 0);
      CHECK(inertia.negative == (eigenvalues.array() < 0.0).count());
      Eigen::VectorXd x = Eigen::VectorXd::NullaryExpr(n, [&] { return normal(random); });
      const Eigen::VectorXd b = matrix * x;
      Eigen::VectorXd found = b;
      factors.solve(found.data());
      CHECK((found - x).lpNorm<Eigen::Infinity>() < 1e-6);
    }
  }
}

ROBOTRAJ_TEST(every_piece_is_done_once_by_any_number_of_threads) {
  for (const std::size_t threads : {1, 2, 5}) {
    native::ThreadPool pool(threads);
    std::vector<int> done(1000, 0);
    for (int round = 1; round <= 50; ++round) {
      pool.split(done.size(), 3, [&done](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) ++done[i];
      });
      bool all = true;
      for (const int each : done) all = all && each == round;
      CHECK(all);
    }
  }
}

}  // namespace robotraj::tests
