// Moving on the configuration space, which is no vector space when a joint turns freely.
#include "algorithms.hpp"
#include "graph.hpp"
#include "planar.hpp"

#include <pinocchio/multibody/liegroup.hpp>

namespace robotraj {
namespace {

using Circle = pinocchio::SpecialOrthogonalOperationTpl<2, SX>;
using Rotations = pinocchio::SpecialOrthogonalOperationTpl<3, SX>;
using Placements = pinocchio::SpecialEuclideanOperationTpl<3, SX>;

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

Vector rate_of(const JointPart& part, const Vector& q, const Vector& v) {
  Vector rate(part.positions());
  switch (part.kind) {
    case JointKind::screw: rate = v; break;
    case JointKind::circle: rate << -q[1] * v[0], q[0] * v[0]; break;
    case JointKind::planar:
      rate << q[2] * v[0] - q[3] * v[1], q[3] * v[0] + q[2] * v[1], -q[3] * v[2], q[2] * v[2];
      break;
    case JointKind::spherical: rate = quaternion_rate(q, v); break;
    case JointKind::free_flyer:
      rate.head(3) = rotated(q.tail(4), v.head(3));
      rate.tail(4) = quaternion_rate(q.tail(4), v.tail(3));
      break;
  }
  return rate;
}

Vector step_from(const JointPart& part, const Vector& q, const Vector& dv) {
  Vector q1(part.positions());
  switch (part.kind) {
    case JointKind::screw: q1 = q + dv; break;
    case JointKind::circle: Circle().integrate(q, dv, q1); break;
    case JointKind::planar: q1 = planar_integrate(q, dv); break;
    case JointKind::spherical: Rotations().integrate(q, dv, q1); break;
    case JointKind::free_flyer: Placements().integrate(q, dv, q1); break;
  }
  return q1;
}

Vector step_between(const JointPart& part, const Vector& q0, const Vector& q1) {
  Vector dv(part.rates());
  switch (part.kind) {
    case JointKind::screw: dv = q1 - q0; break;
    case JointKind::circle: dv[0] = angle_between(q0[0], q0[1], q1[0], q1[1]); break;
    case JointKind::planar: dv = planar_difference(q0, q1); break;
    case JointKind::spherical: Rotations().difference(q0, q1, dv); break;
    case JointKind::free_flyer: Placements().difference(q0, q1, dv); break;
  }
  return dv;
}

std::vector<JointPart> parts_of(const Tree& tree) {
  std::vector<JointPart> parts;
  for (const Joint& joint : tree.joints) parts.insert(parts.end(), joint.parts.begin(), joint.parts.end());
  return parts;
}

}  // namespace

std::string integrate(const SymbolicModel& symbolic) {
  const Tree& tree = symbolic.tree;
  Graph graph(symbolic);
  const Vector q = graph.input("q", tree.nq);
  const Vector dv = graph.input("dv", tree.nv);
  Vector q1(tree.nq);
  for (const JointPart& part : parts_of(tree))
    q1.segment(part.q, part.positions()) =
        step_from(part, q.segment(part.q, part.positions()), dv.segment(part.v, part.rates()));
  graph.output("q1", q1);
  return graph.serialize("integrate");
}

std::string difference(const SymbolicModel& symbolic) {
  const Tree& tree = symbolic.tree;
  Graph graph(symbolic);
  const Vector q0 = graph.input("q0", tree.nq);
  const Vector q1 = graph.input("q1", tree.nq);
  Vector dv(tree.nv);
  for (const JointPart& part : parts_of(tree))
    dv.segment(part.v, part.rates()) =
        step_between(part, q0.segment(part.q, part.positions()), q1.segment(part.q, part.positions()));
  graph.output("dv", dv);
  return graph.serialize("difference");
}

std::string configuration_rate(const SymbolicModel& symbolic) {
  const Tree& tree = symbolic.tree;
  Graph graph(symbolic);
  const Vector q = graph.input("q", tree.nq);
  const Vector v = graph.input("v", tree.nv);
  Vector rate(tree.nq);
  for (const JointPart& part : parts_of(tree))
    rate.segment(part.q, part.positions()) =
        rate_of(part, q.segment(part.q, part.positions()), v.segment(part.v, part.rates()));
  graph.output("qdot", rate);
  return graph.serialize("configuration_rate");
}

}  // namespace robotraj
