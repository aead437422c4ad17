#include "algorithms.hpp"
#include "graph.hpp"

#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/kinematics.hpp>

namespace robotraj {

std::string frame_placement(const SymbolicModel& symbolic, std::size_t frame) {
  const Model& model = symbolic.model;
  Data data(model);
  Graph graph(symbolic);
  const Vector q = graph.input("q", model.nq);
  pinocchio::forwardKinematics(model, data, q);
  const auto& placement = pinocchio::updateFramePlacement(model, data, frame);
  graph.output("position", placement.translation());
  graph.output("rotation", placement.rotation());
  return graph.serialize("frame_placement_" + std::to_string(frame));
}

std::string frame_velocity(const SymbolicModel& symbolic, std::size_t frame, Reference reference) {
  const Model& model = symbolic.model;
  Data data(model);
  Graph graph(symbolic);
  const Vector q = graph.input("q", model.nq);
  const Vector v = graph.input("v", model.nv);
  pinocchio::forwardKinematics(model, data, q, v);
  graph.output("velocity", pinocchio::getFrameVelocity(
      model, data, frame, static_cast<pinocchio::ReferenceFrame>(reference)).toVector());
  return graph.serialize("frame_velocity_" + std::to_string(frame));
}

std::string frame_acceleration(const SymbolicModel& symbolic, std::size_t frame, Reference reference) {
  const Model& model = symbolic.model;
  Data data(model);
  Graph graph(symbolic);
  const Vector q = graph.input("q", model.nq);
  const Vector v = graph.input("v", model.nv);
  const Vector a = graph.input("a", model.nv);
  pinocchio::forwardKinematics(model, data, q, v, a);
  graph.output("acceleration", pinocchio::getFrameClassicalAcceleration(
      model, data, frame, static_cast<pinocchio::ReferenceFrame>(reference)).toVector());
  return graph.serialize("frame_acceleration_" + std::to_string(frame));
}

std::string frame_jacobian(const SymbolicModel& symbolic, std::size_t frame, Reference reference) {
  const Model& model = symbolic.model;
  Data data(model);
  Graph graph(symbolic);
  const Vector q = graph.input("q", model.nq);
  Data::Matrix6x J = Data::Matrix6x::Constant(6, model.nv, SX(0));
  pinocchio::computeFrameJacobian(
      model, data, q, frame, static_cast<pinocchio::ReferenceFrame>(reference), J);
  graph.output("J", J);
  return graph.serialize("frame_jacobian_" + std::to_string(frame));
}

}  // namespace robotraj
