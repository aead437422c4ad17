// Spatial algebra on packs (Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 2), linear part first, and the
// work memory of the inverse dynamics.
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

ROBOTRAJ_INLINE Vector3 column(const Pack* m, int i) { return {m[i], m[3 + i], m[6 + i]}; }
ROBOTRAJ_INLINE Pack constant(double value) { return Pack{} + value; }
ROBOTRAJ_INLINE Vector3 zero() { return {constant(0.0), constant(0.0), constant(0.0)}; }
ROBOTRAJ_INLINE Vector3 constant(const double* a) { return {constant(a[0]), constant(a[1]), constant(a[2])}; }
ROBOTRAJ_INLINE Vector6 vector(const Pack* a) { return {{a[0], a[1], a[2]}, {a[3], a[4], a[5]}}; }
ROBOTRAJ_INLINE Pack entry(const Vector3& a, int i) { return i == 0 ? a.x : i == 1 ? a.y : a.z; }
ROBOTRAJ_INLINE Pack entry(const Vector6& a, int i) { return i < 3 ? entry(a.linear, i) : entry(a.angular, i - 3); }
ROBOTRAJ_INLINE Vector3 unit3(int i) { return {constant(i == 0), constant(i == 1), constant(i == 2)}; }
ROBOTRAJ_INLINE Vector6 unit6(int i) { return {unit3(i), unit3(i - 3)}; }

ROBOTRAJ_INLINE Vector3 operator+(const Vector3& a, const Vector3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
ROBOTRAJ_INLINE Vector3 operator-(const Vector3& a, const Vector3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
ROBOTRAJ_INLINE Vector3 operator*(const Pack& s, const Vector3& a) { return {s * a.x, s * a.y, s * a.z}; }
/// M a of a matrix of packs, row after row.
ROBOTRAJ_INLINE Vector3 times(const Pack* m, const double* a) {
  return constant(a[0]) * column(m, 0) + constant(a[1]) * column(m, 1) + constant(a[2]) * column(m, 2);
}
ROBOTRAJ_INLINE Pack dot(const Vector3& a, const Vector3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
ROBOTRAJ_INLINE Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

ROBOTRAJ_INLINE Vector6 operator+(const Vector6& a, const Vector6& b) {
  return {a.linear + b.linear, a.angular + b.angular};
}
ROBOTRAJ_INLINE Vector6 operator-(const Vector6& a, const Vector6& b) {
  return {a.linear - b.linear, a.angular - b.angular};
}
ROBOTRAJ_INLINE Vector6 operator*(const Pack& s, const Vector6& a) { return {s * a.linear, s * a.angular}; }
ROBOTRAJ_INLINE Vector6 twice(const Vector6& a) { return a + a; }
ROBOTRAJ_INLINE Pack dot(const Vector6& a, const Vector6& b) {
  return dot(a.linear, b.linear) + dot(a.angular, b.angular);
}
/// a x b of two twists.
ROBOTRAJ_INLINE Vector6 cross(const Vector6& a, const Vector6& b) {
  return {cross(a.angular, b.linear) + cross(a.linear, b.angular), cross(a.angular, b.angular)};
}
/// a x* f of a twist and a wrench.
ROBOTRAJ_INLINE Vector6 cross_dual(const Vector6& a, const Vector6& f) {
  return {cross(a.angular, f.linear), cross(a.angular, f.angular) + cross(a.linear, f.linear)};
}

ROBOTRAJ_INLINE Symmetric3 operator+(const Symmetric3& a, const Symmetric3& b) {
  return {a.xx + b.xx, a.xy + b.xy, a.yy + b.yy, a.xz + b.xz, a.yz + b.yz, a.zz + b.zz};
}
ROBOTRAJ_INLINE Vector3 operator*(const Symmetric3& m, const Vector3& a) {
  return {m.xx * a.x + m.xy * a.y + m.xz * a.z, m.xy * a.x + m.yy * a.y + m.yz * a.z,
          m.xz * a.x + m.yz * a.y + m.zz * a.z};
}

/// I a of a twist or an acceleration.
ROBOTRAJ_INLINE Vector6 operator*(const SpatialInertia& i, const Vector6& a) {
  return {i.mass * a.linear + cross(a.angular, i.moment), cross(i.moment, a.linear) + i.inertia * a.angular};
}
ROBOTRAJ_INLINE SpatialInertia operator+(const SpatialInertia& a, const SpatialInertia& b) {
  return {a.mass + b.mass, a.moment + b.moment, a.inertia + b.inertia};
}

/// B(I, V); N = w x J - J w x - m (v x c x + c x v x).
ROBOTRAJ_INLINE Rate rate_of(const SpatialInertia& i, const Vector6& v) {
  const Vector6 momentum = i * v;
  const Vector3 &w = v.angular, &u = v.linear, &h = i.moment;
  const Symmetric3& j = i.inertia;
  const Pack along = 2.0 * dot(u, h);
  // w x J + (w x J)' - h v' - v h' + 2 (v' h) 1
  const Symmetric3 turning = {
      2.0 * (w.y * j.xz - w.z * j.xy) - 2.0 * h.x * u.x + along,
      (w.y * j.yz - w.z * j.yy) + (w.z * j.xx - w.x * j.xz) - h.x * u.y - h.y * u.x,
      2.0 * (w.z * j.xy - w.x * j.yz) - 2.0 * h.y * u.y + along,
      (w.y * j.zz - w.z * j.yz) + (w.x * j.xy - w.y * j.xx) - h.x * u.z - h.z * u.x,
      (w.z * j.xz - w.x * j.zz) + (w.x * j.yy - w.y * j.xy) - h.y * u.z - h.z * u.y,
      2.0 * (w.x * j.yz - w.y * j.xz) - 2.0 * h.z * u.z + along,
  };
  return {momentum.linear, momentum.angular, turning};
}
ROBOTRAJ_INLINE Rate operator+(const Rate& a, const Rate& b) {
  return {a.momentum + b.momentum, a.spin + b.spin, a.turning + b.turning};
}
/// B a.
ROBOTRAJ_INLINE Vector6 operator*(const Rate& b, const Vector6& a) {
  return {(Pack{} - 2.0) * cross(b.momentum, a.angular), b.turning * a.angular - cross(b.spin, a.angular)};
}
/// Moment of B' a, whose force is zero.
ROBOTRAJ_INLINE Vector3 transposed_times(const Rate& b, const Vector6& a) {
  return (Pack{} + 2.0) * cross(b.momentum, a.linear) + b.turning * a.angular + cross(b.spin, a.angular);
}
ROBOTRAJ_INLINE Vector6 momentum_of(const Rate& b) { return {b.momentum, b.spin}; }

}  // namespace
}  // namespace robotraj::native
