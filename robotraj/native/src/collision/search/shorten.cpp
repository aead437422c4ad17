#include "paths.hpp"

#include "random_numbers.hpp"

#include <algorithm>

namespace robotraj::native::collision {

namespace {

double length(const Path& path, const Point& speeds) {
  double sum = 0.0;
  for (std::size_t k = 1; k < path.size(); ++k) sum += distance(path[k - 1], path[k], speeds);
  return sum;
}

/// A place on a path: between `after` and the next configuration.
struct Cut {
  std::size_t after;
  Point q;
};

Cut cut_at(const Path& path, const Point& speeds, double along) {
  for (std::size_t k = 1; k < path.size(); ++k) {
    const double step = distance(path[k - 1], path[k], speeds);
    if (along > step && k + 1 < path.size()) {
      along -= step;
      continue;
    }
    const double s = step > 0.0 ? std::min(1.0, along / step) : 0.0;
    Cut cut{k - 1, path[k - 1]};
    for (std::size_t i = 0; i < cut.q.size(); ++i) cut.q[i] += s * (path[k][i] - path[k - 1][i]);
    return cut;
  }
  return {0, path.front()};
}

/// The part of a path between two places, with one joint on a straight line over its length.
Path straightened(const Path& part, std::size_t joint, const Point& speeds) {
  Path out = part;
  const double all = length(part, speeds);
  double along = 0.0;
  for (std::size_t k = 1; k + 1 < out.size(); ++k) {
    along += distance(part[k - 1], part[k], speeds);
    out[k][joint] = part.front()[joint] + along / all * (part.back()[joint] - part.front()[joint]);
  }
  return out;
}

bool free(StraightMotions& motions, const Path& path) {
  for (std::size_t k = 1; k < path.size(); ++k)
    if (!motions.free(path[k - 1], path[k])) return false;
  return true;
}

}  // namespace

Path shortened(StraightMotions& motions, Path path, const Point& speeds, std::uint64_t seed, std::size_t rounds) {
  RandomNumbers random(seed);
  for (std::size_t round = 0; round < rounds && path.size() > 2; ++round) {
    const double all = length(path, speeds);
    double from = random.uniform(0.0, all), to = random.uniform(0.0, all);
    if (from > to) std::swap(from, to);
    const Cut first = cut_at(path, speeds, from), last = cut_at(path, speeds, to);
    if (first.after == last.after) continue;
    Path part = {first.q};
    part.insert(part.end(), path.begin() + first.after + 1, path.begin() + last.after + 1);
    part.push_back(last.q);
    const Path shorter =
        round % 2 == 0 ? Path{first.q, last.q} : straightened(part, random.below(speeds.size()), speeds);
    if (length(shorter, speeds) > (1.0 - 1e-6) * length(part, speeds) || !free(motions, shorter)) continue;
    Path whole(path.begin(), path.begin() + first.after + 1);
    whole.insert(whole.end(), shorter.begin(), shorter.end());
    whole.insert(whole.end(), path.begin() + last.after + 1, path.end());
    path = std::move(whole);
  }
  return path;
}

}  // namespace robotraj::native::collision
