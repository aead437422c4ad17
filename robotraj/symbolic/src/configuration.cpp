// Moving on the configuration space, which is no vector space when a joint turns freely.
#include "algorithms.hpp"
#include "graph.hpp"
#include "planar.hpp"

#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/multibody.hpp>

#include <boost/variant/get.hpp>

#include <stdexcept>
#include <vector>

namespace robotraj {
namespace {

using JointType = pinocchio::JointModelTpl<SX>;
using CompositeJoint = pinocchio::JointModelCompositeTpl<SX>;

/// Rate of a unit quaternion (x, y, z, w) under the body's angular velocity: half of the product with (w, 0).
Eigen::Matrix<SX, 4, 1> quaternion_rate(const Vector& quaternion, const Vector& omega) {
  const SX &x = quaternion[0], &y = quaternion[1], &z = quaternion[2], &w = quaternion[3];
  Eigen::Matrix<SX, 4, 1> rate;
  rate << w * omega[0] + y * omega[2] - z * omega[1], w * omega[1] + z * omega[0] - x * omega[2],
      w * omega[2] + x * omega[1] - y * omega[0], -(x * omega[0] + y * omega[1] + z * omega[2]);
  return rate * SX(0.5);
}

/// Rotation matrix of a unit quaternion applied to a vector, without Eigen's products of the two halves.
Eigen::Matrix<SX, 3, 1> rotated(const Vector& quaternion, const Vector& vector) {
  const Eigen::Matrix<SX, 3, 1> axis = quaternion.head<3>(), velocity = vector;
  const Eigen::Matrix<SX, 3, 1> cross = axis.cross(velocity) * SX(2);
  return velocity + cross * quaternion[3] + axis.cross(cross);
}

/// A joint, or the parts of a composite one.
void append_parts(const JointType& joint, std::vector<JointType>& parts) {
  if (joint.shortname() == CompositeJoint::classname()) {
    for (const auto& part : boost::get<CompositeJoint>(joint.toVariant()).joints) append_parts(part, parts);
  } else {
    parts.push_back(joint);
  }
}

std::vector<JointType> simple_joints(const Model& model) {
  std::vector<JointType> parts;
  for (std::size_t joint = 1; joint < model.joints.size(); ++joint) append_parts(model.joints[joint], parts);
  return parts;
}

bool is_continuous(const JointType& joint) { return joint.nq() == 2 && joint.nv() == 1; }

bool is_planar(const JointType& joint) { return joint.shortname() == pinocchio::JointModelPlanarTpl<SX>::classname(); }

void write_rate(const JointType& joint, const Vector& q, const Vector& v, Vector& rate) {
  const int nq = joint.nq(), nv = joint.nv();
  const Vector here = q.segment(joint.idx_q(), nq), velocity = v.segment(joint.idx_v(), nv);
  auto out = rate.segment(joint.idx_q(), nq);
  if (nq == nv) {
    out = velocity;
  } else if (is_continuous(joint)) {  // (cos, sin)
    out << -here[1] * velocity[0], here[0] * velocity[0];
  } else if (is_planar(joint)) {  // (x, y, cos, sin), velocity in the body frame
    out << here[2] * velocity[0] - here[3] * velocity[1], here[3] * velocity[0] + here[2] * velocity[1],
        -here[3] * velocity[2], here[2] * velocity[2];
  } else if (nq == 4 && nv == 3) {  // quaternion
    out = quaternion_rate(here, velocity);
  } else if (nq == 7 && nv == 6) {  // position and quaternion, velocity in the body frame
    out.head(3) = rotated(here.tail(4), velocity.head(3));
    out.tail(4) = quaternion_rate(here.tail(4), velocity.tail(3));
  } else {
    throw std::invalid_argument("the rate of a joint of type " + joint.shortname() + " is not known");
  }
}

}  // namespace

std::string integrate(const SymbolicModel& symbolic) {
  const Model& model = *symbolic.tree.model;
  Graph graph(symbolic);
  const Vector q = graph.input("q", model.nq);
  const Vector dv = graph.input("dv", model.nv);
  Vector q1 = pinocchio::integrate(model, q, dv);
  for (const JointType& joint : simple_joints(model))
    if (is_planar(joint))
      q1.segment(joint.idx_q(), 4) = planar_integrate(q.segment(joint.idx_q(), 4), dv.segment(joint.idx_v(), 3));
  graph.output("q1", q1);
  return graph.serialize("integrate");
}

std::string difference(const SymbolicModel& symbolic) {
  const Model& model = *symbolic.tree.model;
  Graph graph(symbolic);
  const Vector q0 = graph.input("q0", model.nq);
  const Vector q1 = graph.input("q1", model.nq);
  Vector dv = pinocchio::difference(model, q0, q1);
  for (const JointType& joint : simple_joints(model)) {
    const auto from = joint.idx_q();
    if (is_continuous(joint)) dv[joint.idx_v()] = angle_between(q0[from], q0[from + 1], q1[from], q1[from + 1]);
    else if (is_planar(joint))
      dv.segment(joint.idx_v(), 3) = planar_difference(q0.segment(from, 4), q1.segment(from, 4));
  }
  graph.output("dv", dv);
  return graph.serialize("difference");
}

std::string configuration_rate(const SymbolicModel& symbolic) {
  const Model& model = *symbolic.tree.model;
  Graph graph(symbolic);
  const Vector q = graph.input("q", model.nq);
  const Vector v = graph.input("v", model.nv);
  Vector rate(model.nq);
  for (const JointType& joint : simple_joints(model)) write_rate(joint, q, v, rate);
  graph.output("qdot", rate);
  return graph.serialize("configuration_rate");
}

}  // namespace robotraj
