// The Riccati recursion against a dense solve, for every kind of processor: factors, further right-hand sides, residuals
// and products.
#include <Eigen/Dense>

#include <cmath>
#include <random>
#include <stdexcept>

#include "check.hpp"
#include "kernels/packed.hpp"
#include "newton/riccati_solver.hpp"

namespace robotraj::tests {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using native::Pivots;

/// Random stages with a positive Hessian and independent rows, dense and as the recursion takes them.
struct Random {
  explicit Random(const native::Stages& stages, const native::Kernels& chosen = *native::kernels().front(),
                  double curvature = 0.1)
      : layout(stages),
        kernels(chosen),
        jacobian(MatrixXd::Zero(layout.rows, layout.columns)),
        hessian(MatrixXd::Zero(layout.columns, layout.columns)) {
    for (std::size_t k = 0; k < layout.count(); ++k) {
      const int n = layout.unknowns(k), first = layout.first_column[k], next = layout.next_states(k);
      fill(layout.first_dynamics[k], first, next, n);
      if (next > 0)
        jacobian.block(layout.first_dynamics[k], layout.first_state[k + 1], next, next) =
            -MatrixXd::Identity(next, next);
      fill(layout.first_equality[k], first, layout.equalities[k], n);
      for (int i = 0; i < layout.equalities[k]; ++i) jacobian(layout.first_equality[k] + i, first + n - 1 - i) += 3.0;
      fill(layout.first_inequality[k], first, layout.inequalities[k], n);
      const MatrixXd root = numbers(n, n);
      hessian.block(first, first, n, n) = root * root.transpose() + curvature * MatrixXd::Identity(n, n);
    }
    make();
  }

  MatrixXd numbers(int rows, int columns) {
    return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
  }
  void fill(int row, int column, int rows, int columns) {
    // Half of the entries, so that rows are both whole and sparse.
    jacobian.block(row, column, rows, columns) =
        numbers(rows, columns).unaryExpr([](double x) { return std::abs(x) > 0.7 ? x : 0.0; });
  }
  /// Passes the dense matrices to the recursion.
  void make() {
    native::Pattern of_jacobian, of_hessian;
    native::Numbers first, second;
    for (int i = 0; i < layout.rows; ++i)
      for (int j = 0; j < layout.columns; ++j)
        if (jacobian(i, j) != 0.0) {
          of_jacobian.add(i, j);
          first.push_back(jacobian(i, j));
        }
    for (int i = 0; i < layout.columns; ++i)
      for (int j = i; j < layout.columns; ++j)
        if (hessian(i, j) != 0.0) {
          of_hessian.add(i, j);
          second.push_back(hessian(i, j));
        }
    matrices = std::make_unique<native::StageMatrices>(layout, of_jacobian, of_hessian, kernels.riccati);
    of_rows = matrices->empty_jacobian();
    of_cost = matrices->empty_hessian();
    for (std::size_t e = 0; e < first.size(); ++e)
      if (const auto place = matrices->jacobian_places[e]; place >= 0) of_rows[place] = first[e];
    for (std::size_t e = 0; e < second.size(); ++e) of_cost[matrices->hessian_places[e]] = second[e];
    solver = std::make_unique<native::RiccatiSolver>(*matrices);
  }

  native::Layout layout;
  const native::Kernels& kernels;
  std::mt19937 random{4};
  std::normal_distribution<double> normal;
  MatrixXd jacobian, hessian;
  std::unique_ptr<native::StageMatrices> matrices;
  std::unique_ptr<native::RiccatiSolver> solver;
  native::StageValues of_rows, of_cost;
};

const native::Stages shapes[] = {
    {{3, 3, 3, 0}, {4, 4, 4, 4}, {0, 0, 0, 0}, {0, 0, 0, 0}},
    {{2, 2, 2, 2, 0}, {6, 6, 6, 6, 6}, {1, 1, 3, 1, 2}, {2, 0, 1, 3, 0}},  // more equalities than controls
    {{2, 2, 0}, {5, 5, 5}, {5, 0, 1}, {1, 1, 1}},                          // the first state is given
    {{4}, {3}, {2}, {5}},
    {{1, 8, 0, 11, 0}, {9, 3, 16, 8, 7}, {0, 2, 0, 1, 0}, {3, 20, 0, 9, 1}},
    {{18, 12, 12, 0}, {0, 18, 18, 18}, {0, 0, 0, 6}, {30, 42, 42, 6}},  // an arm's
};

/// Calls test(stages) for random stages of every shape and every kind of processor.
template <typename Test>
void for_each(Test&& test) {
  for (const native::Kernels* kernels : native::kernels())
    for (const native::Stages& stages : shapes) {
      Random its(stages, *kernels);
      test(its);
    }
}

}  // namespace

