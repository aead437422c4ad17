// Sizes of the stages of a program, and where each stage begins in vectors over all of them.
#pragma once

#include <cstddef>
#include <vector>

namespace robotraj::native {

/// Numbers of controls, states, path equalities and inequalities of every stage.
struct Stages {
  std::vector<int> controls, states, equalities, inequalities;
};

/// Columns are (u_0, x_0, u_1, x_1, ...); rows are [dynamics, path equalities, inequalities], each stage after stage,
/// with -x_{k+1} + F(x_k, u_k) in the dynamics. Every inequality row has one slack.
struct Layout : Stages {
  /// Throws std::invalid_argument where the sizes do not fit each other.
  explicit Layout(Stages stages);

  std::size_t count() const { return states.size(); }
  int unknowns(std::size_t k) const { return controls[k] + states[k]; }
  int next_states(std::size_t k) const { return k + 1 < count() ? states[k + 1] : 0; }

  int columns = 0, rows = 0, slacks = 0;
  int equality_rows = 0, inequality_rows = 0;  ///< where path equalities and inequalities begin
  /// Of every stage: its first column, the first of its states, its first row of each kind, its first slack.
  std::vector<int> first_column, first_state, first_dynamics, first_equality, first_inequality, first_slack;
};

}  // namespace robotraj::native
