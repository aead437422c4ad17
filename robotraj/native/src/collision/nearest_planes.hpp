// Planes between the nearest shapes of groups of pairs, for robots whose joints are placed elsewhere.
#pragma once

#include "sphere_tree.hpp"

#include <cstdint>
#include <vector>

namespace robotraj::native::collision {

/// Pairs of one function of the positions, of which the nearest `count` are sought.
struct PairGroup {
  std::size_t first, last;  ///< among the pairs
  std::size_t count;
  bool self;           ///< whether the second shapes are spheres, not obstacles
  std::size_t common;  ///< joint that carries both shapes, 0 for the world; its motion changes no distance
  Matrix3 neutral;     ///< rotation of that joint at which normals are returned
};

/// A plane n' p = offset [m] of a pair.
struct PairPlane {
  std::int64_t pair;
  Vector3 normal;
  double offset;
};

struct NearestPlanes {
  std::vector<std::size_t> joints;  ///< of every sphere, 0 for the world
  std::vector<Sphere> spheres;
  std::vector<Shape> shapes;
  std::vector<std::int64_t> first, second;  ///< shapes of every pair, group after group
  std::vector<PairGroup> groups;

  /// Signed distances of all pairs [m] at places of the joints, the world first, with obstacles where they are posed.
  void measure(const Place* places, std::vector<double>& distances);
  /// Appends the planes of the nearest pairs of every group, after `measure`.
  void planes(const Place* places, const std::vector<double>& distances, std::vector<PairPlane>& found);

 private:
  PairPlane plane(const PairGroup& group, std::size_t pair, const Place* places) const;

  std::vector<Vector3> centres_;
  std::vector<std::size_t> order_;
};

}  // namespace robotraj::native::collision
