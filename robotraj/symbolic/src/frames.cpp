#include "algorithms.hpp"
#include "graph.hpp"

#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/kinematics.hpp>

namespace robotraj {

/// The motion of all joints as expressions of q, v and a: all frames of a model have it in common. Pinocchio's `Data`
/// of casadi::SX alone takes longer to make than a frame's expressions.
struct Kinematics {
  explicit Kinematics(const Model& model)
      : q(SX::sym("q", model.nq)), v(SX::sym("v", model.nv)), a(SX::sym("a", model.nv)), data(model) {
    const Matrix q_ = to_eigen(q), v_ = to_eigen(v), a_ = to_eigen(a);
    pinocchio::forwardKinematics(model, data, q_.col(0), v_.col(0), a_.col(0));
  }

  SX q, v, a;
  Data data;
};

namespace {

Kinematics& kinematics_of(const SymbolicModel& symbolic) {
  if (!symbolic.kinematics) symbolic.kinematics = std::make_shared<Kinematics>(symbolic.model);
  return *symbolic.kinematics;
}

}  // namespace

std::string frame_placement(const SymbolicModel& symbolic, std::size_t frame) {
  Kinematics& moved = kinematics_of(symbolic);
  Graph graph(symbolic);
  graph.input("q", moved.q);
  const auto& placement = pinocchio::updateFramePlacement(symbolic.model, moved.data, frame);
  graph.output("position", placement.translation());
  graph.output("rotation", placement.rotation());
  return graph.serialize("frame_placement_" + std::to_string(frame));
}

std::string frame_velocity(const SymbolicModel& symbolic, std::size_t frame, Reference reference) {
  Kinematics& moved = kinematics_of(symbolic);
  Graph graph(symbolic);
  graph.input("q", moved.q);
  graph.input("v", moved.v);
  graph.output("velocity", pinocchio::getFrameVelocity(symbolic.model, moved.data, frame,
                                                       static_cast<pinocchio::ReferenceFrame>(reference))
                               .toVector());
  return graph.serialize("frame_velocity_" + std::to_string(frame));
}

std::string frame_acceleration(const SymbolicModel& symbolic, std::size_t frame, Reference reference) {
  Kinematics& moved = kinematics_of(symbolic);
  Graph graph(symbolic);
  graph.input("q", moved.q);
  graph.input("v", moved.v);
  graph.input("a", moved.a);
  graph.output("acceleration", pinocchio::getFrameClassicalAcceleration(
                                   symbolic.model, moved.data, frame, static_cast<pinocchio::ReferenceFrame>(reference))
                                   .toVector());
  return graph.serialize("frame_acceleration_" + std::to_string(frame));
}

std::string frame_jacobian(const SymbolicModel& symbolic, std::size_t frame, Reference reference) {
  const Model& model = symbolic.model;
  Kinematics& moved = kinematics_of(symbolic);
  Graph graph(symbolic);
  graph.input("q", moved.q);
  const Matrix q = to_eigen(moved.q);
  Data::Matrix6x J = Data::Matrix6x::Constant(6, model.nv, SX(0));
  // It moves the joints on the frame's branch once more, to the same placements.
  pinocchio::computeFrameJacobian(model, moved.data, q.col(0), frame, static_cast<pinocchio::ReferenceFrame>(reference),
                                  J);
  graph.output("J", J);
  return graph.serialize("frame_jacobian_" + std::to_string(frame));
}

}  // namespace robotraj
