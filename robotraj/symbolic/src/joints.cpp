// The motion of joints at a position and velocity.
#include "tree.hpp"

#include <array>
#include <stdexcept>

namespace robotraj {
namespace {

using Matrix3 = Eigen::Matrix<SX, 3, 3>;
using Axis = Eigen::Matrix<double, 3, 1>;

/// Rodrigues' formula. Constants are folded: an axis of coordinates leaves one cosine and one sine.
Matrix3 rotation_about(const Axis& axis, const SX& cosine, const SX& sine) {
  const SX versine = 1 - cosine;
  Matrix3 rotation;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const SX symmetric = versine * (axis[i] * axis[j]), antisymmetric = sine * axis[k];
    rotation(i, i) = axis[i] * axis[i] == 1 ? SX(1) : SX(cosine + versine * (axis[i] * axis[i]));
    rotation(i, j) = symmetric - antisymmetric;
    rotation(j, i) = symmetric + antisymmetric;
  }
  return rotation;
}

Matrix3 rotation_by(const Vector& quaternion) {
  return Eigen::Quaternion<SX>(quaternion[3], quaternion[0], quaternion[1], quaternion[2]).toRotationMatrix();
}

Placement displacement(const JointPart& part, const Vector& q) {
  const Axis linear = part.axis.head<3>(), angular = part.axis.tail<3>();
  const Vector3 nowhere = Vector3::Zero();
  switch (part.kind) {
    case JointKind::screw:
      return {angular.isZero(0) ? Matrix3(Matrix3::Identity()) : rotation_about(angular, cos(q[0]), sin(q[0])),
              linear.cast<SX>() * q[0]};
    case JointKind::circle: return {rotation_about(angular, q[0], q[1]), nowhere};
    case JointKind::planar: return {rotation_about(Axis::UnitZ(), q[2], q[3]), Vector3(q[0], q[1], 0)};
    case JointKind::spherical: return {rotation_by(q), nowhere};
    case JointKind::free_flyer: return {rotation_by(q.tail<4>()), q.head<3>()};
  }
  throw std::invalid_argument("unknown kind of joint");
}

/// The motion subspace, in the axes of the part.
Subspace subspace(const JointPart& part) {
  Subspace axes = Subspace::Zero(6, part.rates());
  switch (part.kind) {
    case JointKind::screw:
    case JointKind::circle: axes.col(0) = part.axis.cast<SX>(); break;
    case JointKind::planar: axes(0, 0) = axes(1, 1) = axes(5, 2) = 1; break;
    case JointKind::spherical: axes.bottomRows<3>().setIdentity(); break;
    case JointKind::free_flyer: axes.setIdentity(); break;
  }
  return axes;
}

JointMotion motion_of(const Joint& joint, const Vector& q, const Vector& v) {
  JointMotion moved{joint.placement, Subspace(6, 0), Motion::Zero(), Motion::Zero()};
  for (const JointPart& part : joint.parts) {
    const bool first = &part == &joint.parts.front();
    const Placement own = displacement(part, q.segment(part.q, part.positions()));
    const Subspace axes = subspace(part);
    const Motion velocity = along(axes, v.segment(part.v, part.rates()));
    if (first) {
      moved = {joint.placement * own, axes, velocity, Motion::Zero()};
      continue;
    }
    const Placement step = part.placement * own;
    Subspace all(6, moved.axes.cols() + axes.cols());
    for (Eigen::Index k = 0; k < moved.axes.cols(); ++k)
      all.col(k) = step.actInv(Motion(Eigen::Matrix<SX, 6, 1>(moved.axes.col(k)))).toVector();
    all.rightCols(axes.cols()) = axes;
    const Motion total = step.actInv(moved.velocity) + velocity;
    moved = {moved.placement * step, all, total, step.actInv(moved.bias) + total.cross(velocity)};
  }
  return moved;
}

}  // namespace

// By kind: screw, circle, planar, spherical, free-flyer.
Eigen::Index JointPart::positions() const { return std::array{1, 2, 4, 4, 7}.at(static_cast<std::size_t>(kind)); }
Eigen::Index JointPart::rates() const { return std::array{1, 1, 3, 3, 6}.at(static_cast<std::size_t>(kind)); }

std::vector<JointMotion> joint_motions(const Tree& tree, const Vector& q, const Vector& v) {
  std::vector<JointMotion> motions;
  for (const Joint& joint : tree.joints) motions.push_back(motion_of(joint, q, v));
  motions[0].placement = Placement::Identity();
  return motions;
}

}  // namespace robotraj
