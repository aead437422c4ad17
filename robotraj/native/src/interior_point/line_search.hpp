// The filter line search.
#pragma once

#include <memory>

#include "filter.hpp"
#include "run.hpp"

namespace robotraj::interior_point {

/// Backtracks from the longest step that keeps 1 - tau of every distance until a point is acceptable: with
/// theta = sum |c| and m = slope of phi_mu along the step, a step alpha
///
///     lowers phi_mu by eta_phi alpha m where alpha (-m)^s_phi > delta theta^s_theta and theta <= theta_min;
///     else lowers theta by gamma_theta theta, or phi_mu by gamma_phi theta;
///
/// and is accepted by the filter. Second-order corrections are tried where the full step raises theta, and taken where
/// they lower it. After ten shortened steps in a row, three full ones are taken unchecked (watchdog). Where steps become too short, steps that
/// lower the error of the primal-dual equations are taken, at most ten; then the restoration phase is needed.
/// Source: the paper, sections 2.3, 2.4 and 3.2; Chamberlain, Powell, Lemarechal, Pedersen, The watchdog technique,
/// Math. Programming Study 16 (1982).
class LineSearch {
 public:
  explicit LineSearch(Run& run) : run_(run), correction_(run.problem) {}

  /// For a new solve.
  void start();
  /// For another barrier parameter.
  void reset();
  /// Leaves an accepted point in `trial`; false where the restoration phase is needed, which `give_up` prepares.
  bool search();
  /// The current point joins the filter: the restoration phase is to leave it behind.
  void give_up();

  /// Whether a point improves on where the line search was given up, and the filter accepts it.
  bool accepts(double violation, double barrier) const;

 private:
  /// What a step is compared with.
  struct Reference {
    double violation, barrier, slope;
  };
  Reference reference_of(Iterate& iterate);
  void move(double alpha, const Vectors& step);
  void move_duals(double alpha, double alpha_rows, const Vectors& step);
  double longest(const Vectors& step) const;
  double longest_dual(const Vectors& step) const;
  bool acceptable(double alpha);
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
