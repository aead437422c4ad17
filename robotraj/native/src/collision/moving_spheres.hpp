// Places and velocities of spheres at one time, and bounds on their accelerations over an interval of time.
//
// Along the joints i of a chain, with lengths l_i of the links, rates of at most d_i and accelerations of at most e_i,
// from W = alpha = a = 0,
//
//     a <- a + (alpha + W^2) l_i,   alpha <- alpha + W d_i + e_i,   W <- W + d_i,
//
// bound the angular velocity, the angular acceleration and the acceleration of the joint's origin; a joint that slides
// adds 2 W d_i + e_i to a instead.
#pragma once

#include "sphere_tree.hpp"

#include <vector>

namespace robotraj::native::collision {

/// Bounds for one joint.
struct Bend {
  double angular = 0.0, turning = 0.0, linear = 0.0;  ///< W, alpha and a

  /// On the acceleration of a point that is so far from the joint's origin.
  double at(double lever) const { return linear + (turning + angular * angular) * lever; }
};

/// Largest amounts over an interval of time.
struct Rates {
  std::vector<double> position, rate, acceleration;  ///< of every joint
};

class MovingSpheres {
 public:
  explicit MovingSpheres(const SphereTree& tree);
  /// Moves to a configuration with rates of the joints.
  void move(const double* q, const double* rate);
  void bound(const Rates& rates);

  const Vector3& centre(int sphere) const { return centres_[sphere]; }
  Vector3 middle(const Group& group) const { return tree_.of(places_, group.joint) * group.bound.centre; }
  /// Of a point that moves with a joint.
  Vector3 velocity(int joint, const Vector3& point) const;
  /// The same in the frame of the joint that carries both groups of a pair.
  Vector3 velocity(const Pair& pair, int joint, const Vector3& point) const;
  /// On the acceleration of a point in a joint's frame.
  double bend(int joint, const Vector3& point) const { return joint < 0 ? 0.0 : bends_[joint].at(point.norm()); }
  double bend(std::size_t pair, int joint, const Vector3& point) const;

 private:
  struct Twist {
    Vector3 angular = Vector3::Zero(), linear = Vector3::Zero();  ///< of a frame's origin
  };
  void bends_from(int root, const Rates& rates, std::vector<Bend>& bends) const;
  const Twist& twist(int joint) const { return joint < 0 ? twists_.back() : twists_[joint]; }

  const SphereTree& tree_;
  std::vector<Place> places_;
  std::vector<Twist> twists_;
  std::vector<Vector3> centres_;
  std::vector<int> roots_;                ///< joints that pairs have in common
  std::vector<std::size_t> root_of_;      ///< place of every pair's joint in them
  std::vector<Bend> bends_;               ///< of every joint in the world
  std::vector<std::vector<Bend>> apart_;  ///< of every joint in the frame of a root
};

}  // namespace robotraj::native::collision
