"""The axes of a foot, fixed in its frame: as given, or derived from the neutral configuration."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.point_on_frame import Triple, vector_of
from robotraj.dynamics.variable import Scalar


@dataclass(frozen=True)
class FootAxes:
    """Right-handed unit vectors of a foot in its frame's axes: forward x left = up.

    Attributes
    ----------
    forward, left, up : tuple of 3 float
    """

    forward: Triple
    left: Triple
    up: Triple


def foot_axes(
    rotation: Array,
    normal: Sequence[Scalar],
    up: Sequence[float] | None,
    forward: Sequence[float] | None,
    what: str,
    ahead: Sequence[float] = (1.0, 0.0, 0.0),
) -> FootAxes:
    """Return the axes of a foot.

    Without ``up``, it is the frame's axis nearest the ground's normal. Without ``forward``, it is the remaining axis
    nearest ``ahead``.

    Parameters
    ----------
    rotation : (3, 3) array
        Rotation of the frame in the neutral configuration.
    normal : sequence of 3 float
        The ground's normal there, in world axes.
    up, forward : sequence of 3 float or None
        In the frame's axes, of any length. The component of ``forward`` along ``up`` is removed.
    what : str
        The contact, for errors.
    ahead : sequence of 3 float
        World axis that the foot points along by default.

    Raises
    ------
    InputError
        Vectors of length zero, or parallel vectors.
    """
    upward = (
        _nearest(rotation, np.asarray(normal, dtype=float), _signed_axes())
        if up is None
        else np.array(unit(up, f"normal of {what}"))
    )
    if forward is None:
        level = [axis for axis in _signed_axes() if abs(axis @ upward) < 0.8]
        along = _nearest(rotation, np.asarray(ahead, dtype=float), level)
    else:
        along = np.array(unit(forward, f"forward axis of {what}"))
    along = along - (along @ upward) * upward
    size = float(np.linalg.norm(along))
    if size < 1e-6:
        raise InputError(f"The forward axis of {what} is along its normal; give one that lies in the sole.")
    along = along / size
    return FootAxes(_triple(along), _triple(np.cross(upward, along)), _triple(upward))


def _nearest(rotation: Array, direction: Array, axes: list[Array]) -> Array:
    """Return the axis of the frame that is nearest a world direction."""
    return max(axes, key=lambda axis: float(rotation @ axis @ direction))


def _signed_axes() -> list[Array]:
    return [sign * axis for axis in np.eye(3) for sign in (1.0, -1.0)]


def unit(value: object, what: str) -> Triple:
    """Normalise a direction in the frame's axes.

    Raises
    ------
    InputError
        The value is not three finite numbers, or all are zero.
    """
    array = np.array(vector_of(value, what, "in the frame's axes"))
    size = float(np.linalg.norm(array))
    if size == 0.0:
        raise InputError(f"The {what} has length zero; give a direction in the frame's axes.")
    return _triple(array / size)


def _triple(vector: Array) -> Triple:
    """Set entries of the size of rounding errors to a positive zero."""
    x, y, z = (float(v) if abs(v) > 1e-12 else 0.0 for v in vector)
    return x, y, z
