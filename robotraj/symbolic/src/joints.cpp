// The only place where the algorithms meet Pinocchio's joint types.
#include "tree.hpp"

#include <pinocchio/multibody.hpp>

namespace robotraj {

std::vector<JointMotion> joint_motions(const Tree& tree, const Vector& q, const Vector& v) {
  std::vector<JointMotion> motions(tree.joints.size());
  motions[0] = {Placement::Identity(), Subspace(6, 0), Motion::Zero(), Motion::Zero()};
  for (std::size_t i = 1; i < motions.size(); ++i) {
    const auto& joint = tree.model->joints[i];
    auto data = joint.createData();
    joint.calc(data, q, v);
    motions[i] = {tree.joints[i].placement * data.M(), data.S().matrix(), data.v(), data.c()};
  }
  return motions;
}

}  // namespace robotraj
