// Placements, velocities and accelerations of all joints.
#pragma once

#include "graph.hpp"

namespace robotraj {

struct Kinematics {
  std::vector<JointMotion> joints;
  std::vector<Placement> placements;  ///< in the world
  std::vector<Motion> velocities;     ///< in the joints' own axes
  std::vector<Motion> accelerations;  ///< spatial, in the joints' own axes, gravity not counted
};

Kinematics move(const Tree& tree, const Vector& q, const Vector& v, const Vector& a);

}  // namespace robotraj
