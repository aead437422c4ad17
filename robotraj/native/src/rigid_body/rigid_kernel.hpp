// Inverse dynamics of a pack of points, its Jacobian, and the Hessian of a combination l' tau, without any tensor.
//
// With test velocities L_i = sum_{k <= i} S_k l_k, the combination is
//
//     s = l' tau = sum_i L_i' (I_i A_i + V_i x* I_i V_i),
//
// a sum over bodies in which each variable of joint k moves all bodies it carries alike:
//
//              dL          dV      dA_i = alpha + dV x V_i
//     q_k    L_p x S_k   V_p x S_k   alpha = A_p x S_k + V_p x (V_p x S_k)
//     w_k       0           S_k      alpha = 2 V_p x S_k
//     a_k       0           0        alpha = S_k
//     l_k      S_k          0           0
//
// with p the parent of k: a rotation of joint k equals the opposite rotation of L, V and A of its parent. So for k = j
// or an ancestor of it, with sums over the bodies that j carries, F of forces, G of I L, P of B(I, V)' L, derivatives
// are scalar products:
//
//     ds/dq_j = (L_p x S_j)' F + (V_p x S_j)' P + S''_j' G,   ds/dw_j = S_j' P + 2 (V_p x S_j)' G,   ds/da_j = S_j' G
//     d(ds/dq_j) = dL' for_test + dV' for_velocity + alpha' for_acceleration,   and so on.
//
// Sources: Featherstone, Rigid Body Dynamics Algorithms (2008); Singh, Russell, Wensing, Efficient analytical
// derivatives of rigid-body dynamics using spatial vector algebra (2022), and On second-order derivatives of rigid-body
// dynamics: theory and implementation (2024), whose tensors are contracted here before they are formed.
#pragma once

#include "parallel/sines.hpp"
#include "rigid_flyer.hpp"
#include "spatial.hpp"

