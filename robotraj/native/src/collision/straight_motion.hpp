// Whether spheres stay free while all joints move on a straight line: proved by bounds on their motion, not sampled.
//
// The distance d of a sphere's centre from a convex shape, or from another centre, is a convex function of their
// relative place, so that on q(s) = a + s (b - a), with its gradient n at s_0,
//
//     d(s) >= d(s_0) - h abs(n' v) - h^2 A / 2,   h = abs(s - s_0),
//
// v the relative velocity at s_0, A the bound of `moving_spheres.hpp` on the relative acceleration. An interval is
// halved until all distances exceed their change.
#pragma once

#include "moving_spheres.hpp"

namespace robotraj::native::collision {

/// Tests straight motions of one robot; keeps its memory between them.
class StraightMotion {
 public:
  /// Spheres keep `margin` [m]; a motion that comes within `resolution` [m] of it counts as blocked.
  StraightMotion(const SphereTree& tree, double margin, double resolution);
  bool free(const double* a, const double* b);

 private:
  enum class Verdict { free, blocked, open };

  Verdict examine(double h);
  Verdict against_shapes(const Group& group, double h);
  Verdict between(std::size_t pair, double h);
  Verdict judge(double left, double change) const;

  const SphereTree& tree_;
  double margin_, resolution_;
  std::vector<double> step_, q_;
  Rates rates_;
  MovingSpheres spheres_;
};

}  // namespace robotraj::native::collision
