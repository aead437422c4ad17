// The filter line search.
#pragma once

#include <memory>

#include "filter.hpp"
#include "run.hpp"

namespace robotraj::interior_point {

/// Halves the step alpha until a point is acceptable, from the longest one that keeps a share 1 - tau of every slack's
/// distance from its bounds. With theta = sum |c| and m the slope of phi_mu along the step, an acceptable point
///
///     has phi_mu(alpha) <= phi_mu + eta_phi alpha m, where alpha (-m)^s_phi > delta theta^s_theta, theta <= theta_min;
///     else theta(alpha) <= (1 - gamma_theta) theta, or phi_mu(alpha) <= phi_mu - gamma_phi theta;
///
/// and the filter accepts it. Where the full step raises theta, it is corrected up to four times by the solution for
/// the residuals c(x + d) + alpha c(x), and such a step is taken if it is acceptable. After ten shortened steps in a
/// row, up to three full steps are taken without a test (watchdog). After five searches in a row whose last rejected
/// point was rejected by the filter alone, the filter is cleared, up to five times for a barrier parameter: corners of
/// much lower violation than matters would keep all steps short. Where alpha falls below alpha_min, up to ten steps
/// follow that lower the error of the primal-dual equations; then the restoration phase is needed.
///
/// Where `free`, a full step is taken unless it raises the largest violation more than tenfold: `Barrier` then watches
/// the error of the optimality conditions, which may rise for up to three iterations. Next to a solution on another mesh
/// the tests kept steps short: rows are violated for a step or two while their multipliers settle.
/// Source: the paper, sections 2.3, 2.4 and 3.2; Chamberlain, Powell, Lemarechal, Pedersen, The watchdog technique,
/// Math. Programming Study 16 (1982).
class LineSearch {
 public:
  explicit LineSearch(Run& run) : run_(run), correction_(run.problem) {}

  bool free = false;  ///< whether the step's parameter was chosen for it

  /// For a new solve.
  void start();
  /// For another barrier parameter.
  void reset();
  /// Writes an accepted point to `trial`; false where the restoration phase is needed, which `give_up` prepares.
  bool search();
  /// Adds the current point to the filter, which the restoration phase has to improve on.
  void give_up();

  /// Whether a point improves on where the line search was given up, and the filter accepts it.
  bool accepts(double violation, double barrier) const;

 private:
  /// Values at the current point that trial points are compared with.
  struct Reference {
    double violation, barrier, slope;
  };
  Reference reference_of(Iterate& iterate);
  void move(double alpha, const Vectors& step);
  void move_duals(double alpha, double alpha_rows, const Vectors& step);
  double longest(const Vectors& step) const;
  double longest_dual(const Vectors& step) const;
  bool acceptable(double alpha);
  bool keeps_near() const;
  bool improves(double violation, double barrier, bool far_allowed) const;
  bool is_f_type(double alpha) const;
  bool armijo(double alpha, double barrier) const;
  double shortest() const;
  bool backtrack(bool skip_first, int& shortenings);
  bool correct(double alpha);
  bool soft_step(bool& acceptable_again);
  void add_reference();
  void start_watchdog();
  void stop_watchdog();

  Run& run_;
  Filter filter_;
  Room correction_;
  bool corrected_ = false;
  Numbers corrected_rows_;
  Reference reference_{};
  double theta_max_ = -1.0, theta_min_ = -1.0;
  int shortened_ = 0;
  bool rejected_by_filter_ = false;
  int filtered_ = 0, clearings_ = 0;
  // The watchdog's beginning.
  bool watching_ = false;
  int watched_ = 0;
  Reference watched_reference_{};
  double watched_alpha_ = 0.0;
  std::unique_ptr<Iterate> watched_iterate_;
  std::unique_ptr<Room> watched_step_;
  bool soft_ = false;
  int soft_steps_ = 0;
};

}  // namespace robotraj::interior_point
