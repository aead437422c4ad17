"""The neutral configuration: the SRDF's reference where there is one, else zeros, within the limits."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from robotraj.errors import InputError
from robotraj.loading.limits import Limits
from robotraj.loading.surgery import angles

Array = npt.NDArray[np.float64]

REFERENCES = ("half_sitting", "standing", "default", "home", "neutral", "arm_up", "hanging")
"""Names under which robots keep the configuration to start from, the first found is taken."""


def reference(model: pin.Model, srdf: Path | None) -> tuple[Array, str]:
    """Give the configuration to start from, as angles (nv,), and its name (empty for zeros).

    Parameters
    ----------
    model : pinocchio.Model
        The model as read, continuous joints still with cosine and sine; read only.
    srdf : Path, optional
        Its ``<group_state>`` tags join the model's own reference configurations.
    """
    copy = model.copy()
    if srdf is not None:
        pin.loadReferenceConfigurations(copy, str(srdf), False)
    known = {entry.key(): np.array(entry.data()) for entry in copy.referenceConfigurations}
    name = next((name for name in REFERENCES if name in known), next(iter(known), ""))
    q = known.get(name, pin.neutral(copy))
    if not np.all(np.isfinite(q)):
        raise InputError(f"The reference configuration {name!r} of {model.name!r} holds values that are no numbers.")
    return angles(model, q), name


def inside(q: Array, limits: Limits) -> Array:
    """Move each joint to the nearest position within its limits; inverted limits move nothing [rad, m]."""
    sound = limits.position_lower <= limits.position_upper
    return np.where(sound, np.clip(q, limits.position_lower, limits.position_upper), q)


def outside(q: Array, limits: Limits, units: Sequence[str]) -> dict[str, str]:
    """Describe the joints outside their limits: ``{"elbow": "'elbow' at 0 rad, limits [0.5, 2] rad"}``."""
    described = {}
    for joint, unit, value, low, high in zip(
        limits.joints, units, q, limits.position_lower, limits.position_upper, strict=True
    ):
        if low <= high and not low <= value <= high:
            described[joint] = f"{joint!r} at {value:.4g} {unit}, limits [{low:.4g}, {high:.4g}] {unit}"
    return described
