"""Convert user input for a configuration to a vector; invalid input raises an error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError, unknown_name

UNIT = 1e-6
"""Largest difference between 1 and a quaternion's length; it permits numbers written with six digits."""


def as_vector(value: npt.ArrayLike | Mapping[str, float], joints: Sequence[str], what: str, rest: Array) -> Array:
    """Coerce to a float array with one value per joint.

    Parameters
    ----------
    value : number, sequence, array or mapping by joint
        A number applies to all joints. Arrays of shape (n,), (n, 1) and (1, n) of any real type are accepted.
    joints : sequence of str
        The moving joints, in order.
    what : str
        Label for messages: ``"q"``.
    rest : (n,) array
        Values of joints that a mapping does not name.

    Raises
    ------
    InputError
        The value is no numbers, not finite or of another size, or a joint is unknown.
    """
    n = len(joints)
    if isinstance(value, Mapping):
        for joint in value:
            if joint not in joints:
                raise unknown_name("moving joint", joint, joints, f"Correct the name in {what}.")
        value = [value.get(joint, rest[i]) for i, joint in enumerate(joints)]
    try:
        vector = np.array(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"{what} is no vector of {n} numbers: {value!r}.") from error
    if vector.ndim == 0:
        vector = np.full(n, float(vector))
    if vector.size != n or sorted(vector.shape)[-1] != vector.size:
        raise InputError(
            f"{what} has shape {vector.shape}; this robot takes {n} values, in the order {', '.join(joints)} "
            "(a continuous joint takes one angle, not its cosine and sine)."
        )
    vector = vector.reshape(n)
    for joint, number in zip(joints, vector, strict=True):
        if not np.isfinite(number):
            raise InputError(f"{what} of joint {joint!r} is {number}; give a finite number.")
    return vector


def unit_quaternion(values: npt.ArrayLike, what: str) -> Array:
    """Return a quaternion (x, y, z, w) scaled to length 1, if its length is 1 up to rounding.

    Raises
    ------
    InputError
        Its length is not 1: Pinocchio would use it without an error, and it is not a rotation.
    """
    quaternion = np.asarray(values, dtype=float)
    size = float(np.linalg.norm(quaternion))
    if not abs(size - 1) <= UNIT:
        raise InputError(
            f"{what}: the quaternion (x, y, z, w) = ({', '.join(f'{value:.6g}' for value in quaternion)}) of the root "
            f"has length {size:.6g}; it must be 1. The identity is (0, 0, 0, 1), w last."
        )
    return quaternion / size
