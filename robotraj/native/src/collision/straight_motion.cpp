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
      twists_(tree.joints.size() + 1),
      centres_(tree.spheres.size()) {
  for (const Pair& pair : tree.pairs) {
    auto found = std::find(roots_.begin(), roots_.end(), pair.common);
    root_of_.push_back(found - roots_.begin());
    if (found == roots_.end()) roots_.push_back(pair.common);
  }
  apart_.resize(roots_.size());
}

bool StraightMotion::free(const double* a, const double* b) {
  for (std::size_t i = 0; i < step_.size(); ++i) step_[i] = b[i] - a[i];
  bends_from(-1, a, b, bends_);
  for (std::size_t r = 0; r < roots_.size(); ++r) bends_from(roots_[r], a, b, apart_[r]);
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

void StraightMotion::bends_from(int root, const double* a, const double* b, std::vector<Bend>& bends) const {
  bends.assign(tree_.joints.size(), {});
  for (int i = root + 1; i < tree_.count(); ++i) {
    const Joint& joint = tree_.joints[i];
    const double rate = std::abs(step_[i]);
    const Bend before = joint.parent < 0 || joint.parent == root ? Bend() : bends[joint.parent];
    const double slide = joint.turns ? 0.0 : std::max(std::abs(a[i]), std::abs(b[i]));
    Bend& bend = bends[i];
    bend.linear = before.at(joint.translation.norm() + slide);
    bend.angular = before.angular + (joint.turns ? rate : 0.0);
    bend.turning = before.turning + (joint.turns ? before.angular * rate : 0.0);
    if (!joint.turns) bend.linear += 2.0 * before.angular * rate;
  }
}

StraightMotion::Verdict StraightMotion::examine(double h) {
  ++evaluations;
  tree_.forward(q_.data(), places_);
  for (int i = 0; i < tree_.count(); ++i) {
    const Joint& joint = tree_.joints[i];
    const Vector3 axis = step_[i] * (places_[i].rotation * joint.axis);
    twists_[i] = {twist(joint.parent).angular, velocity(joint.parent, places_[i].position)};
    (joint.turns ? twists_[i].angular : twists_[i].linear) += axis;
  }
  for (const Group& group : tree_.groups)
    for (std::size_t s = group.first; s < group.last; ++s)
      centres_[s] = tree_.of(places_, group.joint) * tree_.spheres[s].centre;
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

Vector3 StraightMotion::velocity(int joint, const Vector3& point) const {
  const Twist& own = twist(joint);
  return own.linear + own.angular.cross(point - tree_.of(places_, joint).position);
}

StraightMotion::Verdict StraightMotion::judge(double left, double change) const {
  if (left > change) return Verdict::free;
  return left < 0.0 || change < resolution_ ? Verdict::blocked : Verdict::open;
}

StraightMotion::Verdict StraightMotion::against_shapes(const Group& group, double h) {
  if (group.joint < 0) return Verdict::free;  // it does not move
  const Bend& bend = bends_[group.joint];
  const Vector3 middle = places_[group.joint] * group.bound.centre, drift = velocity(group.joint, middle);
  const double curve = 0.5 * h * h * bend.at(group.bound.centre.norm());
  bool open = false;
  for (const Shape& shape : tree_.shapes) {
    const Distance whole = shape.distance(middle);
    const double change = h * std::abs(whole.gradient.dot(drift)) + curve;
    if (whole.value - group.bound.radius - margin_ > change) continue;
    for (std::size_t s = group.first; s < group.last; ++s) {
      const Sphere& sphere = tree_.spheres[s];
      const Distance own = shape.distance(centres_[s]);
      const Verdict verdict = judge(own.value - sphere.radius - margin_,
                                    h * std::abs(own.gradient.dot(velocity(group.joint, centres_[s]))) +
                                        0.5 * h * h * bend.at(sphere.centre.norm()));
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
  const std::vector<Bend>& bends = apart_[root_of_[number]];
  /// Velocity in the frame of the joint that carries both, and the bound on its change.
  const auto relative = [&](int joint, const Vector3& point) -> Vector3 {
    if (joint == pair.common) return Vector3::Zero();
    return velocity(joint, point) - velocity(pair.common, point);
  };
  const auto bend = [&](int joint, const Vector3& centre) {
    return joint == pair.common ? 0.0 : bends[joint].at(centre.norm());
  };
  const auto verdict_of = [&](const Sphere& s, const Vector3& p, const Sphere& t, const Vector3& q) {
    const Vector3 apart = p - q;
    const double length = apart.norm();
    const double rate = std::abs(apart.dot(relative(a.joint, p) - relative(b.joint, q))) / std::max(length, 1e-12);
    return judge(length - s.radius - t.radius - margin_,
                 h * rate + 0.5 * h * h * (bend(a.joint, s.centre) + bend(b.joint, t.centre)));
  };
  const Vector3 first = tree_.of(places_, a.joint) * a.bound.centre;
  const Vector3 second = tree_.of(places_, b.joint) * b.bound.centre;
  if (verdict_of(a.bound, first, b.bound, second) == Verdict::free) return Verdict::free;
  bool open = false;
  for (std::size_t s = a.first; s < a.last; ++s)
    for (std::size_t t = b.first; t < b.last; ++t) {
      const Verdict verdict = verdict_of(tree_.spheres[s], centres_[s], tree_.spheres[t], centres_[t]);
      if (verdict == Verdict::blocked) return verdict;
      open = open || verdict == Verdict::open;
    }
  return open ? Verdict::open : Verdict::free;
}

}  // namespace robotraj::native::collision
