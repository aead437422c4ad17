// Steps on the circle and in the plane, smooth at rest.
//
// Pinocchio's own, on casadi::SX, are not (4.1.0): where round-off lifts cos^2 + sin^2 above 1, the difference of
// two angles is the constant 0 and so is its derivative; a step in the plane is linear for angles under 1e-14,
// which loses its second derivatives at rest, and cancels for angles a little larger.
#pragma once

#include "graph.hpp"

namespace robotraj {

/// Below this angle [rad] a series is used; its first neglected term is under 1e-16 there.
constexpr double small_angle = 1e-2;

/// The angle in [-pi, pi] from the direction (c0, s0) to (c1, s1).
inline SX angle_between(const SX& c0, const SX& s0, const SX& c1, const SX& s1) {
  return SX::atan2(c0 * s1 - s0 * c1, c0 * c1 + s0 * s1);
}

/// q = (x, y, cos, sin) moved by dv = (vx, vy, w), a constant velocity of the body in its own axes for unit time.
inline Eigen::Matrix<SX, 4, 1> planar_integrate(const Vector& q, const Vector& dv) {
  const SX &x = q[0], &y = q[1], &c = q[2], &s = q[3], &w = dv[2];
  const SX small = fabs(w) < small_angle;
  const SX divisor = SX::if_else(small, 1, w);
  const SX w2 = w * w;
  const SX half = SX::sin(w / 2);
  // sin(w) / w and (1 - cos(w)) / w
  const SX along = SX::if_else(small, 1 - w2 / 6 * (1 - w2 / 20 * (1 - w2 / 42)), SX::sin(w) / divisor);
  const SX across = SX::if_else(small, w / 2 * (1 - w2 / 12 * (1 - w2 / 30)), 2 * half * half / divisor);
  const SX dx = along * dv[0] - across * dv[1], dy = across * dv[0] + along * dv[1];
  Eigen::Matrix<SX, 4, 1> q1;
  q1 << x + c * dx - s * dy, y + s * dx + c * dy, c * SX::cos(w) - s * SX::sin(w), s * SX::cos(w) + c * SX::sin(w);
  return q1;
}

/// The dv that takes q0 to q1, its angle in [-pi, pi].
inline Eigen::Matrix<SX, 3, 1> planar_difference(const Vector& q0, const Vector& q1) {
  const SX &c = q0[2], &s = q0[3];
  const SX w = angle_between(c, s, q1[2], q1[3]);
  const SX small = fabs(w) < small_angle;
  const SX w2 = w * w;
  // (w / 2) / tan(w / 2)
  const SX along = SX::if_else(small, 1 - w2 / 12 * (1 + w2 / 60 * (1 + w2 / 42)),
                               w / 2 * SX::cos(w / 2) / SX::if_else(small, 1, SX::sin(w / 2)));
  const SX x = q1[0] - q0[0], y = q1[1] - q0[1];
  const SX dx = c * x + s * y, dy = c * y - s * x;
  Eigen::Matrix<SX, 3, 1> dv;
  dv << along * dx + w / 2 * dy, along * dy - w / 2 * dx, w;
  return dv;
}

}  // namespace robotraj
