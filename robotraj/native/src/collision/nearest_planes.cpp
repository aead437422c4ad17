#include "nearest_planes.hpp"

#include <algorithm>
#include <numeric>

namespace robotraj::native::collision {

namespace {

constexpr double TOUCHING = 1e-12;  // least distance of centres whose direction is known [m]

}  // namespace

void NearestPlanes::measure(const Place* places, std::vector<double>& distances) {
  centres_.resize(spheres.size());
  for (std::size_t s = 0; s < spheres.size(); ++s) centres_[s] = places[joints[s]] * spheres[s].centre;
  distances.resize(first.size());
  for (const PairGroup& group : groups)
    for (std::size_t p = group.first; p < group.last; ++p) {
      const auto a = static_cast<std::size_t>(first[p]), b = static_cast<std::size_t>(second[p]);
      const double apart =
          group.self ? (centres_[a] - centres_[b]).norm() - spheres[b].radius : shapes[b].distance(centres_[a]).value;
      distances[p] = apart - spheres[a].radius;
    }
}

void NearestPlanes::planes(const Place* places, const std::vector<double>& distances, std::vector<PairPlane>& found) {
  for (const PairGroup& group : groups) {
    order_.resize(group.last - group.first);
    std::iota(order_.begin(), order_.end(), group.first);
    const auto nearer = [&](std::size_t a, std::size_t b) { return distances[a] < distances[b]; };
    const auto end = order_.begin() + static_cast<std::ptrdiff_t>(group.count);
    std::partial_sort(order_.begin(), end, order_.end(), nearer);
    for (auto pair = order_.begin(); pair != end; ++pair) found.push_back(plane(group, *pair, places));
  }
}

PairPlane NearestPlanes::plane(const PairGroup& group, std::size_t pair, const Place* places) const {
  const auto a = static_cast<std::size_t>(first[pair]), b = static_cast<std::size_t>(second[pair]);
  const auto number = static_cast<std::int64_t>(pair);
  if (!group.self) {
    const Distance distance = shapes[b].distance(centres_[a]);
    return {number, distance.gradient, distance.gradient.dot(centres_[a]) - distance.value + spheres[a].radius};
  }
  const Vector3 apart = centres_[a] - centres_[b];
  const Vector3 normal = apart / std::max(apart.norm(), TOUCHING);
  return {number, group.neutral * (places[group.common].rotation.transpose() * normal),
          spheres[a].radius + spheres[b].radius};
}

}  // namespace robotraj::native::collision
