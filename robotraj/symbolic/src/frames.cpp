// Placements, velocities, accelerations and Jacobians of frames.
#include "algorithms.hpp"
#include "kinematics.hpp"

#include <stdexcept>

namespace robotraj {

/// The motion of all joints as expressions of q, v and a: all frames of a model have it in common.
struct Moving {
  explicit Moving(const Tree& tree)
      : q(SX::sym("q", tree.nq)),
        v(SX::sym("v", tree.nv)),
        a(SX::sym("a", tree.nv)),
        at(move(tree, to_eigen(q).col(0), to_eigen(v).col(0), to_eigen(a).col(0))) {}

  SX q, v, a;
  Kinematics at;
};

namespace {

const Moving& moving(const SymbolicModel& symbolic) {
  if (!symbolic.moving) symbolic.moving = std::make_shared<const Moving>(symbolic.tree);
  return *symbolic.moving;
}

/// A motion of the joint's axes, as one of the frame.
Motion of_frame(const Motion& motion, const Frame& frame, const Placement& joint, Reference reference) {
  switch (reference) {
    case pinocchio::WORLD: return joint.act(motion);
    case pinocchio::LOCAL: return frame.placement.actInv(motion);
    case pinocchio::LOCAL_WORLD_ALIGNED:
      return Motion(joint.rotation() * (motion.linear() + motion.angular().cross(frame.placement.translation())),
                    joint.rotation() * motion.angular());
    default: throw std::invalid_argument("a reference frame is numbered 0, 1 or 2");
  }
}

}  // namespace

std::string frame_placement(const SymbolicModel& symbolic, std::size_t index) {
  const Moving& moved = moving(symbolic);
  const Frame& frame = symbolic.tree.frames.at(index);
  Graph graph(symbolic);
  graph.input("q", moved.q);
  const Placement placement = moved.at.placements[frame.joint] * frame.placement;
  graph.output("position", placement.translation());
  graph.output("rotation", placement.rotation());
  return graph.serialize("frame_placement_" + std::to_string(index));
}

std::string frame_velocity(const SymbolicModel& symbolic, std::size_t index, Reference reference) {
  const Moving& moved = moving(symbolic);
  const Frame& frame = symbolic.tree.frames.at(index);
  Graph graph(symbolic);
  graph.input("q", moved.q);
  graph.input("v", moved.v);
  graph.output(
      "velocity",
      of_frame(moved.at.velocities[frame.joint], frame, moved.at.placements[frame.joint], reference).toVector());
  return graph.serialize("frame_velocity_" + std::to_string(index));
}

std::string frame_acceleration(const SymbolicModel& symbolic, std::size_t index, Reference reference) {
  const Moving& moved = moving(symbolic);
  const Frame& frame = symbolic.tree.frames.at(index);
  const Placement& joint = moved.at.placements[frame.joint];
  Graph graph(symbolic);
  graph.input("q", moved.q);
  graph.input("v", moved.v);
  graph.input("a", moved.a);
  const Motion velocity = of_frame(moved.at.velocities[frame.joint], frame, joint, reference);
  Motion acceleration = of_frame(moved.at.accelerations[frame.joint], frame, joint, reference);
  acceleration.linear() += velocity.angular().cross(velocity.linear());
  graph.output("acceleration", acceleration.toVector());
  return graph.serialize("frame_acceleration_" + std::to_string(index));
}

std::string frame_jacobian(const SymbolicModel& symbolic, std::size_t index, Reference reference) {
  const Tree& tree = symbolic.tree;
  const Kinematics& at = moving(symbolic).at;
  Graph graph(symbolic);
  graph.input("q", moving(symbolic).q);
  Matrix J = Matrix::Zero(6, tree.nv);
  Frame seen = tree.frames.at(index);  // from the joint that moves it
  const Vector3 origin = (at.placements[seen.joint] * seen.placement).translation();
  while (seen.joint > 0) {
    const Joint& joint = tree.joints[seen.joint];
    Placement seen_from = at.placements[seen.joint];
    if (reference == pinocchio::LOCAL_WORLD_ALIGNED) seen_from.translation() -= origin;
    for (Eigen::Index k = 0; k < joint.count; ++k) {
      const Motion axis{Eigen::Matrix<SX, 6, 1>(at.joints[seen.joint].axes.col(k))};
      const Motion column = reference == pinocchio::LOCAL ? seen.placement.actInv(axis) : seen_from.act(axis);
      J.col(joint.first + k) = column.toVector();
    }
    seen = {joint.parent, at.joints[seen.joint].placement * seen.placement};
  }
  graph.output("J", J);
  return graph.serialize("frame_jacobian_" + std::to_string(index));
}

}  // namespace robotraj
