// Work memory of the inverse dynamics of a pack of points, and spatial vectors of packs.
#pragma once

#include "parallel/lanes.hpp"

namespace robotraj::native {
namespace {

struct Vector3 {
  Pack x, y, z;
};

/// A twist (velocity of the point at the origin, angular velocity) or a wrench (force, moment about the origin).
struct Vector6 {
  Vector3 linear, angular;
};

/// Entries xx, xy, yy, xz, yz, zz.
struct Symmetric3 {
  Pack xx, xy, yy, xz, yz, zz;
};

/// Spatial inertia about the origin: of the mass, only its moment; the mass is the tree's.
struct SpatialInertia {
  Pack mass;
  Vector3 moment;
  Symmetric3 inertia;
};

/// B(I, V) = (V x* I - I V x + (I V) x*) = [0, -2 p x; 0, N - k x] with (p, k) = I V and N symmetric.
struct Rate {
  Vector3 momentum, spin;
  Symmetric3 turning;
};

/// Quantities of one joint and the bodies it carries, in the world's axes about the world's origin.
struct JointState {
  Pack rotation[9];
  Vector3 origin;
  Vector6 axis, axis_rate, axis_acceleration, axis_tested;  ///< S, V_p x S, A_p x S + V_p x (V_p x S), L_p x S
  Vector6 velocity, acceleration, test;                     ///< V, A, L
  SpatialInertia inertia;
  Rate by_velocity, by_test;  ///< B(I, V) and B(I, L)
  Vector6 force;              ///< sum of I A + V x* I V
  Vector3 product;            ///< moment of the sum of B(I, V)' L; its force is zero
};

}  // namespace
}  // namespace robotraj::native
