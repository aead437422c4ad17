// The filter: pairs of violation and barrier function that no later point may be worse than in both.
#pragma once

#include <algorithm>
#include <vector>

namespace robotraj::interior_point {

/// Source: the paper, equations 8 and 22.
class Filter {
 public:
  void clear() { corners_.clear(); }
  std::size_t size() const { return corners_.size(); }

  /// Whether a point is better than every corner in one of the two.
  bool accepts(double violation, double barrier) const {
    return std::all_of(corners_.begin(), corners_.end(),
                       [&](const Corner& corner) { return violation < corner.violation || barrier < corner.barrier; });
  }
  /// Takes a corner in, and drops those that it makes needless.
  void add(double violation, double barrier) {
    corners_.erase(std::remove_if(corners_.begin(), corners_.end(),
                                  [&](const Corner& corner) {
                                    return corner.violation >= violation && corner.barrier >= barrier;
                                  }),
                   corners_.end());
    corners_.push_back({violation, barrier});
  }

 private:
  struct Corner {
    double violation, barrier;
  };
  std::vector<Corner> corners_;
};

}  // namespace robotraj::interior_point
