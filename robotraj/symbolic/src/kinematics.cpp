#include "kinematics.hpp"

namespace robotraj {

Kinematics move(const Tree& tree, const Vector& q, const Vector& v, const Vector& a) {
  const std::size_t count = tree.joints.size();
  Kinematics moved{joint_motions(tree, q, v), std::vector<Placement>(count, Placement::Identity()),
                   std::vector<Motion>(count, Motion::Zero()), std::vector<Motion>(count, Motion::Zero())};
  for (std::size_t i = 1; i < count; ++i) {
    const auto& [parent, first, rates, rest, body, parts] = tree.joints[i];
    const JointMotion& joint = moved.joints[i];
    Motion& velocity = moved.velocities[i];
    Motion& acceleration = moved.accelerations[i];
    moved.placements[i] = moved.placements[parent] * joint.placement;
    velocity = joint.velocity + joint.placement.actInv(moved.velocities[parent]);
    acceleration = joint.bias + velocity.cross(joint.velocity);
    acceleration += along(joint.axes, a.segment(first, rates));
    acceleration += joint.placement.actInv(moved.accelerations[parent]);
  }
  return moved;
}

}  // namespace robotraj
