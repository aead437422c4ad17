"""Conversion between the coordinates of Pinocchio and MuJoCo.

Pinocchio's followers have no coordinates of their own; MuJoCo's have, tied to their leaders by equations.
MuJoCo has its own order of joints, quaternions (w, x, y, z), and the linear velocity of a free joint in the world's
axes; Pinocchio has quaternions (x, y, z, w) and both velocities of a free-flyer in the body's axes.
Angular velocity is in the body's axes in both. With R the rotation of the body and w its angular velocity,

    v_mj = R v,    a_mj = R (a + w x v),    f_mj = R f    (linear parts; the angular ones are equal).

Source: MuJoCo documentation, Computation, "Floating objects"; Pinocchio, joint-free-flyer.hpp.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array

if TYPE_CHECKING:
    import mujoco

WXYZ = [3, 0, 1, 2]
XYZW = [1, 2, 3, 0]


class Coordinates:
    """Convert single positions, velocities, accelerations and forces.

    Parameters
    ----------
    model : pinocchio.Model
    compiled : mujoco.MjModel
        MuJoCo's model with the joints of ``model``, by the same names.
    """

    def __init__(self, model: pin.Model, compiled: mujoco.MjModel) -> None:
        self._nq, self._nv = int(model.nq), int(model.nv)
        self._sizes = int(compiled.nq), int(compiled.nv)
        plain: list[tuple[int, int, int, int]] = []
        self._followers: list[tuple[int, int, int, int, float, float]] = []
        self._free: list[tuple[slice, slice, slice, slice, slice, slice]] = []
        for joint, name in zip(model.joints.tolist()[1:], list(model.names)[1:], strict=True):
            there = compiled.joint(name)
            q, v = int(there.qposadr[0]), int(there.dofadr[0])
            if joint.nv == 0:
                follower = joint.extract()
                self._followers.append((joint.idx_q, q, joint.idx_v, v, follower.scaling, follower.offset))
            elif joint.nq == 1:
                plain.append((joint.idx_q, q, joint.idx_v, v))
            else:
                a, b = joint.idx_q, joint.idx_v
                self._free.append(
                    (
                        slice(a, a + 3),
                        slice(a + 3, a + 7),
                        slice(q, q + 3),
                        slice(q + 3, q + 7),
                        slice(b, b + 3),
                        slice(v, v + 3),
                    )
                )
        self._q, self._qpos, self._v, self._dof = np.array(plain, dtype=int).reshape(-1, 4).T
        self.dofs = np.empty(self._nv, dtype=int)
        """MuJoCo's index of each of Pinocchio's velocities, (nv,)."""
        self.dofs[self._v] = self._dof
        for *_, linear, linear_there in self._free:
            self.dofs[linear.start : linear.start + 6] = np.arange(linear_there.start, linear_there.start + 6)

    def qpos(self, q: Array) -> Array:
        """Return MuJoCo's position (its nq,) for Pinocchio's q (nq,)."""
        there = np.empty(self._sizes[0])
        there[self._qpos] = q[self._q]
        for at, at_there, *_, multiplier, offset in self._followers:
            there[at_there] = multiplier * q[at] + offset
        for place, turn, place_there, turn_there, *_ in self._free:
            there[place_there] = q[place]
            there[turn_there] = q[turn][WXYZ]
        return there

    def q(self, qpos: Array) -> Array:
        """Return Pinocchio's q (nq,) for MuJoCo's position, with a unit quaternion."""
        here = np.empty(self._nq)
        here[self._q] = qpos[self._qpos]
        for place, turn, place_there, turn_there, *_ in self._free:
            here[place] = qpos[place_there]
            here[turn] = qpos[turn_there][XYZW] / np.linalg.norm(qpos[turn_there])
        return here

    def qvel(self, q: Array, v: Array) -> Array:
        """Return MuJoCo's velocity (nv,) for Pinocchio's v (nv,) at q."""
        there = self._to(q, v)
        for _, _, at, at_there, multiplier, _ in self._followers:
            there[at_there] = multiplier * v[at]
        return there

    def v(self, q: Array, qvel: Array) -> Array:
        """Return Pinocchio's v (nv,) for MuJoCo's velocity at Pinocchio's q."""
        here = np.asarray(qvel, dtype=float)[self.dofs]
        for _, turn, _, _, linear, _ in self._free:
            here[linear] = rotation(q[turn]).T @ here[linear]
        return here

    def acceleration(self, q: Array, v: Array, qacc: Array) -> Array:
        """Return Pinocchio's acceleration (nv,) for MuJoCo's, at Pinocchio's q and v."""
        here = self.v(q, qacc)
        for *_, linear, _ in self._free:
            here[linear] -= np.cross(v[linear.stop : linear.stop + 3], v[linear])
        return here

    def force(self, q: Array, tau: Array) -> Array:
        """Return MuJoCo's generalised force (nv,) for Pinocchio's tau (nv,) at q; none acts at followers."""
        return self._to(q, tau)

    def _to(self, q: Array, here: Array) -> Array:
        there = np.zeros(self._sizes[1])
        there[self.dofs] = here
        for _, turn, _, _, linear, linear_there in self._free:
            there[linear_there] = rotation(q[turn]) @ here[linear]
        return there


def rotation(quaternion: Array) -> Array:
    """Return the rotation (3, 3) of a quaternion (x, y, z, w)."""
    return np.asarray(pin.Quaternion(np.asarray(quaternion, dtype=float)).toRotationMatrix())
