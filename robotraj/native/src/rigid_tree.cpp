#include "rigid_tree.hpp"

#include <pinocchio/multibody.hpp>
#include <pinocchio/serialization.hpp>

#include <stdexcept>

namespace robotraj::native {

namespace {

using Matrix3 = Eigen::Matrix3d;
using Vector3 = Eigen::Vector3d;

/// Axes whose z is the direction of a joint.
Matrix3 axes_along(const Vector3& z) {
  const Vector3 candidates[] = {Vector3::UnitX(), Vector3::UnitY(), Vector3::UnitZ()};
  Eigen::Index least;
  z.cwiseAbs().minCoeff(&least);
  const Vector3 x = candidates[least].cross(z).normalized();
  Matrix3 axes;
  axes << x, z.cross(x), z;
  return axes;
}

void write_matrix(const Matrix3& from, double* to) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) to[3 * row + column] = from(row, column);
}

void write_vector(const Vector3& from, double* to) {
  for (int row = 0; row < 3; ++row) to[row] = from[row];
}

std::invalid_argument refusal(const std::string& name, const std::string& kind) {
  return std::invalid_argument("joint '" + name + "' (" + kind + ") neither turns about an axis nor slides along one");
}

/// Direction of a joint in its own frame, and whether it turns.
std::pair<Vector3, bool> direction(const pinocchio::Model& model, std::size_t joint) {
  const pinocchio::JointModel& kind = model.joints[joint];
  if (kind.nq() != 1 || kind.nv() != 1) throw refusal(model.names[joint], kind.shortname());
  pinocchio::JointModel alone = kind;
  alone.setIndexes(1, 0, 0);
  pinocchio::JointData data = alone.createData();
  alone.calc(data, Eigen::VectorXd::Zero(1));
  const Eigen::Matrix<double, 6, 1> along = data.S().matrix().col(0);
  const Vector3 linear = along.head<3>(), angular = along.tail<3>();
  constexpr double tiny = 1e-14;
  if (linear.norm() < tiny && std::abs(angular.norm() - 1.0) < tiny) return {angular, true};
  if (angular.norm() < tiny && std::abs(linear.norm() - 1.0) < tiny) return {linear, false};
  throw refusal(model.names[joint], kind.shortname());
}

}  // namespace

RigidTree read_tree(const std::string& text) {
  pinocchio::Model model;
  pinocchio::serialization::loadFromString(model, text);
  RigidTree made;
  std::vector<Joint>& joints = made.joints;
  Tree& tree = made.tree;
  write_vector(model.gravity.linear(), tree.gravity);
  std::vector<Matrix3> axes(model.njoints, Matrix3::Identity());
  for (std::size_t i = 1; i < static_cast<std::size_t>(model.njoints); ++i) {
    Joint joint{};
    joint.parent = static_cast<std::int32_t>(model.parents[i]) - 1;
    const bool flies = model.joints[i].shortname() == "JointModelFreeFlyer" && i == 1;
    if (flies) {
      tree.flies = true;
      write_matrix(model.jointPlacements[i].rotation(), tree.flyer);
    } else {
      std::tie(axes[i], joint.turns) = [&] {
        const auto [along, turns] = direction(model, i);
        return std::pair(axes_along(along), turns);
      }();
      joint.armature = model.armature[model.joints[i].idx_v()];
      if (tree.flies && joint.parent < 0)
        throw std::invalid_argument("joint '" + model.names[i] + "' hangs in the world beside a free-flyer");
      if (model.joints[i].idx_v() != static_cast<int>(tree.rate(joints.size())) ||
          model.joints[i].idx_q() != static_cast<int>(tree.position(joints.size())))
        throw std::invalid_argument("the model's joints are not numbered one after the other");
    }
    // A free-flyer's body lies in its own axes.
    const std::size_t parent = model.parents[i];
    const Matrix3 into = axes[parent].transpose();
    write_matrix(into * model.jointPlacements[i].rotation() * axes[i], joint.rotation);
    write_vector(into * model.jointPlacements[i].translation(), joint.translation);
    const auto& body = model.inertias[i];
    joint.mass = body.mass();
    write_vector(body.mass() * (axes[i].transpose() * body.lever()), joint.lever);
    const Matrix3 inertia = axes[i].transpose() * body.inertia().matrix() * axes[i];
    const double entries[] = {inertia(0, 0), inertia(0, 1), inertia(1, 1), inertia(0, 2), inertia(1, 2), inertia(2, 2)};
    std::copy(std::begin(entries), std::end(entries), joint.inertia);
    joints.push_back(joint);
  }
  if (tree.flies && model.armature.head<6>().any())
    throw std::invalid_argument("the free-flyer has armature");
  tree.joints = joints.data();
  tree.count = joints.size();
  return made;
}

