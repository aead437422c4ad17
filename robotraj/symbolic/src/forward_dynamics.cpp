// The articulated-body algorithm in the joints' own axes (Featherstone, Rigid Body Dynamics Algorithms, 2008, table 7.1).
#include "algorithms.hpp"
#include "external_forces.hpp"

namespace robotraj {
namespace {

using Matrix6 = Eigen::Matrix<SX, 6, 6>;

/// Writes X = D^-1 B over B, for a symmetric positive definite D, by D = L diag(d) L'.
void solve_definite(Matrix D, Matrix& B) {
  const Eigen::Index size = D.rows();
  for (Eigen::Index k = 0; k < size; ++k)
    for (Eigen::Index i = k + 1; i < size; ++i) {
      const SX factor = D(i, k) / D(k, k);
      for (Eigen::Index j = k + 1; j <= i; ++j) D(i, j) -= factor * D(j, k);
      B.row(i) -= factor * B.row(k);
    }
  for (Eigen::Index k = size - 1; k >= 0; --k) {
    for (Eigen::Index i = k + 1; i < size; ++i) B.row(k) -= D(i, k) * B.row(i);
    B.row(k) /= SX(D(k, k));
  }
}

void mirror_lower(Matrix6& inertia) {
  for (Eigen::Index j = 0; j < 6; ++j)
    for (Eigen::Index i = 0; i < j; ++i) inertia(i, j) = inertia(j, i);
}

/// An articulated inertia, moved to the axes of the parent: X* I X*'.
Matrix6 moved(const Placement& placement, const Matrix6& inertia) {
  using Block = Eigen::Matrix<SX, 3, 3>;
  const Block R = placement.rotation(), across = pinocchio::skew(placement.translation());
  const Block mass = R * inertia.topLeftCorner<3, 3>() * R.transpose();
  const Block mixed = R * inertia.topRightCorner<3, 3>() * R.transpose();
  const Block lever = across * mass;
  const Block turned = across * mixed;
  Matrix6 result;
  result.topLeftCorner<3, 3>() = mass;
  result.bottomLeftCorner<3, 3>() = mixed.transpose() + lever;
  result.bottomRightCorner<3, 3>() =
      R * inertia.bottomRightCorner<3, 3>() * R.transpose() + turned + turned.transpose() - lever * across;
  mirror_lower(result);
  return result;
}

Vector articulated_bodies(const Tree& tree, const Vector& q, const Vector& v, const Vector& tau,
                          const std::vector<Force>& external) {
  const std::vector<JointMotion> motions = joint_motions(tree, q, v);
  const std::size_t count = tree.joints.size();
  std::vector<Motion> velocity(count, Motion::Zero());
  std::vector<Motion> acceleration(count, Motion(-tree.gravity));
  std::vector<Force> force(count, Force::Zero());
  std::vector<Matrix6> inertia(count);
  for (std::size_t i = 1; i < count; ++i) {
    const auto& [parent, first, rates, rest, body, parts] = tree.joints[i];
    const JointMotion& joint = motions[i];
    velocity[i] = joint.velocity;
    if (parent > 0) velocity[i] += joint.placement.actInv(velocity[parent]);
    acceleration[i] = joint.bias + velocity[i].cross(joint.velocity);
    inertia[i] = body.matrix();
    const Force momentum = body * velocity[i];
    force[i] = velocity[i].cross(momentum);
    force[i] -= external[i];
  }
  // Of every joint: its accelerations are free_rates - gains * (acceleration of its axes, were it locked).
  std::vector<Matrix> gains(count);
  std::vector<Vector> free_rates(count);
  for (std::size_t i = count - 1; i > 0; --i) {
    const auto& [parent, first, rates, rest, body, parts] = tree.joints[i];
    const Subspace& axes = motions[i].axes;
    const Subspace U = inertia[i] * axes;
    Matrix D = axes.transpose() * U;
    D.diagonal() += tree.armature.segment(first, rates);
    Matrix solved(rates, 7);
    solved << U.transpose(), tau.segment(first, rates) - axes.transpose() * force[i].toVector();
    solve_definite(D, solved);
    gains[i] = solved.leftCols<6>();
    free_rates[i] = solved.col(6);
    if (parent == 0) continue;
    inertia[i] -= U * gains[i];
    mirror_lower(inertia[i]);
    force[i].toVector() += inertia[i] * acceleration[i].toVector() + U * free_rates[i];
    inertia[parent] += moved(motions[i].placement, inertia[i]);
    force[parent] += motions[i].placement.act(force[i]);
  }
  Vector rates_of_change(tree.nv);
  for (std::size_t i = 1; i < count; ++i) {
    const Joint& joint = tree.joints[i];
    acceleration[i] += motions[i].placement.actInv(acceleration[joint.parent]);
    const Vector rates = free_rates[i] - gains[i] * acceleration[i].toVector();
    acceleration[i] += along(motions[i].axes, rates);
    rates_of_change.segment(joint.first, joint.count) = rates;
  }
  return rates_of_change;
}

}  // namespace

std::string forward_dynamics(const SymbolicModel& symbolic) {
  const Tree& tree = symbolic.tree;
  Graph graph(symbolic);
  const Vector q = graph.input("q", tree.nq);
  const Vector v = graph.input("v", tree.nv);
  const Vector tau = graph.input("tau", tree.nv);
  const std::vector<Force> fext = external_forces(graph, tree);
  graph.output("a", articulated_bodies(tree, q, v, tau, fext));
  return graph.serialize("forward_dynamics");
}

}  // namespace robotraj
