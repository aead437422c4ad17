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

void PolynomialMotion::begin(const double* coefficients, int count) {
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
}

void PolynomialMotion::prove(int interval, const double* coefficients, int count) {
  interval_ = interval;
  begin(coefficients, count);
  piece(0.5, 0.5, 0, near());
}

bool PolynomialMotion::free(const double* a, const double* b, double resolution) {
  ends_.assign(a, a + q_.size());
  ends_.insert(ends_.end(), b, b + q_.size());
  begin(ends_.data(), 2);
  // Level after level, so that a blocked motion is found early.
  std::vector<Piece> level, next;
  level.push_back({0.5, near()});
  double h = 0.5;
  for (int depth = 0; !level.empty(); ++depth, h *= 0.5) {
    next.clear();
    for (const Piece& piece : level) {
      read(piece.tau);
      std::vector<Candidate> open;
      for (const Candidate& candidate : piece.candidates) {
        const Look seen = look(candidate, h);
        if (proved(seen)) continue;
        if (seen.distance < margin_ || seen.change < resolution || depth == HALVINGS) return false;
        open.push_back(candidate);
      }
      if (open.empty()) continue;
      next.push_back({piece.tau - 0.5 * h, open});
      next.push_back({piece.tau + 0.5 * h, std::move(open)});
    }
    level.swap(next);
  }
  return true;
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
  for (const Group& group : tree_.groups) {
    if (group.joint < 0) continue;  // it does not move
    const Vector3 middle = spheres_.middle(group);
    for (std::size_t k = 0; k < tree_.shapes.size(); ++k) {
      if (proved(against(group.joint, group.bound, middle, tree_.shapes[k], 0.5))) continue;
      for (std::size_t s = group.first; s < group.last; ++s)
        found.push_back({-1, static_cast<int>(s), static_cast<int>(k), -1});
    }
  }
  for (std::size_t p = 0; p < tree_.pairs.size(); ++p) {
    const Group &a = tree_.groups[tree_.pairs[p].first], &b = tree_.groups[tree_.pairs[p].second];
    if (a.joint == b.joint || proved(between(p, a.bound, spheres_.middle(a), b.bound, spheres_.middle(b), 0.5)))
      continue;
    for (std::size_t s = a.first; s < a.last; ++s)
      for (std::size_t t = b.first; t < b.last; ++t)
        found.push_back({static_cast<int>(p), static_cast<int>(s), static_cast<int>(t), -1});
  }
  return found;
}

/// Of a sphere that moves with a joint, and a shape.
PolynomialMotion::Look PolynomialMotion::against(int joint, const Sphere& sphere, const Vector3& centre,
                                                 const Shape& shape, double h) const {
  const Distance own = shape.distance(centre);
  return {own.value - sphere.radius, h * std::abs(own.gradient.dot(spheres_.velocity(joint, centre))) +
                                         0.5 * h * h * spheres_.bend(joint, sphere.centre)};
}

/// Of spheres of the two groups of a pair, with centres p and q.
PolynomialMotion::Look PolynomialMotion::between(std::size_t number, const Sphere& a, const Vector3& p, const Sphere& b,
                                                 const Vector3& q, double h) const {
  const Pair& pair = tree_.pairs[number];
  const int first = tree_.groups[pair.first].joint, second = tree_.groups[pair.second].joint;
  const Vector3 apart = p - q;
  const double length = apart.norm();
  const Vector3 drift = spheres_.velocity(pair, first, p) - spheres_.velocity(pair, second, q);
  const double curve = spheres_.bend(number, first, a.centre) + spheres_.bend(number, second, b.centre);
  return {length - a.radius - b.radius, h * std::abs(apart.dot(drift)) / std::max(length, 1e-12) + 0.5 * h * h * curve};
}

PolynomialMotion::Look PolynomialMotion::look(const Candidate& candidate, double h) const {
  const int first = candidate.first, second = candidate.second;
  const Sphere& sphere = tree_.spheres[first];
  if (candidate.pair < 0) return against(joint_of_[first], sphere, spheres_.centre(first), tree_.shapes[second], h);
  return between(candidate.pair, sphere, spheres_.centre(first), tree_.spheres[second], spheres_.centre(second), h);
}

void PolynomialMotion::piece(double tau, double h, int depth, std::vector<Candidate> candidates) {
  std::vector<Candidate> open;
  for (Candidate& candidate : candidates) {
    const Look seen = look(candidate, h);
    if (seen.distance < least.distance)
      least = {interval_, candidate.first, candidate.second, candidate.pair >= 0, tau, seen.distance};
    if (proved(seen)) continue;
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
