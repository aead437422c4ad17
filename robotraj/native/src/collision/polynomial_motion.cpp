#include "polynomial_motion.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace robotraj::native::collision {

namespace {

/// Halvings after which a piece that is not proved counts as short.
constexpr int HALVINGS = 16;
/// Halvings after which the place of the least distance is known well enough.
constexpr int COARSE = 5;

}  // namespace

PolynomialMotion::PolynomialMotion(const SphereTree& tree, double margin)
    : least{-1, -1, -1, false, 0.0, std::numeric_limits<double>::infinity()},
      tree_(tree),
      margin_(margin),
      spheres_(tree),
      q_(tree.joints.size()),
      rate_(tree.joints.size()),
      joint_of_(tree.spheres.size()) {
  rates_ = {q_, q_, q_};
  for (const Group& group : tree.groups)
    std::fill(joint_of_.begin() + group.first, joint_of_.begin() + group.last, group.joint);
}

void PolynomialMotion::prove(int interval, const double* coefficients, int count) {
  interval_ = interval;
  coefficients_ = coefficients;
  count_ = count;
  const std::size_t n = q_.size();
  const auto at = [&](int i, std::size_t joint) { return coefficients[i * n + joint]; };
  for (std::size_t j = 0; j < n; ++j) {
    rates_.position[j] = rates_.rate[j] = rates_.acceleration[j] = 0.0;
    for (int i = 0; i < count; ++i) {
      rates_.position[j] = std::max(rates_.position[j], std::abs(at(i, j)));
      if (i + 1 < count) rates_.rate[j] = std::max(rates_.rate[j], (count - 1) * std::abs(at(i + 1, j) - at(i, j)));
      if (i + 2 < count)
        rates_.acceleration[j] = std::max(
            rates_.acceleration[j], (count - 1) * (count - 2) * std::abs(at(i + 2, j) - 2 * at(i + 1, j) + at(i, j)));
    }
  }
  spheres_.bound(rates_);
  read(0.5);
  piece(0.5, 0.5, 0, near());
}

/// Configuration and rates by de Casteljau's algorithm.
void PolynomialMotion::read(double tau) {
  const std::size_t n = q_.size();
  work_.assign(coefficients_, coefficients_ + count_ * n);
  std::fill(rate_.begin(), rate_.end(), 0.0);
  for (int left = count_ - 1; left > 0; --left) {
    if (left == 1)
      for (std::size_t j = 0; j < n; ++j) rate_[j] = (count_ - 1) * (work_[n + j] - work_[j]);
    for (int i = 0; i < left; ++i)
      for (std::size_t j = 0; j < n; ++j) work_[i * n + j] += tau * (work_[(i + 1) * n + j] - work_[i * n + j]);
  }
  std::copy(work_.begin(), work_.begin() + n, q_.begin());
  spheres_.move(q_.data(), rate_.data());
}

/// Pairs of spheres whose groups are not proved apart on the whole interval, at whose middle the spheres are.
std::vector<PolynomialMotion::Candidate> PolynomialMotion::near() const {
  std::vector<Candidate> found;
  const double h = 0.5;
  for (const Group& group : tree_.groups) {
    if (group.joint < 0) continue;  // it does not move
    const Vector3 middle = spheres_.middle(group), drift = spheres_.velocity(group.joint, middle);
    const double curve = 0.5 * h * h * spheres_.bend(group.joint, group.bound.centre);
    for (std::size_t k = 0; k < tree_.shapes.size(); ++k) {
      const Distance whole = tree_.shapes[k].distance(middle);
      if (whole.value - group.bound.radius - margin_ > h * std::abs(whole.gradient.dot(drift)) + curve) continue;
      for (std::size_t s = group.first; s < group.last; ++s)
        found.push_back({-1, static_cast<int>(s), static_cast<int>(k), -1});
    }
  }
  for (std::size_t p = 0; p < tree_.pairs.size(); ++p) {
    const Pair& pair = tree_.pairs[p];
    const Group &a = tree_.groups[pair.first], &b = tree_.groups[pair.second];
    if (a.joint == b.joint) continue;
    const Vector3 first = spheres_.middle(a), second = spheres_.middle(b), apart = first - second;
    const double length = apart.norm();
    const Vector3 drift = spheres_.velocity(pair, a.joint, first) - spheres_.velocity(pair, b.joint, second);
    const double curve = spheres_.bend(p, a.joint, a.bound.centre) + spheres_.bend(p, b.joint, b.bound.centre);
    if (length - a.bound.radius - b.bound.radius - margin_ >
        h * std::abs(apart.dot(drift)) / std::max(length, 1e-12) + 0.5 * h * h * curve)
      continue;
    for (std::size_t s = a.first; s < a.last; ++s)
      for (std::size_t t = b.first; t < b.last; ++t)
        found.push_back({static_cast<int>(p), static_cast<int>(s), static_cast<int>(t), -1});
  }
  return found;
}

