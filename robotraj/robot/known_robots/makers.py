"""Limits of acceleration and jerk that makers publish, which URDFs do not hold."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from robotraj._util.errors import unknown_name
from robotraj._util.values import dataclass
from robotraj.robot.limits import Limits


@dataclass(frozen=True)
class MakerLimits:
    """A maker's limits of the joints, in their order.

    Attributes
    ----------
    joints : tuple of str
    acceleration, jerk : tuple of float
        [rad/s^2], [rad/s^3].
    source : str
        Document that states them.
    """

    joints: tuple[str, ...]
    acceleration: tuple[float, ...]
    jerk: tuple[float, ...]
    source: str


_PANDA = MakerLimits(
    tuple(f"panda_joint{k}" for k in range(1, 8)),
    (15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0),
    (7500.0, 3750.0, 5000.0, 6250.0, 7500.0, 10000.0, 10000.0),
    "Franka Emika, libfranka, include/franka/rate_limiting.h",
)
MAKERS: Mapping[str, MakerLimits] = {"panda": _PANDA, "panda_collision": _PANDA}
"""By name of the catalogue. Universal Robots states no limits of acceleration for its arms, only of torque."""


def maker_limits(name: str) -> dict[str, dict[str, float]]:
    """Return a maker's limits of acceleration and jerk for ``limits=`` of ``rt.load``.

    Parameters
    ----------
    name : str
        A robot of the catalogue.

    Returns
    -------
    dict
        ``{"acceleration": {joint: [rad/s^2]}, "jerk": {joint: [rad/s^3]}}``.

    Raises
    ------
    UnknownName
        The table does not have the robot.

    Examples
    --------
    >>> import robotraj as rt
    >>> panda = rt.load("panda", limits=rt.robot.maker_limits("panda"))
    >>> float(panda.limits.acceleration[1])
    7.5
    """
    if name not in MAKERS:
        raise unknown_name("robot with a maker's limits", name, list(MAKERS), "Give limits={'acceleration': ...}.")
    found = MAKERS[name]
    return {
        "acceleration": dict(zip(found.joints, found.acceleration, strict=True)),
        "jerk": dict(zip(found.joints, found.jerk, strict=True)),
    }


def makers_note(name: str, limits: Limits) -> str:
    """Return a note of the maker's limits, or that the robot has none of them; empty where the table lacks it."""
    found = MAKERS.get(name)
    if found is None:
        return ""
    numbers = [limits.joints.index(joint) for joint in found.joints if joint in limits.joints]
    missing = [each for each in ("acceleration", "jerk") if not np.isfinite(limits.largest(each)[numbers]).any()]
    if not missing:
        return ""
    return (
        f"The maker limits {' and '.join(missing)} of the joints ({found.source}): load it with "
        f"limits={limits_text(name)}."
    )


def limits_text(name: str) -> str:
    """Return the value of ``limits=`` of ``rt.load`` that gives a robot limits of acceleration, as a text."""
    return f"rt.robot.maker_limits({name!r})" if name in MAKERS else "{'acceleration': ...}"
