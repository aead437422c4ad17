// The recursive Newton-Euler algorithm (Featherstone, Rigid Body Dynamics Algorithms, 2008, table 5.1).
#include "algorithms.hpp"
#include "external_forces.hpp"

namespace robotraj {
namespace {

/// Torques at q, v and a; what follows from inputs of zero vanishes from the expressions.
Vector newton_euler(const Tree& tree, const Vector& q, const Vector& v, const Vector& a,
                    const std::vector<Force>& external) {
  const std::vector<JointMotion> motions = joint_motions(tree, q, v);
  const std::size_t count = tree.joints.size();
  std::vector<Motion> velocity(count, Motion::Zero());
  std::vector<Motion> acceleration(count, Motion(-tree.gravity));
  std::vector<Force> force(count, Force::Zero());
  for (std::size_t i = 1; i < count; ++i) {
    const auto& [parent, first, rates, rest, body, parts] = tree.joints[i];
    const JointMotion& joint = motions[i];
    velocity[i] = joint.velocity;
    if (parent > 0) velocity[i] += joint.placement.actInv(velocity[parent]);
    acceleration[i] = joint.bias + velocity[i].cross(joint.velocity);
    acceleration[i] += along(joint.axes, a.segment(first, rates));
    acceleration[i] += joint.placement.actInv(acceleration[parent]);
    const Force momentum = body * velocity[i];
    force[i] = body * acceleration[i];
    force[i] += velocity[i].cross(momentum);
    if (!external.empty()) force[i] -= external[i];
  }
  Vector torques(tree.nv);
  for (std::size_t i = count - 1; i > 0; --i) {
    const Joint& joint = tree.joints[i];
    torques.segment(joint.first, joint.count) = motions[i].axes.transpose() * force[i].toVector();
    if (joint.parent > 0) force[joint.parent] += motions[i].placement.act(force[i]);
  }
  return torques + tree.armature.cwiseProduct(a);
}

}  // namespace

std::string inverse_dynamics(const SymbolicModel& symbolic) {
  const Tree& tree = symbolic.tree;
  Graph graph(symbolic);
  const Vector q = graph.input("q", tree.nq);
  const Vector v = graph.input("v", tree.nv);
  const Vector a = graph.input("a", tree.nv);
  const std::vector<Force> fext = external_forces(graph, tree);
  graph.output("tau", newton_euler(tree, q, v, a, fext));
  return graph.serialize("inverse_dynamics");
}

std::string nonlinear_effects(const SymbolicModel& symbolic) {
  const Tree& tree = symbolic.tree;
  Graph graph(symbolic);
  const Vector q = graph.input("q", tree.nq);
  const Vector v = graph.input("v", tree.nv);
  graph.output("nle", newton_euler(tree, q, v, Vector::Zero(tree.nv), {}));
  return graph.serialize("nonlinear_effects");
}

std::string gravity(const SymbolicModel& symbolic) {
  const Tree& tree = symbolic.tree;
  Graph graph(symbolic);
  const Vector q = graph.input("q", tree.nq);
  graph.output("g", newton_euler(tree, q, Vector::Zero(tree.nv), Vector::Zero(tree.nv), {}));
  return graph.serialize("gravity");
}

}  // namespace robotraj
