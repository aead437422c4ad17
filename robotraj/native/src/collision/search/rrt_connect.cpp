#include "paths.hpp"

#include "random_numbers.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace robotraj::native::collision {

namespace {

class Tree {
 public:
  Tree(const Point& root, const Point& speeds) : speeds_(speeds) { add(root, 0); }
  std::size_t add(const Point& q, std::size_t parent) {
    for (std::size_t i = 0; i < q.size(); ++i) numbers_.push_back(q[i] / speeds_[i]);
    points_.push_back(q);
    parents_.push_back(parent);
    return points_.size() - 1;
  }
  std::size_t nearest(const Point& q) const {
    const std::size_t n = q.size();
    Point scaled(n);
    for (std::size_t i = 0; i < n; ++i) scaled[i] = q[i] / speeds_[i];
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < points_.size(); ++k) {
      double sum = 0.0;
      for (std::size_t i = 0; i < n; ++i) {
        const double gap = numbers_[k * n + i] - scaled[i];
        sum += gap * gap;
      }
      if (sum < least) least = sum, best = k;
    }
    return best;
  }
  const Point& operator[](std::size_t i) const { return points_[i]; }
  std::size_t size() const { return points_.size(); }
  /// From the root to a point.
  Path branch(std::size_t at) const {
    Path path = {points_[at]};
    for (; at != 0; path.push_back(points_[at])) at = parents_[at];
    std::reverse(path.begin(), path.end());
    return path;
  }

 private:
  const Point& speeds_;
  std::vector<Point> points_;
  std::vector<std::size_t> parents_;
  Point numbers_;  ///< points divided by the speeds
};

/// A point at most `range` from the first towards the second.
Point towards(const Point& from, const Point& to, const Point& speeds, double range) {
  const double length = distance(from, to, speeds);
  if (length <= range) return to;
  Point q(from.size());
  for (std::size_t i = 0; i < q.size(); ++i) q[i] = from[i] + range / length * (to[i] - from[i]);
  return q;
}

}  // namespace

double distance(const Point& a, const Point& b, const Point& speeds) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow((a[i] - b[i]) / speeds[i], 2);
  return std::sqrt(sum);
}

Path rrt_connect(StraightMotions& motions, const Search& search, const Point& start, const Point& goal) {
  if (motions.free(start, goal)) return {start, goal};
  using Clock = std::chrono::steady_clock;
  const auto late = [&, began = Clock::now()] {
    return !(std::chrono::duration<double>(Clock::now() - began).count() <= search.seconds);
  };
  RandomNumbers random(search.seed);
  Tree trees[] = {Tree(start, search.speeds), Tree(goal, search.speeds)};
  Point drawn(start.size());
  for (std::size_t k = 0; k < search.iterations && !late(); ++k) {
    // The smaller tree grows towards the drawn point, the other towards the new node.
    const std::size_t small = trees[0].size() <= trees[1].size() ? 0 : 1;
    Tree &growing = trees[small], &other = trees[1 - small];
    for (std::size_t i = 0; i < drawn.size(); ++i) drawn[i] = random.uniform(search.lower[i], search.upper[i]);
    const std::size_t near = growing.nearest(drawn);
    const Point reached = towards(growing[near], drawn, search.speeds, search.range);
    if (!motions.free(growing[near], reached)) continue;
    const std::size_t added = growing.add(reached, near);
    std::size_t at = other.nearest(reached);
    bool met = false;
    while (!met && !late()) {
      const Point next = towards(other[at], reached, search.speeds, search.range);
      const bool stuck = next == other[at] && next != reached;  // the range is lost in rounding
      if (stuck || !motions.free(other[at], next)) break;
      met = next == reached;
      at = met ? at : other.add(next, at);
    }
    if (!met) continue;
    Path path = trees[0].branch(small == 0 ? added : at), back = trees[1].branch(small == 0 ? at : added);
    path.insert(path.end(), back.rbegin(), back.rend());
    return path;
  }
  return {};
}

}  // namespace robotraj::native::collision
