// L D L' of a sparse symmetric indefinite matrix, front by front.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "buffer.hpp"
#include "front.hpp"
#include "tree.hpp"

namespace robotraj::native::ldl {

struct Inertia {
  int negative = 0, zero = 0;  ///< pivots
  int delayed = 0;             ///< candidates delayed to another front, counted each time
};

/// The multifrontal method of Duff and Reid, ACM Transactions on Mathematical Software 9 (1983). Rows are not
/// scaled: an NLP is scaled already.
///
/// The order is that of the pattern alone, as if no diagonal were zero. One factorisation reuses the memory of another.
class Factors {
 public:
  /// `groups` as in tree_of_fewest_products, `processor` as in kernels_of.
  explicit Factors(Pattern pattern, const std::vector<int>& groups = {}, const std::string& processor = {});

  /// Factorises; the value of each entry of the pattern is at its `Tree::place_of`.
  Inertia factorise(const double* values, double threshold, double small);
  /// x := A^-1 x, by the last factors. Parts along zero pivots are zero.
  void solve(double* x);

  const Pattern& pattern() const { return pattern_; }
  const Tree& tree() const { return tree_; }

 private:
  struct Part {
    int pivots, ld, delayed;
    std::size_t entries, order, diagonal;  ///< where they begin
  };
  void make_room();
  void eliminate(std::size_t node, const double* values, double threshold, double small, Inertia& all);
  void keep(const Front& front, int pivots, Part& part);

  Pattern pattern_;
  const FrontKernels& kernels_;
  Tree tree_;
  std::vector<Part> parts_;
  std::size_t entries_ = 0, orders_ = 0, diagonals_ = 0, stacked_ = 0;
  Buffer factor_, stack_, vector_;
  std::vector<double> diagonal_, off_, all_;
  std::vector<int> order_, places_;
};

}  // namespace robotraj::native::ldl
