#include "straight_motion.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace robotraj::native::collision {

StraightMotion::StraightMotion(const SphereTree& tree, double margin, double resolution)
    : tree_(tree),
      margin_(margin),
      resolution_(resolution),
      step_(tree.joints.size()),
      q_(tree.joints.size()),
      rates_{step_, step_, std::vector<double>(tree.joints.size(), 0.0)},
      spheres_(tree) {}

bool StraightMotion::free(const double* a, const double* b) {
  for (std::size_t i = 0; i < step_.size(); ++i) {
    step_[i] = b[i] - a[i];
    rates_.rate[i] = std::abs(step_[i]);
    rates_.position[i] = std::max(std::abs(a[i]), std::abs(b[i]));
  }
  spheres_.bound(rates_);
  // Level after level, so that a blocked motion is found early.
  std::vector<double> level = {0.5}, next;
  for (double h = 0.5; !level.empty(); h *= 0.5) {
    next.clear();
    for (const double s : level) {
      for (std::size_t i = 0; i < q_.size(); ++i) q_[i] = a[i] + s * step_[i];
      const Verdict verdict = examine(h);
      if (verdict == Verdict::blocked) return false;
      if (verdict == Verdict::open) {
        next.push_back(s - 0.5 * h);
        next.push_back(s + 0.5 * h);
      }
    }
    level.swap(next);
  }
  return true;
}

StraightMotion::Verdict StraightMotion::examine(double h) {
  spheres_.move(q_.data(), step_.data());
  bool open = false;
  for (const Group& group : tree_.groups) {
    const Verdict verdict = against_shapes(group, h);
    if (verdict == Verdict::blocked) return verdict;
    open = open || verdict == Verdict::open;
  }
  for (std::size_t pair = 0; pair < tree_.pairs.size(); ++pair) {
    const Verdict verdict = between(pair, h);
    if (verdict == Verdict::blocked) return verdict;
    open = open || verdict == Verdict::open;
  }
  return open ? Verdict::open : Verdict::free;
}

StraightMotion::Verdict StraightMotion::judge(double left, double change) const {
  if (left > change) return Verdict::free;
  return left < 0.0 || change < resolution_ ? Verdict::blocked : Verdict::open;
}

StraightMotion::Verdict StraightMotion::against_shapes(const Group& group, double h) {
  if (group.joint < 0) return Verdict::free;  // it does not move
  const Vector3 middle = spheres_.middle(group), drift = spheres_.velocity(group.joint, middle);
  const double curve = 0.5 * h * h * spheres_.bend(group.joint, group.bound.centre);
  bool open = false;
  for (const Shape& shape : tree_.shapes) {
    const Distance whole = shape.distance(middle);
    if (whole.value - group.bound.radius - margin_ > h * std::abs(whole.gradient.dot(drift)) + curve) continue;
    for (std::size_t s = group.first; s < group.last; ++s) {
      const Sphere& sphere = tree_.spheres[s];
      const Vector3& centre = spheres_.centre(s);
      const Distance own = shape.distance(centre);
      const Verdict verdict = judge(own.value - sphere.radius - margin_,
                                    h * std::abs(own.gradient.dot(spheres_.velocity(group.joint, centre))) +
                                        0.5 * h * h * spheres_.bend(group.joint, sphere.centre));
      if (verdict == Verdict::blocked) return verdict;
      open = open || verdict == Verdict::open;
    }
  }
  return open ? Verdict::open : Verdict::free;
}

StraightMotion::Verdict StraightMotion::between(std::size_t number, double h) {
  const Pair& pair = tree_.pairs[number];
  const Group &a = tree_.groups[pair.first], &b = tree_.groups[pair.second];
  if (a.joint == b.joint) return Verdict::free;
  const auto verdict_of = [&](const Sphere& s, const Vector3& p, const Sphere& t, const Vector3& q) {
    const Vector3 apart = p - q;
    const double length = apart.norm();
    const Vector3 drift = spheres_.velocity(pair, a.joint, p) - spheres_.velocity(pair, b.joint, q);
    const double curve = spheres_.bend(number, a.joint, s.centre) + spheres_.bend(number, b.joint, t.centre);
    return judge(length - s.radius - t.radius - margin_,
                 h * std::abs(apart.dot(drift)) / std::max(length, 1e-12) + 0.5 * h * h * curve);
  };
  if (verdict_of(a.bound, spheres_.middle(a), b.bound, spheres_.middle(b)) == Verdict::free) return Verdict::free;
  bool open = false;
  for (std::size_t s = a.first; s < a.last; ++s)
    for (std::size_t t = b.first; t < b.last; ++t) {
      const Verdict verdict = verdict_of(tree_.spheres[s], spheres_.centre(s), tree_.spheres[t], spheres_.centre(t));
      if (verdict == Verdict::blocked) return verdict;
      open = open || verdict == Verdict::open;
    }
  return open ? Verdict::open : Verdict::free;
}

}  // namespace robotraj::native::collision
