"""Teeth of the planned controls, read from the plan's own curves at its knots and in the middle of its intervals."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.teeth import teeth
from robotraj.witness.planned import limits_of, robot_sample, system_of
from robotraj.witness.protocols import PhaseSolutionLike


class Teeth(NamedTuple):
    """The largest teeth of a control: its name, its phase, and their height relative to its limit."""

    control: str
    phase: str
    relative: float


def teeth_of(phases: Sequence[PhaseSolutionLike], clock: Callable[[], None] = lambda: None) -> Teeth | None:
    """Return the largest teeth of all controls that have limits on both sides; None without such a control."""
    found: list[Teeth] = []
    for planned in phases:
        clock()
        names, sizes = _limited(planned)
        heights = teeth(*_values(planned)) / sizes
        found += [
            Teeth(name, planned.phase.name, float(height))
            for name, height, size in zip(names, heights, sizes, strict=True)
            if np.isfinite(size)
        ]
    return max(found, key=lambda each: each.relative, default=None)


def _limited(planned: PhaseSolutionLike) -> tuple[Sequence[str], Array]:
    """Return the names of the controls and the magnitudes of their limits, infinite without, (nu,)."""
    if planned.phase.robot is None:
        names: Sequence[str] = [control.name for control in system_of(planned).controls]
        sides = planned.phase.rows.limits()
        lower, upper = np.reshape([sides.get(name, (-np.inf, np.inf)) for name in names], (-1, 2)).T
        size = np.maximum(np.abs(lower), np.abs(upper))
    else:
        robot, limits = planned.phase.robot, limits_of(planned)
        names = robot.actuated
        columns = [robot.velocity_names.index(name) for name in names]
        every = (np.full(robot.nv, np.inf),) if limits is None else limits.sides("effort")
        size = np.max(np.abs(every), axis=0)[columns]
    return names, np.where(size > 0.0, size, np.inf)


def _values(planned: PhaseSolutionLike) -> tuple[Array, Array]:
    """Return the times of knots and middles [s], (2K + 1,), and the controls there, (2K + 1, nu)."""
    knots = np.asarray(planned.knots, dtype=float)
    times = np.append(np.stack([knots[:-1], 0.5 * (knots[:-1] + knots[1:])], axis=1).ravel(), knots[-1])
    interval = np.minimum(np.arange(len(times)) // 2, len(knots) - 2)
    if planned.phase.robot is not None:
        return times, robot_sample(planned, times, interval).tau
    u = planned.at(times, interval=interval).u
    columns = [np.asarray(u[control.name], dtype=float) for control in system_of(planned).controls]
    return times, np.stack(columns, axis=1) if columns else np.zeros((len(times), 0))
