// The filter: pairs of violation and barrier function that no later point may be worse than in both.
#pragma once

#include <algorithm>
#include <vector>

namespace robotraj::interior_point {

/// With theta the violation and phi the barrier function, the filter is the set of all points that a corner dominates,
///
///     F = { (theta, phi) : theta >= theta_k and phi >= phi_k for a corner k }.
///
/// A trial point outside F is accepted. The line search adds corners with a margin, so that points cannot accumulate at
/// one: (1 - gamma_theta) theta and phi - gamma_phi theta. Source: the paper, equations 20 to 22.
class Filter {
 public:
  void clear() { corners_.clear(); }
  std::size_t size() const { return corners_.size(); }

  /// Whether a point is outside F: better than every corner in one of the two.
  bool accepts(double violation, double barrier) const {
    return std::all_of(corners_.begin(), corners_.end(),
                       [&](const Corner& corner) { return violation < corner.violation || barrier < corner.barrier; });
  }
  /// Adds a corner and removes those that it dominates.
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
