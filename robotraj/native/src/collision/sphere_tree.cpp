#include "sphere_tree.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace robotraj::native::collision {

namespace {

/// A sphere around the middle of a box that contains the spheres.
Sphere enclosing(const Sphere* first, const Sphere* last) {
  Vector3 low = first->centre, high = first->centre;
  for (const Sphere* s = first; s != last; ++s) {
    low = low.cwiseMin(s->centre - Vector3::Constant(s->radius));
    high = high.cwiseMax(s->centre + Vector3::Constant(s->radius));
  }
  Sphere bound{0.5 * (low + high), 0.0};
  for (const Sphere* s = first; s != last; ++s)
    bound.radius = std::max(bound.radius, (s->centre - bound.centre).norm() + s->radius);
  return bound;
}

}  // namespace

SphereTree::SphereTree(std::vector<Joint> own_joints, const std::vector<int>& joints_of,
                       const std::vector<int>& groups_of, std::vector<Sphere> own_spheres,
                       const std::vector<std::pair<int, int>>& own_pairs, std::vector<Shape> own_shapes)
    : joints(std::move(own_joints)), spheres(std::move(own_spheres)), shapes(std::move(own_shapes)) {
  for (int i = 0; i < count(); ++i)
    if (joints[i].parent < -1 || joints[i].parent >= i) throw std::invalid_argument("a joint comes before its parent");
  if (groups_of.size() != spheres.size()) throw std::invalid_argument("every sphere needs its group");
  std::size_t at = 0;
  for (std::size_t g = 0; g < joints_of.size(); ++g) {
    const std::size_t first = at;
    while (at < spheres.size() && groups_of[at] == static_cast<int>(g)) ++at;
    if (at == first) throw std::invalid_argument("groups of spheres must ascend, and none be empty");
    if (joints_of[g] < -1 || joints_of[g] >= count()) throw std::invalid_argument("a group is on an unknown joint");
    groups.push_back({joints_of[g], first, at, enclosing(spheres.data() + first, spheres.data() + at)});
  }
  if (at != spheres.size()) throw std::invalid_argument("a sphere belongs to an unknown group");
  for (const auto& [a, b] : own_pairs) {
    const int known = static_cast<int>(groups.size());
    if (a < 0 || b < 0 || a >= known || b >= known) throw std::invalid_argument("a pair has an unknown group");
    pairs.push_back({a, b, common_joint(groups[a].joint, groups[b].joint)});
  }
}

int SphereTree::common_joint(int first, int second) const {
  while (first != second) (first > second ? first : second) = joints[std::max(first, second)].parent;
  return first;
}

void SphereTree::forward(const double* q, std::vector<Place>& places) const {
  places.resize(joints.size() + 1);
  places.back() = Place();
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Joint& joint = joints[i];
    const Place& parent = of(places, joint.parent);
    places[i].rotation.noalias() = parent.rotation * joint.rotation;
    places[i].position = parent * joint.translation;
    if (joint.turns) places[i].rotation *= Eigen::AngleAxisd(q[i], joint.axis).toRotationMatrix();
    else places[i].position += q[i] * (places[i].rotation * joint.axis);
  }
}

void SphereTree::centres(const std::vector<Place>& places, std::vector<Vector3>& found) const {
  found.clear();
  for (const Group& group : groups)
    for (std::size_t s = group.first; s < group.last; ++s) found.push_back(of(places, group.joint) * spheres[s].centre);
}

double SphereTree::clearance(const double* q) const {
  static thread_local std::vector<Place> places;
  static thread_local std::vector<Vector3> own;
  forward(q, places);
  centres(places, own);
  double least = std::numeric_limits<double>::infinity();
  for (const Group& group : groups) {
    if (group.joint < 0) continue;  // it moves no more than the shapes
    const Vector3 middle = of(places, group.joint) * group.bound.centre;
    for (const Shape& shape : shapes) {
      if (shape.distance(middle).value - group.bound.radius >= least) continue;
      for (std::size_t s = group.first; s < group.last; ++s)
        least = std::min(least, shape.distance(own[s]).value - spheres[s].radius);
    }
  }
  for (const Pair& pair : pairs) {
    const Group &a = groups[pair.first], &b = groups[pair.second];
    if (a.joint == b.joint) continue;
    const Vector3 between = of(places, a.joint) * a.bound.centre - of(places, b.joint) * b.bound.centre;
    if (between.norm() - a.bound.radius - b.bound.radius >= least) continue;
    for (std::size_t s = a.first; s < a.last; ++s)
      for (std::size_t t = b.first; t < b.last; ++t)
        least = std::min(least, (own[s] - own[t]).norm() - spheres[s].radius - spheres[t].radius);
  }
  return least;
}

}  // namespace robotraj::native::collision