PolynomialMotion::Look PolynomialMotion::look(const Candidate& candidate, double h) const {
  const Sphere& sphere = tree_.spheres[candidate.first];
  const Vector3& centre = spheres_.centre(candidate.first);
  const int joint = joint_of_[candidate.first];
  if (candidate.pair < 0) {
    const Distance own = tree_.shapes[candidate.second].distance(centre);
    return {own.value - sphere.radius, h * std::abs(own.gradient.dot(spheres_.velocity(joint, centre))) +
                                           0.5 * h * h * spheres_.bend(joint, sphere.centre)};
  }
  const Pair& pair = tree_.pairs[candidate.pair];
  const Sphere& other = tree_.spheres[candidate.second];
  const int second = joint_of_[candidate.second];
  const Vector3& there = spheres_.centre(candidate.second);
  const Vector3 apart = centre - there;
  const double length = apart.norm();
  const Vector3 drift = spheres_.velocity(pair, joint, centre) - spheres_.velocity(pair, second, there);
  const double curve =
      spheres_.bend(candidate.pair, joint, sphere.centre) + spheres_.bend(candidate.pair, second, other.centre);
  return {length - sphere.radius - other.radius,
          h * std::abs(apart.dot(drift)) / std::max(length, 1e-12) + 0.5 * h * h * curve};
}

void PolynomialMotion::piece(double tau, double h, int depth, std::vector<Candidate> candidates) {
  std::vector<Candidate> open;
  for (Candidate& candidate : candidates) {
    const Look seen = look(candidate, h);
    if (seen.distance < least.distance)
      least = {interval_, candidate.first, candidate.second, candidate.pair >= 0, tau, seen.distance};
    if (seen.distance - margin_ > seen.change) continue;
    const bool last = depth == HALVINGS;
    if (seen.distance < margin_ || last) note(candidate, tau, seen.distance - (last ? seen.change : 0.0));
    if (!last && (candidate.found < 0 || depth < COARSE)) open.push_back(candidate);
  }
  if (open.empty()) return;
  for (const double side : {-0.5, 0.5}) {
    // Pairs that are short in the first half are not refined in the second.
    for (Candidate& candidate : open)
      for (std::size_t i = 0; i < shorts.size() && candidate.found < 0; ++i)
        if (shorts[i].interval == interval_ && shorts[i].first == candidate.first &&
            shorts[i].second == candidate.second && shorts[i].self == (candidate.pair >= 0))
          candidate.found = static_cast<int>(i);
    read(tau + side * h);
    piece(tau + side * h, 0.5 * h, depth + 1, open);
  }
}

void PolynomialMotion::note(Candidate& candidate, double tau, double distance) {
  if (candidate.found < 0) {
    candidate.found = static_cast<int>(shorts.size());
    shorts.push_back({interval_, candidate.first, candidate.second, candidate.pair >= 0, tau, distance});
  } else if (distance < shorts[candidate.found].distance) {
    shorts[candidate.found].tau = tau;
    shorts[candidate.found].distance = distance;
  }
}

}  // namespace robotraj::native::collision
