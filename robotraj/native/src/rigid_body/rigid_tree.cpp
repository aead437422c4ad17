#include "rigid_tree.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <iterator>

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

/// Plain arrays, matrices row after row.
using Rows = Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
using ConstRows = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
using Column = Eigen::Map<Vector3>;
using ConstColumn = Eigen::Map<const Vector3>;

}  // namespace

RigidTree::RigidTree(const std::vector<Link>& links, const double* gravity, bool flies) {
  std::copy(gravity, gravity + 3, rest_.gravity);
  rest_.flies = flies;
  std::vector<Matrix3> axes;
  for (const Link& link : links) {
    Joint joint{};
    joint.parent = link.parent;
    joint.turns = link.turns;
    joint.armature = link.armature;
    const bool free = flies && joints_.empty();
    const Matrix3 rotation = ConstRows(link.rotation);
    // A free-flyer's body lies in its own axes.
    axes.push_back(free ? Matrix3(Matrix3::Identity()) : axes_along(ConstColumn(link.direction)));
    if (free) Rows(rest_.flyer) = rotation;
    const Matrix3 own = axes.back();
    const Matrix3 into = link.parent < 0 ? Matrix3(Matrix3::Identity()) : Matrix3(axes[link.parent].transpose());
    Rows(joint.rotation) = into * rotation * own;
    Column(joint.translation) = into * ConstColumn(link.translation);
    joint.mass = link.mass;
    Column(joint.lever) = link.mass * (own.transpose() * ConstColumn(link.centre));
    const Matrix3 inertia = own.transpose() * ConstRows(link.inertia) * own;
    const double entries[] = {inertia(0, 0), inertia(0, 1), inertia(1, 1), inertia(0, 2), inertia(1, 2), inertia(2, 2)};
    std::copy(std::begin(entries), std::end(entries), joint.inertia);
    joints_.push_back(joint);
  }
  rest_.count = joints_.size();
}

Pattern jacobian_pattern(const Tree& tree) {
  const auto nq = tree.positions(), nv = tree.rates();
  Pattern pattern;
  const auto add = [&](std::size_t row, std::size_t column) { pattern.add(row, column); };
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
  const auto add = [&](std::size_t row, std::size_t column) { pattern.add(row, column); };
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
