// What follows from the distribution of mass: inertia matrix, energies, centre of mass, momentum.
#include "algorithms.hpp"
#include "kinematics.hpp"

namespace robotraj {
namespace {

SX total_mass(const Tree& tree) {
  SX mass = 0;
  for (std::size_t i = 1; i < tree.joints.size(); ++i) mass += tree.joints[i].body.mass();
  return mass;
}

/// Sum of vectors given in the joints' own axes, in the world's. Rotated joint by joint down the tree: it takes the
/// fewest operations where several sums are wanted.
Vector3 in_world(const Tree& tree, const Kinematics& moved, std::vector<Vector3> parts) {
  for (std::size_t i = parts.size() - 1; i > 0; --i)
    parts[tree.joints[i].parent] += moved.joints[i].placement.rotation() * parts[i];
  return parts[0];
}

/// Sum of mass times centre of mass in the world [kg m].
Vector3 weighted_centre(const Tree& tree, const Kinematics& moved) {
  const std::size_t count = tree.joints.size();
  std::vector<SX> masses(count, SX(0));
  std::vector<Vector3> parts(count, Vector3::Zero());
  for (std::size_t i = count - 1; i > 0; --i) {
    const Joint& joint = tree.joints[i];
    masses[i] += joint.body.mass();
    parts[i] += joint.body.mass() * joint.body.lever();
    const Placement& placement = moved.joints[i].placement;
    masses[joint.parent] += masses[i];
    parts[joint.parent] += placement.rotation() * parts[i] + masses[i] * placement.translation();
  }
  return parts[0];
}

}  // namespace

/// The composite-rigid-body algorithm (Featherstone, Rigid Body Dynamics Algorithms, 2008, table 6.2).
std::string mass_matrix(const SymbolicModel& symbolic) {
  const Tree& tree = symbolic.tree;
  Graph graph(symbolic);
  const Vector q = graph.input("q", tree.nq);
  const std::vector<JointMotion> motions = joint_motions(tree, q, Vector::Zero(tree.nv));
  std::vector<Inertia> composite;
  for (const Joint& joint : tree.joints) composite.push_back(joint.body);
  Matrix M = Matrix::Zero(tree.nv, tree.nv);
  for (std::size_t i = tree.joints.size() - 1; i > 0; --i) {
    const Joint& joint = tree.joints[i];
    if (joint.parent > 0) composite[joint.parent] += motions[i].placement.act(composite[i]);
    for (Eigen::Index k = 0; k < joint.count; ++k) {
      Force force = composite[i] * Motion(Eigen::Matrix<SX, 6, 1>(motions[i].axes.col(k)));
      for (std::size_t above = i; above > 0; above = tree.joints[above].parent) {
        const Joint& carrier = tree.joints[above];
        const Vector row = motions[above].axes.transpose() * force.toVector();
        M.block(carrier.first, joint.first + k, carrier.count, 1) = row;
        M.block(joint.first + k, carrier.first, 1, carrier.count) = row.transpose();
        if (carrier.parent > 0) force = motions[above].placement.act(force);
      }
    }
  }
  M.diagonal() += tree.armature;
  graph.output("M", M);
  return graph.serialize("mass_matrix");
}

std::string kinetic_energy(const SymbolicModel& symbolic) {
  const Tree& tree = symbolic.tree;
  Graph graph(symbolic);
  const Vector q = graph.input("q", tree.nq);
  const Vector v = graph.input("v", tree.nv);
  const Kinematics moved = move(tree, q, v, Vector::Zero(tree.nv));
  SX twice = 0;
  for (std::size_t i = 1; i < tree.joints.size(); ++i) twice += tree.joints[i].body.vtiv(moved.velocities[i]);
  for (Eigen::Index k = 0; k < tree.nv; ++k) twice += tree.armature[k] * v[k] * v[k];
  graph.output("energy", twice / 2);
  return graph.serialize("kinetic_energy");
}

std::string potential_energy(const SymbolicModel& symbolic) {
  const Tree& tree = symbolic.tree;
  Graph graph(symbolic);
  const Vector q = graph.input("q", tree.nq);
  const Vector zero = Vector::Zero(tree.nv);
  graph.output("energy", SX(-weighted_centre(tree, move(tree, q, zero, zero)).dot(tree.gravity.linear())));
  return graph.serialize("potential_energy");
}

std::string center_of_mass(const SymbolicModel& symbolic) {
  const Tree& tree = symbolic.tree;
  Graph graph(symbolic);
  const Vector q = graph.input("q", tree.nq);
  const Vector v = graph.input("v", tree.nv);
  const Vector a = graph.input("a", tree.nv);
  const Kinematics moved = move(tree, q, v, a);
  std::vector<Vector3> momenta(tree.joints.size(), Vector3::Zero()), forces = momenta;
  for (std::size_t i = 1; i < tree.joints.size(); ++i) {
    const Inertia& body = tree.joints[i].body;
    const Motion& velocity = moved.velocities[i];
    const Motion& acceleration = moved.accelerations[i];
    momenta[i] = body.mass() * (velocity.angular().cross(body.lever()) + velocity.linear());
    // The second derivative of the centre's position; the spatial acceleration leaves omega x velocity out.
    forces[i] = body.mass() * (acceleration.angular().cross(body.lever()) + acceleration.linear()) +
                velocity.angular().cross(momenta[i]);
  }
  const SX mass = total_mass(tree);
  graph.output("position", weighted_centre(tree, moved) / mass);
  graph.output("velocity", in_world(tree, moved, momenta) / mass);
  graph.output("acceleration", in_world(tree, moved, forces) / mass);
  return graph.serialize("center_of_mass");
}

std::string centroidal_momentum(const SymbolicModel& symbolic) {
  const Tree& tree = symbolic.tree;
  Graph graph(symbolic);
  const Vector q = graph.input("q", tree.nq);
  const Vector v = graph.input("v", tree.nv);
  const Kinematics moved = move(tree, q, v, Vector::Zero(tree.nv));
  std::vector<Force> momenta(tree.joints.size(), Force::Zero());
  for (std::size_t i = tree.joints.size() - 1; i > 0; --i) {
    momenta[i] += tree.joints[i].body * moved.velocities[i];
    momenta[tree.joints[i].parent] += moved.joints[i].placement.act(momenta[i]);
  }
  const Vector3 centre = weighted_centre(tree, moved) / total_mass(tree);
  Force& about_centre = momenta[0];
  about_centre.angular() += about_centre.linear().cross(centre);
  graph.output("h", about_centre.toVector());
  return graph.serialize("centroidal_momentum");
}

}  // namespace robotraj