namespace robotraj::native {
namespace {

/// The inertia of a joint's own bodies about the world's origin.
ROBOTRAJ_INLINE SpatialInertia inertia_of(const Joint& joint, const JointState& state) {
  const Pack* r = state.rotation;
  const double* own = joint.inertia;
  // R I R', upper triangle
  const double full[3][3] = {{own[0], own[1], own[3]}, {own[1], own[2], own[4]}, {own[3], own[4], own[5]}};
  const Vector3 x = times(r, full[0]), y = times(r, full[1]), z = times(r, full[2]);
  const auto element = [&](int i, int k) {
    return entry(x, i) * r[3 * k] + entry(y, i) * r[3 * k + 1] + entry(z, i) * r[3 * k + 2];
  };
  Symmetric3 about = {element(0, 0), element(0, 1), element(1, 1), element(0, 2), element(1, 2), element(2, 2)};
  const double mass = joint.mass;
  const Vector3 moment = times(r, joint.lever) + constant(mass) * state.origin;
  if (mass > 0.0) {
    // - m c x c x
    const Vector3 c = constant(1.0 / mass) * moment;
    const Pack xx = c.x * moment.x, yy = c.y * moment.y, zz = c.z * moment.z;
    about = about + Symmetric3{yy + zz, -c.x * moment.y, xx + zz, -c.x * moment.z, -c.y * moment.z, xx + yy};
  }
  return {constant(mass), moment, about};
}

/// Place of a joint in the world, and its axis.
ROBOTRAJ_INLINE void place(const Joint& joint, const JointState* above, const Pack& q, JointState& state) {
  Pack* r = state.rotation;
  if (above) {
    const Pack* from = above->rotation;
    for (int row = 0; row < 3; ++row)
      for (int k = 0; k < 3; ++k)
        r[3 * row + k] = from[3 * row] * joint.rotation[k] + from[3 * row + 1] * joint.rotation[3 + k] +
                         from[3 * row + 2] * joint.rotation[6 + k];
    state.origin = above->origin + times(from, joint.translation);
  } else {
    for (int k = 0; k < 9; ++k) r[k] = constant(joint.rotation[k]);
    state.origin = constant(joint.translation);
  }
  const Vector3 z = column(r, 2);
  if (joint.turns) {
    Pack s, c;
    sines(q, s, c);
    for (int row = 0; row < 3; ++row) {
      const Pack x = r[3 * row], y = r[3 * row + 1];
      r[3 * row] = c * x + s * y;
      r[3 * row + 1] = c * y - s * x;
    }
    state.axis = {cross(state.origin, z), z};
  } else {
    state.origin = state.origin + q * z;
    state.axis = Vector6{z, zero()};
  }
}

/// Terms of a joint's own bodies in the sums.
ROBOTRAJ_INLINE void begin_sums(const Joint& joint, JointState& state, bool derivatives, bool tested) {
  state.inertia = inertia_of(joint, state);
  const Vector6 momentum = state.inertia * state.velocity;
  state.force = state.inertia * state.acceleration + cross_dual(state.velocity, momentum);
  if (!derivatives) return;
  state.by_velocity = rate_of(state.inertia, state.velocity);
  if (!tested) return;
  state.by_test = rate_of(state.inertia, state.test);
  state.product = transposed_times(state.by_velocity, state.test);
}

void forward(const Tree& tree, const Given& in, bool derivatives, bool tested) {
  const std::size_t count = tree.count;
  const double up[] = {-tree.gravity[0], -tree.gravity[1], -tree.gravity[2]};
  std::size_t j = 0;
  if (tree.flies) {
    JointState& state = in.states[0];
    for (int k = 0; k < 9; ++k) state.rotation[k] = constant(k % 4 == 0);
    state.origin = zero();
    state.velocity = vector(in.w);
    state.acceleration = vector(in.a);
    state.acceleration.linear = state.acceleration.linear + attitude_of(tree, in.q).value();
    if (tested) state.test = vector(in.test);
    begin_sums(tree.joints[0], state, derivatives, tested);
    j = 1;
  }
  for (; j < count; ++j) {
    const Joint& joint = tree.joints[j];
    JointState& state = in.states[j];
    const JointState* above = joint.parent < 0 ? nullptr : in.states + joint.parent;
    const std::size_t rate = tree.rate(j);
    place(joint, above, in.q[tree.position(j)], state);
    const Vector6& s = state.axis;
    const Vector6 velocity = above ? above->velocity : Vector6{zero(), zero()};
    const Vector6 acceleration = above ? above->acceleration : Vector6{constant(up), zero()};
    state.axis_rate = cross(velocity, s);
    state.velocity = velocity + in.w[rate] * s;
    state.acceleration = acceleration + in.a[rate] * s + in.w[rate] * state.axis_rate;
    if (derivatives) state.axis_acceleration = cross(acceleration, s) + cross(velocity, state.axis_rate);
    if (tested) {
      const Vector6 test = above ? above->test : Vector6{zero(), zero()};
      state.axis_tested = cross(test, s);
      state.test = test + in.test[rate] * s;
    }
    begin_sums(joint, state, derivatives, tested);
  }
}

/// Adds the sums of a joint's bodies to those of its parent.
ROBOTRAJ_INLINE void carry(const JointState& from, JointState& to, bool derivatives, bool tested) {
  to.force = to.force + from.force;
  if (!derivatives) return;
  to.inertia = to.inertia + from.inertia;
  to.by_velocity = to.by_velocity + from.by_velocity;
  if (!tested) return;
  to.by_test = to.by_test + from.by_test;
  to.product = to.product + from.product;
}

/// Factors of the variations of the joints above one joint j.
struct Factors {
  Vector6 for_test, rate_for_test, momentum;  ///< of ds/dq_j, ds/dw_j, ds/da_j by dL
  Vector3 balance;                            ///< moment of B' S_j
};

ROBOTRAJ_INLINE Factors factors_of(const JointState& state) {
  const Vector6 &s = state.axis, &rate = state.axis_rate;
  return {
      cross_dual(s, state.force) + state.by_velocity * rate + state.inertia * state.axis_acceleration,
      state.by_velocity * s + twice(state.inertia * rate),
      state.inertia * s,
      transposed_times(state.by_velocity, s),
  };
}

/// d tau/dx for one joint j and all above it, in the order of `jacobian_pattern`.
Pack* write_jacobian(const Tree& tree, const Given& in, std::size_t j, const Factors& f, Pack* out) {
  const auto own = static_cast<std::int32_t>(j), first = static_cast<std::int32_t>(tree.first());
  for (std::int32_t k = own; k >= first; k = tree.joints[k].parent) {
    const JointState& above = in.states[k];
    const Pack inertia = dot(above.axis, f.momentum);
    *out++ = dot(above.axis, f.for_test);
    *out++ = dot(above.axis, f.rate_for_test);
    if (k == own) {
      *out++ = inertia + tree.joints[j].armature;
      continue;
    }
    *out++ = inertia;
    *out++ = dot(f.momentum, above.axis_acceleration) + dot(f.balance, above.axis_rate.angular);
    *out++ = 2.0 * dot(f.momentum, above.axis_rate) + dot(f.balance, above.axis.angular);
    *out++ = inertia;
  }
  if (!tree.flies) return out;
  const Vector6 by_flyer = Vector6{zero(), f.balance} - cross_dual(in.states[0].velocity, f.momentum);
  for (int i = 0; i < 6; ++i) {
    *out++ = entry(f.for_test, i);
    *out++ = entry(f.rate_for_test, i);
    *out++ = entry(f.momentum, i);
    *out++ = entry(by_flyer, i);
    *out++ = entry(f.momentum, i);
  }
  const Attitude attitude = attitude_of(tree, in.q);
  for (int i = 0; i < 4; ++i) *out++ = dot(attitude.derivative(i), f.momentum.linear);
  return out;
}

/// d^2 (l' tau)/dx^2 for one joint j and all above it, in the order of `hessian_pattern`.
Pack* write_hessian(const Tree& tree, const Given& in, std::size_t j, const Factors& f, Pack* out) {
  const JointState& state = in.states[j];
  const Vector6 &s = state.axis, &rate = state.axis_rate, tested = momentum_of(state.by_test);
  // The transpose of the derivative of P by V is - B(I, L).
  Vector6 for_velocity =
      cross_dual(s, Vector6{zero(), state.product}) - state.by_test * rate + twice(cross_dual(rate, tested));
  for_velocity.angular = for_velocity.angular + transposed_times(state.by_velocity, state.axis_tested);
  const Vector6 for_acceleration = cross_dual(s, tested) + state.inertia * state.axis_tested;
  const Vector6 rate_for_velocity = twice(cross_dual(s, tested)) - state.by_test * s;
  *out++ =
      dot(state.axis_tested, f.for_test) + dot(rate, for_velocity) + dot(state.axis_acceleration, for_acceleration);
  *out++ = dot(s, for_velocity) + 2.0 * dot(rate, for_acceleration);
  *out++ = dot(s, for_acceleration);
  *out++ = dot(s, rate_for_velocity);
  const auto first = static_cast<std::int32_t>(tree.first());
  for (std::int32_t k = tree.joints[j].parent; k >= first; k = tree.joints[k].parent) {
    const JointState& above = in.states[k];
    *out++ = dot(above.axis_tested, f.for_test) + dot(above.axis_rate, for_velocity) +
             dot(above.axis_acceleration, for_acceleration);
    *out++ = dot(above.axis, for_velocity) + 2.0 * dot(above.axis_rate, for_acceleration);
    *out++ = dot(above.axis, for_acceleration);
    *out++ = dot(above.axis_tested, f.rate_for_test) + dot(above.axis_rate, rate_for_velocity);
    *out++ = dot(above.axis, rate_for_velocity);
    *out++ = dot(above.axis_tested, f.momentum);
  }
  if (!tree.flies) return out;
  const Vector6 by_flyer = for_velocity - cross_dual(in.states[0].velocity, for_acceleration);
  for (int i = 0; i < 6; ++i) {
    *out++ = entry(by_flyer, i);
    *out++ = entry(for_acceleration, i);
    *out++ = entry(rate_for_velocity, i);
  }
  const Attitude attitude = attitude_of(tree, in.q);
  for (int i = 0; i < 4; ++i) *out++ = dot(attitude.derivative(i), for_acceleration.linear);
  return out;
}

void inverse_dynamics(const Tree& tree, const RigidArguments& numbers) {
  const Given in = {packs(numbers.q),
                    packs(numbers.w),
                    packs(numbers.a),
                    packs(numbers.test),
                    reinterpret_cast<JointState*>(numbers.states),
                    packs(numbers.tau),
                    packs(numbers.jacobian),
                    packs(numbers.hessian)};
  const bool tested = in.hessian, derivatives = tested || in.jacobian;
  forward(tree, in, derivatives, tested);
  Pack *jacobian = in.jacobian, *hessian = in.hessian;
  for (std::size_t j = tree.count; j-- > tree.first();) {
    JointState& state = in.states[j];
    in.tau[tree.rate(j)] = dot(state.axis, state.force) + tree.joints[j].armature * in.a[tree.rate(j)];
    if (tree.joints[j].parent >= 0) carry(state, in.states[tree.joints[j].parent], derivatives, tested);
  }
  if (tree.flies)
    for (int i = 0; i < 6; ++i) in.tau[i] = entry(in.states[0].force, i);
  if (!derivatives) return;
  for (std::size_t j = tree.first(); j < tree.count; ++j) {
    const Factors factors = factors_of(in.states[j]);
    if (jacobian) jacobian = write_jacobian(tree, in, j, factors, jacobian);
    if (hessian) hessian = write_hessian(tree, in, j, factors, hessian);
  }
  if (!tree.flies) return;
  if (jacobian) write_flyer_jacobian(tree, in, jacobian);
  if (hessian) write_flyer_hessian(tree, in, hessian);
}

}  // namespace
}  // namespace robotraj::native
