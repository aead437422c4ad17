// Obstacles as convex shapes, and the signed distance of a point to their surfaces.
#pragma once

#include <Eigen/Core>

#include <array>
#include <vector>

namespace robotraj::native::collision {

using Matrix3 = Eigen::Matrix3d;
using Vector3 = Eigen::Vector3d;

enum class Kind { sphere, box, cylinder, capsule, half_space, convex };

/// A triangle of a convex surface, in the frame of its shape.
struct Triangle {
  std::array<Vector3, 3> corners;
  Vector3 normal;  ///< of length 1, outward
};

/// A signed distance, negative inside [m], and its gradient, of length 1. Both are those of a convex function.
struct Distance {
  double value;
  Vector3 gradient;
};

/// A shape with a fixed pose in the world.
///
/// Axes of cylinders and capsules lie along z. Sizes [m] are a radius, half of three sides, or a radius and half a
/// length. Those of a half space are its normal and the offset of its surface along it.
struct Shape {
  Kind kind;
  Matrix3 rotation;
  Vector3 position;
  Eigen::Vector4d size;
  std::vector<Triangle> triangles;  ///< of a convex shape alone

  /// Of a point of the world to the surface.
  Distance distance(const Vector3& point) const;
};

}  // namespace robotraj::native::collision
