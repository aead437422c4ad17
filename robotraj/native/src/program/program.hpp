// A stagewise nonlinear program: point functions at many points, and fixed sparse combinations of their results.
//
//   v_b = G_b y + g0_b,   Y_b = f_b(v_b, c_b)
//   rows = L y + l0 + sum_b S_b vec(Y_b),         objective = l_f' y + c0 + sum_b weights_b' (costed output of b)
//   gradient = l_f + sum_b C_b vec(grad_b),       Jacobian entries j = j0 + sum_b M_b vec(J_b)
//   m_b = S_b' lam + lam_f weights_b (at the costed output),   Hessian entries h = sum_b N_b vec(H_b)
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "point_functions/point_block.hpp"
#include "sparse/combination.hpp"
#include "sparse/pattern.hpp"
#include "sparse/stacked.hpp"

namespace robotraj::native {

using Numbers = std::vector<double>;

/// A block and where its inputs come from and its results go; an empty matrix stands for none.
struct Term {
  std::shared_ptr<PointBlock> block;
  Csr gather;             // G (n_v E, columns)
  Numbers gather_offset;  // g0
  Numbers constants;      // c
  Csr scatter;            // S (rows, n_y E)
  Numbers weights;        // (E,), empty where the block carries no cost
  Csr gradient;           // C (columns, n_v E)
  Csr jacobian;           // M (Jacobian entries, nonzeros E)
  Stacked hessian;        // N (Hessian entries, nonzeros E)
};

/// The linear parts: l0 + L y of the rows, c0 + l_f' y of the objective, j0 of the Jacobian's entries.
struct LinearPart {
  Csr rows;
  Numbers offset;
  Numbers cost;
  double cost_offset = 0.0;
  Numbers jacobian;
};

/// Evaluates the program at one point at a time, and keeps each result until the point changes.
class Program {
 public:
  /// Seconds spent since `clear`.
  struct Times {
    double functions = 0.0;     // in the blocks
    double combinations = 0.0;  // in the sparse products
    void clear() { *this = Times(); }
  };

  /// Throws std::invalid_argument, naming the block and the array, where shapes do not fit.
  Program(LinearPart linear, Pattern jacobian, Pattern hessian, std::vector<Term> terms, std::size_t threads,
          std::vector<int> groups = {});

  std::size_t columns() const { return linear_.cost.size(); }
  std::size_t rows() const { return linear_.offset.size(); }
  std::size_t threads() const { return pool_.size(); }
  const Pattern& jacobian_pattern() const { return jacobian_pattern_; }
  const Pattern& hessian_pattern() const { return hessian_pattern_; }
  /// Orders in which columns, then rows, leave Newton's systems: each by ascending number, one after the other.
  const std::vector<int>& elimination_groups() const { return elimination_groups_; }
  const Csr& linear_rows() const { return linear_.rows; }
  const std::vector<Term>& terms() const { return terms_; }

  void set_point(const double* y);
  const Numbers& row_values();
  double objective();
  const Numbers& gradient();
  Numbers jacobian();
  Numbers hessian(const double* lam, double lam_f);

  /// Has the two functions below write entry e to places[e], and leave it out where that is negative; called once, before
  /// derivatives are evaluated.
  void place(std::vector<std::int32_t> jacobian, std::vector<std::int32_t> hessian);
  void jacobian_to(double* out);
  /// `convex`: without the negative curvature of saturations.
  void hessian_to(const double* lam, double lam_f, double* out, bool convex = false);
  /// Whether a block saturates.
  bool saturates() const;

  void set_offsets(const double* offset, double cost_offset);
  void set_gather_offset(std::size_t term, const double* offset);
  void set_constants(std::size_t term, const double* constants);

  Times times;

 private:
  /// One term of the program, and the memory for it.
  struct Work {
    Combination gather, scatter, scatter_transposed, to_gradient, to_jacobian, to_hessian;
    Numbers v, y, cost, gradient, jacobian, m, hessian;
    bool has_rows = false;
    bool has_cost = false;
    bool y_known = false;
  };

  void check(std::size_t index) const;
  const Numbers& values(std::size_t index);
  void evaluate(std::size_t index, Evaluation which, Numbers& out);
  void forget();
  template <typename Evaluate>
  void timed(double& seconds, Evaluate&& evaluate);

  LinearPart linear_;
  Pattern jacobian_pattern_, hessian_pattern_;
  std::vector<int> elimination_groups_;
  std::vector<Term> terms_;
  std::vector<Work> work_;
  Combination linear_combination_;
  ThreadPool pool_;
  Numbers point_;
  bool point_known_ = false, rows_known_ = false, objective_known_ = false, gradient_known_ = false;
  std::vector<std::int32_t> jacobian_places_, hessian_places_;
  Numbers rows_, gradient_;
  double objective_ = 0.0;
};

}  // namespace robotraj::native
