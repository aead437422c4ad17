// A model as a tree of joints with numbers on casadi::SX, which the algorithms walk.
#pragma once

#include <pinocchio/autodiff/casadi.hpp>
#include <pinocchio/spatial.hpp>

#include <cstddef>
#include <vector>

namespace robotraj {

using casadi::SX;
using Placement = pinocchio::SE3Tpl<SX>;
using Motion = pinocchio::MotionTpl<SX>;
using Force = pinocchio::ForceTpl<SX>;
using Inertia = pinocchio::InertiaTpl<SX>;
using Vector = Eigen::Matrix<SX, Eigen::Dynamic, 1>;
using Vector3 = Eigen::Matrix<SX, 3, 1>;
using Matrix = Eigen::Matrix<SX, Eigen::Dynamic, Eigen::Dynamic>;
using Subspace = Eigen::Matrix<SX, 6, Eigen::Dynamic>;

/// Kinds of joints; every joint type of Pinocchio is one of them or a chain of several.
enum class JointKind {
  screw,       ///< q is an angle about or a length along the axis, or both (helical)
  circle,      ///< q = (cos, sin) of an angle about the axis
  planar,      ///< q = (x, y, cos, sin), v in the body frame
  spherical,   ///< q is a quaternion (x, y, z, w), v in the body frame
  free_flyer,  ///< q is a position and a quaternion, v in the body frame
};

/// One joint of a chain of joints without bodies between them.
struct JointPart {
  JointKind kind;
  Eigen::Index q, v;                 ///< first entries in the model's q and v
  Placement placement;               ///< relative to the part before
  Eigen::Matrix<double, 6, 1> axis;  ///< of a screw or a circle: motion at unit rate, linear part first

  Eigen::Index positions() const;
  Eigen::Index rates() const;
};

/// A joint's position in the tree, and the body it carries. Joint 0 is the universe.
struct Joint {
  std::size_t parent;
  Eigen::Index first;   ///< of its rates among those of the model
  Eigen::Index count;   ///< of its rates
  Placement placement;  ///< in the parent's axes, at the neutral position
  Inertia body;
  std::vector<JointPart> parts;
};

struct Frame {
  std::size_t joint;
  Placement placement;  ///< in the joint's axes
};

/// A model as the recursive algorithms need it: no joint comes before its parent.
struct Tree {
  Eigen::Index nq, nv;
  std::vector<Joint> joints;
  std::vector<Frame> frames;
  Vector armature;
  Motion gravity;
};

/// A joint at one position and velocity.
struct JointMotion {
  Placement placement;  ///< of the joint's axes in its parent's
  Subspace axes;        ///< 6 x nv of the joint: its motion subspace, in its own axes
  Motion velocity;      ///< relative to the parent, in its own axes
  Motion bias;          ///< acceleration at zero rates of the velocity
};

/// All joints at q and v; joint 0 does not move.
std::vector<JointMotion> joint_motions(const Tree& tree, const Vector& q, const Vector& v);

/// Product of a motion subspace and rates.
inline Motion along(const Subspace& axes, const Vector& rates) { return Motion(Eigen::Matrix<SX, 6, 1>(axes * rates)); }

}  // namespace robotraj