Pattern jacobian_pattern(const Tree& tree) {
  const auto nq = tree.positions(), nv = tree.rates();
  Pattern pattern;
  const auto add = [&](std::size_t row, std::size_t column) { pattern.emplace_back(row, column); };
  const std::size_t first = tree.first();
  for (std::size_t j = first; j < tree.count; ++j) {
    const std::size_t q = tree.position(j), w = nq + tree.rate(j), a = nq + nv + tree.rate(j);
    for (std::int32_t k = static_cast<std::int32_t>(j); k >= static_cast<std::int32_t>(first);
         k = tree.joints[k].parent) {
      for (const std::size_t column : {q, w, a}) add(tree.rate(k), column);
      if (k == static_cast<std::int32_t>(j)) continue;
      for (const std::size_t column : {tree.position(k), nq + tree.rate(k), nq + nv + tree.rate(k)})
        add(tree.rate(j), column);
    }
    if (!tree.flies) continue;
    for (std::size_t i = 0; i < 6; ++i) {
      for (const std::size_t column : {q, w, a}) add(i, column);
      for (const std::size_t column : {nq + i, nq + nv + i}) add(tree.rate(j), column);
    }
    for (std::size_t i = 0; i < 4; ++i) add(tree.rate(j), 3 + i);
  }
  for (std::size_t i = 0; tree.flies && i < 6; ++i) {
    for (std::size_t row = 0; row < 6; ++row) {
      add(row, nq + i);
      add(row, nq + nv + i);
      if (i < 4) add(row, 3 + i);
    }
  }
  return pattern;
}

Pattern hessian_pattern(const Tree& tree) {
  const auto nq = tree.positions(), nv = tree.rates();
  Pattern pattern;
  const auto add = [&](std::size_t row, std::size_t column) { pattern.emplace_back(row, column); };
  const std::size_t first = tree.first();
  for (std::size_t j = first; j < tree.count; ++j) {
    const std::size_t q = tree.position(j), w = nq + tree.rate(j), a = nq + nv + tree.rate(j);
    add(q, q);
    add(w, q);
    add(a, q);
    add(w, w);
    for (std::int32_t k = tree.joints[j].parent; k >= static_cast<std::int32_t>(first); k = tree.joints[k].parent) {
      const std::size_t above = tree.position(k), w_above = nq + tree.rate(k);
      add(above, q);
      add(w_above, q);
      add(nq + nv + tree.rate(k), q);
      add(above, w);
      add(w_above, w);
      add(above, a);
    }
    if (!tree.flies) continue;
    for (std::size_t i = 0; i < 6; ++i) {
      add(nq + i, q);
      add(nq + nv + i, q);
      add(nq + i, w);
    }
    for (std::size_t i = 0; i < 4; ++i) add(3 + i, q);
  }
  if (tree.flies) {
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t k = 0; k <= i; ++k) add(nq + i, nq + k);
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t k = 0; k <= i; ++k) add(3 + i, 3 + k);
  }
  return pattern;
}

}  // namespace robotraj::native
