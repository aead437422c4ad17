"""The neutral configuration: the SRDF's reference if there is one, otherwise zeros, moved inside the limits."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.robot.configuration import unit_quaternion
from robotraj.robot.limits import Limits
from robotraj.robot.loading.planning_model import angles
from robotraj.robot.root import QUATERNION, in_plane, with_root

REFERENCES = ("half_sitting", "standing", "default", "home", "neutral", "arm_up", "hanging")
"""Names of reference configurations in order of preference."""


def reference(model: pin.Model, srdf: Path | None, root: str = "fixed") -> tuple[Array, str]:
    """Return the neutral configuration as angles (nq,), and its name, which is empty for zeros.

    Parameters
    ----------
    model : pinocchio.Model
        The model as read, with cosine and sine of continuous joints; not changed.
    srdf : Path, optional
        Its ``<group_state>`` tags join the model's own reference configurations.
    root : str
        The kind of root. A reference for the free-flyer ``root_joint`` is also used for a planar root.
    """
    # A copy is needed only where references or a root are added.
    copy = model if root == "fixed" and srdf is None else with_root(model, "fixed" if root == "fixed" else "floating")
    if srdf is not None:
        pin.loadReferenceConfigurations(copy, str(srdf), False)
    references = copy.referenceConfigurations
    known = {entry.key(): np.array(entry.data()) for entry in references} if len(references) else {}
    name = next((name for name in REFERENCES if name in known), next(iter(known), ""))
    q = known[name] if known else pin.neutral(copy)
    if not np.all(np.isfinite(q)):
        raise InputError(
            f"The reference configuration {name!r} of {model.name!r} holds values that are no numbers; correct it."
        )
    if root != "fixed":
        q[QUATERNION] = unit_quaternion(q[QUATERNION], f"reference configuration {name!r} of {model.name!r}")
    q = angles(copy, q)
    return (np.append(in_plane(q), q[QUATERNION.stop :]) if root == "planar" else q), name


def inside(q: Array, limits: Limits) -> Array:
    """Move each joint to the nearest position within its limits [rad, m]; inverted limits are ignored.

    A floating root does not move; it has one position more than limits.
    """
    lower, upper = limits.positions
    return np.where(lower <= upper, np.clip(q, lower, upper), q)


def amid(q: Array, limits: Limits) -> Array:
    """Move each joint with two limits to the middle of its range [rad, m]; a floating root does not move."""
    lower, upper = limits.positions
    both = np.isfinite(lower) & np.isfinite(upper)
    middle = 0.5 * (np.where(both, lower, 0.0) + np.where(both, upper, 0.0))
    return np.where(both, middle, q)


def outside(q: Array, limits: Limits, units: Callable[[], Sequence[str]]) -> dict[str, str]:
    """Describe the joints outside their limits: ``{"elbow": "'elbow' at 0 rad, limits [0.5, 2] rad"}``.

    ``units`` is called only if there are any.
    """
    n = len(limits.joints)  # a floating root has one position more, and no limits
    low, high, at = limits.position_lower, limits.position_upper, q[-n:]
    described = {}
    for i in np.flatnonzero((low <= high) & ~((low <= at) & (at <= high))).tolist():
        joint, unit = limits.joints[i], units()[i]
        described[joint] = f"{joint!r} at {at[i]:.4g} {unit}, limits [{low[i]:.4g}, {high[i]:.4g}] {unit}"
    return described
