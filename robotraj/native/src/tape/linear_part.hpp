// Outputs of a stage function that are linear in its unknowns.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "rigid_body/rigid_tree.hpp"
#include "tape.hpp"

namespace robotraj::native {

/// Outputs A(c) v + b(c).
class LinearPart {
 public:
  /// The tape takes c and results in the nonzeros of A, then b.
  LinearPart(Pattern pattern, Tape numbers) : pattern_(std::move(pattern)), numbers_(std::move(numbers)) {}

  /// Rows and columns of the nonzeros of A.
  const Pattern& pattern() const { return pattern_; }
  /// Nonzeros of A, then b, at each of `count` points c.
  std::vector<double> at(const double* constants, std::size_t count) const;
  std::size_t constants() const { return numbers_.inputs().front(); }

 private:
  Pattern pattern_;
  Tape numbers_;
};

}  // namespace robotraj::native
