"""Turn what people write for a configuration into a vector, or say what is wrong with it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from robotraj.errors import InputError, unknown_name

Array = npt.NDArray[np.float64]


def as_vector(value: Any, joints: Sequence[str], what: str, rest: Array) -> Array:
    """Coerce to a float array with one value per joint.

    Parameters
    ----------
    value : number, sequence, array or mapping by joint
        A number stands for all joints; (n,), (n, 1) and (1, n) of any real type are taken; joints a mapping
        does not name take their value from ``rest``.
    joints : sequence of str
        The moving joints, in order.
    what : str
        What it is, for messages: ``"q"``.
    rest : (n,) array
        Values for the joints that a mapping leaves out.

    Raises
    ------
    InputError
        No numbers, NaN or infinity, the wrong size, an unknown joint; names the joint.
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
