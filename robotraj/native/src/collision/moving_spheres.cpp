#include "moving_spheres.hpp"

#include <Eigen/Geometry>

#include <algorithm>

namespace robotraj::native::collision {

MovingSpheres::MovingSpheres(const SphereTree& tree) : tree_(tree), twists_(tree.joints.size() + 1) {
  for (const Pair& pair : tree.pairs) {
    const auto found = std::find(roots_.begin(), roots_.end(), pair.common);
    root_of_.push_back(found - roots_.begin());
    if (found == roots_.end()) roots_.push_back(pair.common);
  }
  apart_.resize(roots_.size());
}

void MovingSpheres::move(const double* q, const double* rate) {
  tree_.forward(q, places_);
  for (int i = 0; i < tree_.count(); ++i) {
    const Joint& joint = tree_.joints[i];
    const Vector3 axis = rate[i] * (places_[i].rotation * joint.axis);
    twists_[i] = {twist(joint.parent).angular, velocity(joint.parent, places_[i].position)};
    (joint.turns ? twists_[i].angular : twists_[i].linear) += axis;
  }
  tree_.centres(places_, centres_);
}

void MovingSpheres::bound(const Rates& rates) {
  bends_from(-1, rates, bends_);
  for (std::size_t r = 0; r < roots_.size(); ++r) bends_from(roots_[r], rates, apart_[r]);
}

void MovingSpheres::bends_from(int root, const Rates& rates, std::vector<Bend>& bends) const {
  bends.assign(tree_.joints.size(), {});
  for (int i = root + 1; i < tree_.count(); ++i) {
    const Joint& joint = tree_.joints[i];
    const Bend before = joint.parent < 0 || joint.parent == root ? Bend() : bends[joint.parent];
    const double d = rates.rate[i], e = rates.acceleration[i];
    Bend& bend = bends[i];
    bend = {before.angular, before.turning,
            before.at(joint.translation.norm() + (joint.turns ? 0 : rates.position[i]))};
    if (joint.turns) {
      bend.angular += d;
      bend.turning += before.angular * d + e;
    } else {
      bend.linear += 2.0 * before.angular * d + e;
    }
  }
}

Vector3 MovingSpheres::velocity(int joint, const Vector3& point) const {
  const Twist& own = twist(joint);
  return own.linear + own.angular.cross(point - tree_.of(places_, joint).position);
}

Vector3 MovingSpheres::velocity(const Pair& pair, int joint, const Vector3& point) const {
  if (joint == pair.common) return Vector3::Zero();
  return velocity(joint, point) - velocity(pair.common, point);
}

double MovingSpheres::bend(std::size_t pair, int joint, const Vector3& point) const {
  return joint == tree_.pairs[pair].common ? 0.0 : apart_[root_of_[pair]][joint].at(point.norm());
}

}  // namespace robotraj::native::collision
