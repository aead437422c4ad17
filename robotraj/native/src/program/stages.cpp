#include "stages.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace robotraj::native {

namespace {

/// Sums of sizes stay far below the largest integer.
constexpr int kMost = 1 << 26;

}  // namespace

Layout::Layout(Stages stages) : Stages(std::move(stages)) {
  if (count() == 0) throw std::invalid_argument("a program has at least one stage");
  for (const auto* sizes : {&controls, &equalities, &inequalities})
    if (sizes->size() != count())
      throw std::invalid_argument("controls, states, equalities and inequalities differ in their number of stages");
  for (const auto* sizes : {&controls, &states, &equalities, &inequalities})
    for (const int size : *sizes)
      if (size < 0 || size > kMost) throw std::invalid_argument("a stage has a negative or impossible size");
  for (std::size_t k = 0; k < count(); ++k) {
    if (equalities[k] > unknowns(k))
      throw std::invalid_argument("stage " + std::to_string(k) +
                                  " has more path equalities than unknowns: " + std::to_string(equalities[k]));
    first_column.push_back(columns);
    first_state.push_back(columns + controls[k]);
    first_dynamics.push_back(equality_rows);
    first_slack.push_back(slacks);
    columns += unknowns(k);
    equality_rows += next_states(k);
    slacks += inequalities[k];
    if (std::max({columns, equality_rows, slacks}) > kMost) throw std::invalid_argument("a program is too large");
  }
  if (columns == 0) throw std::invalid_argument("a program has at least one unknown");
  rows = equality_rows;
  for (std::size_t k = 0; k < count(); ++k) {
    first_equality.push_back(rows);
    rows += equalities[k];
  }
  inequality_rows = rows;
  for (std::size_t k = 0; k < count(); ++k) first_inequality.push_back(inequality_rows + first_slack[k]);
  rows += slacks;
}

}  // namespace robotraj::native
