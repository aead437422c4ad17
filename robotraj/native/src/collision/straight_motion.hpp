// Whether spheres stay free while all joints move on a straight line: proved by bounds on their motion, not sampled.
//
// The distance d of a sphere's centre from a convex shape, or from another centre, is a convex function of their
// relative place, so that on q(s) = a + s (b - a), with its gradient n at s_0,
//
//     d(s) >= d(s_0) - h abs(n' v) - h^2 A / 2,   h = abs(s - s_0),
//
// v the relative velocity at s_0, A a bound on the relative acceleration in every configuration. Along the joints i of
// a chain, with lengths l_i of the links and rates d_i = abs(b_i - a_i), from W = alpha = a = 0,
//
//     a <- a + (alpha + W^2) l_i,   alpha <- alpha + W d_i,   W <- W + d_i,
//
// where a joint that slides adds 2 W d_i to a instead. An interval is halved until all distances exceed their change.
#pragma once

#include "sphere_tree.hpp"

namespace robotraj::native::collision {

/// Tests straight motions of one robot; keeps its memory between them.
class StraightMotion {
 public:
  /// Spheres keep `margin` [m]; a motion that comes within `resolution` [m] of it counts as blocked.
  StraightMotion(const SphereTree& tree, double margin, double resolution);
  bool free(const double* a, const double* b);
  /// Configurations at which distances were computed so far.
  std::size_t evaluations = 0;

 private:
  struct Twist {
    Vector3 angular = Vector3::Zero(), linear = Vector3::Zero();  ///< of a frame's origin
  };
  struct Bend {
    double angular = 0.0, turning = 0.0, linear = 0.0;  ///< W, alpha and a

    double at(double lever) const { return linear + (turning + angular * angular) * lever; }
  };
  enum class Verdict { free, blocked, open };

  void bends_from(int root, const double* a, const double* b, std::vector<Bend>& bends) const;
  Verdict examine(double h);
  Verdict against_shapes(const Group& group, double h);
  Verdict between(std::size_t pair, double h);
  Verdict judge(double left, double change) const;
  Vector3 velocity(int joint, const Vector3& point) const;
  const Twist& twist(int joint) const { return joint < 0 ? twists_.back() : twists_[joint]; }

  const SphereTree& tree_;
  double margin_, resolution_;
  std::vector<double> step_, q_;
  std::vector<Place> places_;
  std::vector<Twist> twists_;
  std::vector<Vector3> centres_;
  std::vector<int> roots_;                ///< joints that pairs have in common
  std::vector<std::size_t> root_of_;      ///< place of every pair's joint in them
  std::vector<Bend> bends_;               ///< of every joint in the world
  std::vector<std::vector<Bend>> apart_;  ///< of every joint in the frame of a root
};

}  // namespace robotraj::native::collision
