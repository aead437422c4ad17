// The tree of joints that the algorithms walk. Only joints.cpp and configuration.cpp know the types of joints:
// instantiating each algorithm for all of Pinocchio's joint types would take minutes to compile.
#pragma once

#include <pinocchio/autodiff/casadi.hpp>
#include <pinocchio/multibody/fwd.hpp>
#include <pinocchio/spatial.hpp>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace robotraj {

using casadi::SX;
using Model = pinocchio::ModelTpl<SX>;
using Placement = pinocchio::SE3Tpl<SX>;
using Motion = pinocchio::MotionTpl<SX>;
using Force = pinocchio::ForceTpl<SX>;
using Inertia = pinocchio::InertiaTpl<SX>;
using Vector = Eigen::Matrix<SX, Eigen::Dynamic, 1>;
using Vector3 = Eigen::Matrix<SX, 3, 1>;
using Matrix = Eigen::Matrix<SX, Eigen::Dynamic, Eigen::Dynamic>;
using Subspace = Eigen::Matrix<SX, 6, Eigen::Dynamic>;

/// A joint's place in the tree, and the body it carries. Joint 0 is the universe.
struct Joint {
  std::size_t parent;
  Eigen::Index first;   ///< of its rates among those of the model
  Eigen::Index count;   ///< of its rates
  Placement placement;  ///< in the parent's axes, at the neutral position
  Inertia body;
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
  std::shared_ptr<const Model> model;  ///< the types of the joints
};

/// A joint at one position and velocity.
struct JointMotion {
  Placement placement;  ///< of the joint's axes in its parent's
  Subspace axes;        ///< 6 x nv of the joint: its motion subspace, in its own axes
  Motion velocity;      ///< relative to the parent, in its own axes
  Motion bias;          ///< acceleration at zero rates of the velocity
};

/// The double-precision model read from Model::saveToString(), cast to SX (numbers become constants).
Tree read_model(const std::string& text);

/// All joints at q and v; joint 0 does not move.
std::vector<JointMotion> joint_motions(const Tree& tree, const Vector& q, const Vector& v);

/// Product of a motion subspace and rates.
inline Motion along(const Subspace& axes, const Vector& rates) { return Motion(Eigen::Matrix<SX, 6, 1>(axes * rates)); }

}  // namespace robotraj
