// Data of a robot's inverse dynamics: a tree of joints that turn or slide, as plain numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sparse/pattern.hpp"

// Functions that kernels of several processors call are inlined: the linker would keep one of their versions for all.
#define ROBOTRAJ_ALWAYS inline __attribute__((always_inline))

namespace robotraj::native {

/// A joint and the bodies it carries, in axes in which the joint turns about z or slides along z.
struct Joint {
  double rotation[9];     ///< from these axes, at q = 0, to the parent's; row after row
  double translation[3];  ///< of the origin, in the parent's axes [m]
  double mass;            ///< [kg]
  double lever[3];        ///< mass times centre of mass [kg m]
  double inertia[6];      ///< about the centre of mass: xx, xy, yy, xz, yz, zz [kg m^2]
  double armature;        ///< [kg m^2, kg]
  std::int32_t parent;    ///< joint, -1 for the world
  bool turns;             ///< or slides
};

/// A fixed or free-flying tree, as the kernels read it.
///
/// Coordinates of derivatives are x = (q, w, a), 0 <= x < nq + 2 nv. A free-flyer is joint 0: its body's axes are
/// used as if they were the world's, in which only gravity moves, by the quaternion. So nothing depends on its place.
struct Tree {
  const Joint* joints = nullptr;
  std::size_t count = 0;
  double gravity[3];
  bool flies = false;
  double flyer[9];  ///< the free-flyer's axes at the unit quaternion, in the world's

  /// Joints other than the free-flyer begin here.
  ROBOTRAJ_ALWAYS std::size_t first() const { return flies ? 1 : 0; }
  /// Place of a joint in w, a and tau, and in q.
  ROBOTRAJ_ALWAYS std::size_t rate(std::size_t joint) const { return joint + (flies ? 5 : 0); }
  ROBOTRAJ_ALWAYS std::size_t position(std::size_t joint) const { return joint + (flies ? 6 : 0); }
  ROBOTRAJ_ALWAYS std::size_t rates() const { return rate(count); }
  ROBOTRAJ_ALWAYS std::size_t positions() const { return position(count); }
};

/// A joint as a model describes it; matrices row after row.
struct Link {
  std::int32_t parent;        ///< joint, -1 for the world
  bool turns;                 ///< or slides
  const double* direction;    ///< of the axis, in the joint's frame; a free-flyer has none
  const double* rotation;     ///< from the joint's frame to the parent's, at q = 0
  const double* translation;  ///< of the origin, in the parent's frame [m]
  double mass;                ///< of the body [kg]
  const double* centre;       ///< of mass, in the joint's frame [m]
  const double* inertia;      ///< 3 x 3, about the centre of mass [kg m^2]
  double armature;            ///< [kg m^2, kg]
};

/// A tree that owns its joints.
class RigidTree {
 public:
  /// No joint comes before its parent; a free-flyer is the first one.
  RigidTree(const std::vector<Link>& links, const double* gravity, bool flies);

  Tree tree() const {
    Tree whole = rest_;
    whole.joints = joints_.data();
    return whole;
  }

 private:
  std::vector<Joint> joints_;
  Tree rest_;  // without its joints
};

/// (tau, x) of every number that the kernel gives for d tau/dx, in its order.
Pattern jacobian_pattern(const Tree& tree);

/// (x, x) of every number that the kernel gives for d^2 (l' tau)/dx^2, one of (i, j) and (j, i), in its order.
Pattern hessian_pattern(const Tree& tree);

}  // namespace robotraj::native
