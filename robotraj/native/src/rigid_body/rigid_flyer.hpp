// A free-flyer at the root: the axes of its own body stand for those of the world.
//
// Only gravity turns in them, with the quaternion; it is part of the acceleration from which all others follow. Its six
// velocities are unit twists e_i; varying one varies dV = e_i, alpha = V x e_i (`rigid_kernel.hpp`).
#pragma once

#include "kernels/packed.hpp"
#include "spatial.hpp"

namespace robotraj::native {
namespace {

/// RigidArguments as packs.
struct Given {
  const Pack *q, *w, *a, *test;
  JointState* states;
  Pack *tau, *jacobian, *hessian;
};

/// R' g of a quaternion (x, y, z, w), R = 1 + 2 w u x + 2 u x u x, and its derivatives.
struct Attitude {
  Vector3 u, g;
  Pack w;

  Vector3 value() const {
    const Vector3 c = cross(u, g);
    return g - (w + w) * c + constant(2.0) * cross(u, c);
  }
  Vector3 derivative(int i) const {
    if (i == 3) return constant(-2.0) * cross(u, g);
    const Vector3 e = unit3(i), c = cross(e, g);
    return constant(2.0) * (cross(e, cross(u, g)) + cross(u, c) - w * c);
  }
  Vector3 derivative(int i, int k) const {
    if (i == 3 && k == 3) return zero();
    if (i == 3 || k == 3) return constant(-2.0) * cross(unit3(i == 3 ? k : i), g);
    const Vector3 a = unit3(i), b = unit3(k);
    return constant(2.0) * (cross(a, cross(b, g)) + cross(b, cross(a, g)));
  }
};

ROBOTRAJ_INLINE Attitude attitude_of(const Tree& tree, const Pack* q) {
  // Minus gravity, in the axes of the free-flyer's own frame.
  double g[3];
  for (int k = 0; k < 3; ++k)
    g[k] = -tree.flyer[k] * tree.gravity[0] - tree.flyer[3 + k] * tree.gravity[1] - tree.flyer[6 + k] * tree.gravity[2];
  return {{q[3], q[4], q[5]}, constant(g), q[6]};
}

/// The free-flyer's own rows and columns of d tau/dx.
void write_flyer_jacobian(const Tree& tree, const Given& in, Pack* out) {
  const JointState& state = in.states[0];
  const Attitude attitude = attitude_of(tree, in.q);
  for (int i = 0; i < 6; ++i) {
    const Vector6 e = unit6(i);
    const Vector6 by_rate = state.by_velocity * e + state.inertia * cross(state.velocity, e);
    const Vector6 by_acceleration = state.inertia * e;
    const Vector3 turned = i < 4 ? attitude.derivative(i) : zero();
    const Vector6 by_attitude = state.inertia * Vector6{turned, zero()};
    for (int row = 0; row < 6; ++row) {
      *out++ = entry(by_rate, row);
      *out++ = entry(by_acceleration, row);
      if (i < 4) *out++ = entry(by_attitude, row);
    }
  }
}

/// The free-flyer's own part of d^2 (l' tau)/dx^2.
void write_flyer_hessian(const Tree& tree, const Given& in, Pack* out) {
  const JointState& state = in.states[0];
  const Vector6 tested = momentum_of(state.by_test);
  for (int i = 0; i < 6; ++i) {
    const Vector6 e = unit6(i);
    const Vector6 varied = Vector6{zero(), zero() - transposed_times(state.by_test, e)} - cross_dual(e, tested);
    for (int k = 0; k <= i; ++k) *out++ = entry(varied, k);
  }
  const Attitude attitude = attitude_of(tree, in.q);
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k <= i; ++k) *out++ = dot(attitude.derivative(i, k), tested.linear);
}

}  // namespace
}  // namespace robotraj::native
