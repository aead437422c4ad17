#include "shapes.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace robotraj::native::collision {

namespace {

/// A vector of length 1; any one where there is no direction.
Vector3 direction(const Vector3& v, double length) { return length > 0.0 ? Vector3(v / length) : Vector3::UnitX(); }

Distance from_centre(const Vector3& offset, double radius) {
  const double length = offset.norm();
  return {length - radius, direction(offset, length)};
}

/// Distance to a box around the origin.
Distance from_box(const Vector3& p, const Vector3& half) {
  const Vector3 beyond = p.cwiseAbs() - half;
  Eigen::Index face;
  const double depth = beyond.maxCoeff(&face);
  Vector3 outward = beyond.cwiseMax(0.0);
  if (depth <= 0.0) outward = Vector3::Unit(face);
  const double length = outward.norm();
  for (int i = 0; i < 3; ++i) outward[i] = std::copysign(outward[i] / length, p[i]);
  return {depth > 0.0 ? length : depth, outward};
}

/// Distance to a cylinder about z: to a box in the plane of its axis.
Distance from_cylinder(const Vector3& p, double radius, double half) {
  const double across = p.head<2>().norm();
  const Distance flat = from_box({across, 0.0, p.z()}, {radius, 1.0, half});
  const Vector3 away = direction({p.x(), p.y(), 0.0}, across);
  return {flat.value, flat.gradient.x() * away + Vector3(0.0, 0.0, flat.gradient.z())};
}

Vector3 nearest_on_segment(const Vector3& p, const Vector3& a, const Vector3& b) {
  const Vector3 along = b - a;
  const double length = along.squaredNorm();
  return a + (length > 0.0 ? std::clamp((p - a).dot(along) / length, 0.0, 1.0) : 0.0) * along;
}

/// The foot of the perpendicular where it lies in the triangle, else a point of an edge.
Vector3 nearest_on_triangle(const Vector3& p, const Triangle& t) {
  bool inside = true;
  for (int i = 0; i < 3; ++i) {
    const Vector3 &a = t.corners[i], &b = t.corners[(i + 1) % 3];
    inside = inside && t.normal.dot((b - a).cross(p - a)) >= 0.0;
  }
  if (inside) return p - t.normal.dot(p - t.corners[0]) * t.normal;
  Vector3 best = t.corners[0];
  for (int i = 0; i < 3; ++i) {
    const Vector3 next = nearest_on_segment(p, t.corners[i], t.corners[(i + 1) % 3]);
    if ((p - next).squaredNorm() < (p - best).squaredNorm()) best = next;
  }
  return best;
}

Distance from_convex(const Vector3& p, const std::vector<Triangle>& triangles) {
  Distance deepest{-std::numeric_limits<double>::infinity(), Vector3::UnitX()};
  for (const Triangle& t : triangles) {
    const double depth = t.normal.dot(p - t.corners[0]);
    if (depth > deepest.value) deepest = {depth, t.normal};
  }
  if (deepest.value <= 0.0) return deepest;
  Vector3 offset = Vector3::Constant(std::numeric_limits<double>::infinity());
  for (const Triangle& t : triangles) {
    const Vector3 next = p - nearest_on_triangle(p, t);
    if (next.squaredNorm() < offset.squaredNorm()) offset = next;
  }
  return from_centre(offset, 0.0);
}

Distance in_own_axes(const Shape& shape, const Vector3& p) {
  const Eigen::Vector4d& size = shape.size;
  switch (shape.kind) {
    case Kind::box: return from_box(p, size.head<3>());
    case Kind::cylinder: return from_cylinder(p, size[0], size[1]);
    case Kind::capsule: return from_centre(p - Vector3(0.0, 0.0, std::clamp(p.z(), -size[1], size[1])), size[0]);
    case Kind::half_space: return {size.head<3>().dot(p) - size[3], size.head<3>()};
    case Kind::convex: return from_convex(p, shape.triangles);
    default: return from_centre(p, size[0]);
  }
}

}  // namespace

Distance Shape::distance(const Vector3& point) const {
  const Distance own = in_own_axes(*this, rotation.transpose() * (point - position));
  return {own.value, rotation * own.gradient};
}

}  // namespace robotraj::native::collision
