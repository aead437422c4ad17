// A robot as spheres on a tree of joints that turn or slide, and how far they are from obstacles and each other.
#pragma once

#include "shapes.hpp"

#include <vector>

namespace robotraj::native::collision {

/// A joint; its frame moves with it.
struct Joint {
  int parent;           ///< -1 for the world
  bool turns;           ///< or slides
  Vector3 axis;         ///< in its own frame
  Matrix3 rotation;     ///< to the parent's frame, at 0
  Vector3 translation;  ///< in the parent's frame [m]
};

struct Sphere {
  Vector3 centre;  ///< in the frame of its joint [m]
  double radius;   ///< [m]
};

/// Spheres of one link, and one that encloses them.
struct Group {
  int joint;  ///< -1 for the world
  std::size_t first, last;
  Sphere bound;
};

/// Two groups that may not touch.
struct Pair {
  int first, second;  ///< groups
  int common;         ///< the last joint that carries both, -1 for the world
};

/// The place of a joint's frame in the world.
struct Place {
  Matrix3 rotation = Matrix3::Identity();
  Vector3 position = Vector3::Zero();

  Vector3 operator*(const Vector3& p) const { return rotation * p + position; }
};

struct SphereTree {
  std::vector<Joint> joints;
  std::vector<Sphere> spheres;
  std::vector<Group> groups;
  std::vector<Pair> pairs;
  std::vector<Shape> shapes;

  /// No joint comes before its parent. `groups_of` has the group of every sphere, ascending.
  SphereTree(std::vector<Joint> joints, const std::vector<int>& joints_of, const std::vector<int>& groups_of,
             std::vector<Sphere> spheres, const std::vector<std::pair<int, int>>& pairs, std::vector<Shape> shapes);

  int count() const { return static_cast<int>(joints.size()); }
  /// Places of all joints, and of the world at the end.
  void forward(const double* q, std::vector<Place>& places) const;
  const Place& of(const std::vector<Place>& places, int joint) const {
    return joint < 0 ? places.back() : places[joint];
  }
  /// Of all spheres, at places of the joints.
  void centres(const std::vector<Place>& places, std::vector<Vector3>& found) const;
  /// The least signed distance of two shapes that a motion can change, infinite where there is none.
  double clearance(const double* q) const;

 private:
  int common_joint(int first, int second) const;
};

}  // namespace robotraj::native::collision
