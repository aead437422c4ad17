"""Numeric positions and velocities of a robot with a fixed or floating root.

The root is first, as in Pinocchio's free-flyer. q starts with the origin of the root link in the world and the
quaternion (x, y, z, w) of its axes. v starts with its linear and angular velocity in these axes. Every other joint has
one position and one velocity. With a floating root q' differs from v, since q contains a quaternion; otherwise q' = v.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.robot.root import QUATERNION

PLACE, TURN, REST = slice(0, 3), slice(3, 6), slice(6, None)
"""Entries of v: the root's linear velocity, its angular velocity, and the joints."""


def floats(model: pin.Model) -> bool:
    """Whether the root floats: nq = nv + 1."""
    return bool(model.nq > model.nv)


def normalised(model: pin.Model, q: npt.ArrayLike) -> Array:
    """Scale the quaternions of configurations (nq,) or (m, nq) to length 1."""
    result = np.array(q, dtype=float)
    if floats(model):
        quaternion = result[..., QUATERNION]
        result[..., QUATERNION] = quaternion / np.linalg.norm(quaternion, axis=-1, keepdims=True)
    return result


def rates(model: pin.Model, q: npt.ArrayLike, v: npt.ArrayLike) -> Array:
    """Return q' (..., nq) of velocities v (..., nv) at configurations q (..., nq).

    p' = R(quaternion) v and quaternion' = quaternion * (omega, 0) / 2 for the root, v for the joints.
    """
    v = np.asarray(v, dtype=float)
    if not floats(model):
        return v.copy()
    q = np.asarray(q, dtype=float)
    quaternion, omega = q[..., QUATERNION], v[..., TURN]
    spin = np.concatenate([omega, np.zeros_like(omega[..., :1])], axis=-1)
    unit = normalised(model, q)[..., QUATERNION]
    return np.concatenate([rotated(unit, v[..., PLACE]), 0.5 * product(quaternion, spin), v[..., REST]], axis=-1)


def rate_matrix(model: pin.Model, q: Array) -> Array:
    """Matrix Q (nq, nv) of ``rates`` at one configuration: q' = Q v."""
    if not floats(model):
        return np.eye(model.nv)
    matrix = np.zeros((model.nq, model.nv))
    matrix[QUATERNION.stop :, REST] = np.eye(model.nv - TURN.stop)
    # Scalars: for one configuration they take a tenth of the time of products of small arrays.
    x, y, z, w = q[QUATERNION].tolist()
    twice = 2.0 / (x * x + y * y + z * z + w * w)
    matrix[PLACE, PLACE] = [
        [1.0 - twice * (y * y + z * z), twice * (x * y - z * w), twice * (x * z + y * w)],
        [twice * (x * y + z * w), 1.0 - twice * (x * x + z * z), twice * (y * z - x * w)],
        [twice * (x * z - y * w), twice * (y * z + x * w), 1.0 - twice * (x * x + y * y)],
    ]
    x, y, z, w = 0.5 * x, 0.5 * y, 0.5 * z, 0.5 * w
    matrix[QUATERNION, TURN] = [[w, -z, y], [z, w, -x], [-y, x, w], [-x, -y, -z]]
    return matrix


def velocities(model: pin.Model, q: npt.ArrayLike, rate: npt.ArrayLike) -> Array:
    """Return v (..., nv) that moves configurations q (..., nq) at q' (..., nq): the inverse of ``rates``.

    The component of a quaternion's rate that changes its length is ignored.
    """
    rate = np.asarray(rate, dtype=float)
    if not floats(model):
        return rate.copy()
    q = np.asarray(q, dtype=float)
    size = np.linalg.norm(q[..., QUATERNION], axis=-1, keepdims=True)
    back = conjugate(q[..., QUATERNION] / size)
    omega = 2.0 * product(back, rate[..., QUATERNION] / size)[..., :3]
    return np.concatenate([rotated(back, rate[..., PLACE]), omega, rate[..., QUATERNION.stop :]], axis=-1)


def difference(model: pin.Model, first: npt.ArrayLike, second: npt.ArrayLike) -> Array:
    """Tangent vectors (..., nv) that take configurations ``first`` to ``second`` (..., nq): ``pin.difference``."""
    first, second = np.broadcast_arrays(np.asarray(first, dtype=float), np.asarray(second, dtype=float))
    if not floats(model):
        return np.asarray(second - first)
    first, second = normalised(model, first), normalised(model, second)
    pairs = zip(first.reshape(-1, model.nq), second.reshape(-1, model.nq), strict=True)
    rows = np.array([pin.difference(model, a, b) for a, b in pairs])
    return rows.reshape(*first.shape[:-1], model.nv)


def product(a: Array, b: Array) -> Array:
    """Quaternion product a * b, (..., 4) in the order x, y, z, w."""
    va, wa, vb, wb = a[..., :3], a[..., 3:], b[..., :3], b[..., 3:]
    vector = wa * vb + wb * va + np.cross(va, vb)
    return np.concatenate([vector, wa * wb - np.sum(va * vb, axis=-1, keepdims=True)], axis=-1)


def conjugate(a: Array) -> Array:
    """Return the conjugates of quaternions (..., 4): the inverse rotations."""
    return a * np.array([-1.0, -1.0, -1.0, 1.0])


def rotated(quaternion: Array, vector: Array) -> Array:
    """Return vectors (..., 3) rotated by unit quaternions (..., 4)."""
    axis, w = quaternion[..., :3], quaternion[..., 3:]
    across = 2.0 * np.cross(axis, vector)
    return np.asarray(vector + w * across + np.cross(axis, across))