ROBOTRAJ_TEST(the_recursion_solves_what_a_dense_solve_does) {
  for_each([](Random& its) {
    for (const bool damped : {false, true}) {
      const int n = its.layout.columns, m = its.layout.rows, first = its.layout.equality_rows;
      const int second = its.layout.inequality_rows;
      const VectorXd dx = its.numbers(n, 1).cwiseAbs();
      const VectorXd de = VectorXd::Constant(second - first, 0.3);
      const VectorXd ds = its.numbers(m - second, 1).array().exp();
      MatrixXd matrix = MatrixXd::Zero(n + m, n + m);
      matrix.topLeftCorner(n, n) = its.hessian;
      matrix.topLeftCorner(n, n).diagonal() += dx;
      matrix.topRightCorner(n, m) = its.jacobian.transpose();
      matrix.bottomLeftCorner(m, n) = its.jacobian;
      if (damped) matrix.diagonal().segment(n + first, second - first) = -de;
      matrix.diagonal().tail(m - second) = -ds;
      for (const bool again : {false, true}) {
        const VectorXd side = its.numbers(n + m, 1);
        VectorXd found(n + m);
        const double* rows = side.data() + n;
        const native::NewtonSystem system{
            dx.data(),       damped ? de.data() : nullptr, ds.data(), side.data(), rows, rows + second, found.data(),
            found.data() + n};
        if (again) its.solver->solve(its.of_rows, system);
        else CHECK(its.solver->factorise_and_solve(its.of_rows, its.of_cost, system, nullptr) == Pivots::good);
        const VectorXd expected = matrix.fullPivLu().solve(-side);
        CHECK((found - expected).lpNorm<Eigen::Infinity>() < 1e-8 * std::max(1.0, expected.lpNorm<Eigen::Infinity>()));
        // The residual of any point, but for the inequalities' D_s.
        const VectorXd at = its.numbers(n + m, 1);
        found = at;
        VectorXd left(n + m);
        const double most =
            its.solver->residual(its.of_rows, its.of_cost, system, 0, its.layout.count(),
                                 {left.data(), left.data() + n, left.data() + n + first, left.data() + n + second});
        VectorXd of_rows = matrix * at + side;
        of_rows.tail(m - second) += ds.cwiseProduct(at.tail(m - second));
        CHECK((left - of_rows).lpNorm<Eigen::Infinity>() < 1e-10);
        CHECK(most == left.head(n + second).lpNorm<Eigen::Infinity>());
      }
    }
  });
}

ROBOTRAJ_TEST(transposed_products_of_stages_are_dense_products) {
  for_each([](Random& its) {
    const VectorXd x = its.numbers(its.layout.columns, 1), lam = its.numbers(its.layout.rows, 1);
    VectorXd columns = x;
    its.matrices->transposed_times(its.of_rows, lam.data(), columns.data(), columns.data());
    CHECK((columns - x - its.jacobian.transpose() * lam).lpNorm<Eigen::Infinity>() < 1e-11);
  });
}

ROBOTRAJ_TEST(rows_that_depend_on_each_other_and_negative_curvature_are_reported) {
  const auto pivots = [](Random& its) {
    const VectorXd dx = VectorXd::Zero(its.layout.columns), side = VectorXd::Ones(its.layout.columns + its.layout.rows);
    VectorXd found(side.size());
    const double* rows = side.data() + its.layout.columns;
    return its.solver->factorise_and_solve(
        its.of_rows, its.of_cost,
        {dx.data(), nullptr, side.data(), side.data(), rows, rows + its.layout.inequality_rows, found.data(),
         found.data() + its.layout.columns},
        nullptr);
  };
  Random twice({{3, 0}, {2, 2}, {2, 0}, {0, 0}});
  CHECK(pivots(twice) == Pivots::good);
  twice.jacobian.row(3) = 2.0 * twice.jacobian.row(2);
  twice.make();
  CHECK(pivots(twice) == Pivots::dependent);
  Random concave({{3, 0}, {2, 2}, {0, 0}, {0, 0}}, *native::kernels().front(), -50.0);
  CHECK(pivots(concave) == Pivots::indefinite);
}

ROBOTRAJ_TEST(derivatives_of_stages_out_of_order_or_of_two_stages_are_refused) {
  const native::Layout layout({{1, 0}, {1, 1}, {0, 0}, {0, 0}});
  const auto refused = [&](native::Pattern jacobian, native::Pattern hessian) {
    try {
      native::StageMatrices(layout, jacobian, hessian);
      return false;
    } catch (const std::invalid_argument&) {
      return true;
    }
  };
  const native::Pattern rows{{0, 0, 0}, {0, 1, 2}}, diagonal{{0, 1, 2}, {0, 1, 2}};
  CHECK(!refused(rows, diagonal));
  for (const std::vector<std::int32_t>& columns : {std::vector<std::int32_t>{1, 0, 2}, {0, 0, 2}})
    CHECK(refused({{0, 0, 0}, columns}, diagonal));
  CHECK(refused(rows, {{1, 0, 2}, {1, 0, 2}}));
  CHECK(refused(rows, {{0, 1, 2}, {2, 1, 2}}));
}

}  // namespace robotraj::tests
