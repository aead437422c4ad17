"""Times at which a bounded rate jumps from one constant to another, and meshes with knots there.

In least time under limits of jerk, da/dt is at a limit or 0 nearly everywhere, and jumps between these values. The
polynomial of an interval cannot jump inside it, so that a motion takes longer by the square of the interval's length.
With a knot at the jump it does not. Where the rate is constant, l_0 before time t_0 and l_1 after t_1, the change of a
gives the time of the jump,

    t_0 + (a(t_1) - a(t_0) - l_1 (t_1 - t_0)) / (l_0 - l_1).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj.transcription.schemes.mesh import Mesh

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase
    from robotraj.transcription.extract import PhaseTrajectory

Array = NDArray[np.float64]

FLAT, JUMP = 1e-3, 0.02
"""Largest change of a constant rate on an interval, and least jump, relative to the limit."""
WIDEST = 2
"""Largest number of intervals on which a jump is spread."""
AT_KNOT = 0.02
"""Distance from a knot, relative to the interval, below which a jump is at the knot."""


def switches(phase: Phase, trajectory: PhaseTrajectory) -> Array:
    """Return the fractions of a phase at which bounded rates jump inside an interval, ascending, (n,)."""
    found: list[float] = []
    for variables, curve in ((phase.dae.algebraic, trajectory.z), (phase.dae.controls, trajectory.u)):
        bounds = phase.rows.rates_of(variables)
        if bounds:
            both = np.array([0.0, 1.0])
            ends, rates = curve.inside(both), curve.derivative().inside(both)
            for row, column in bounds:
                found += _jumps(curve.breaks, ends[:, :, column], rates[:, :, column], row.greatest_bound)
    breaks = trajectory.x.breaks
    return np.sort((np.array(found) - breaks[0]) / (breaks[-1] - breaks[0]))


def _jumps(knots: Array, ends: Array, rates: Array, limit: float) -> Iterator[float]:
    """Yield the times of the jumps of one rate inside intervals."""
    flat = np.flatnonzero(np.abs(rates[:, 1] - rates[:, 0]) < FLAT * limit)
    levels = rates.mean(axis=1)
    for i, j in zip(flat[:-1], flat[1:], strict=True):
        jump = levels[i] - levels[j]
        if not 1 < j - i <= 1 + WIDEST or abs(jump) < JUMP * limit:
            continue
        length = knots[j] - knots[i + 1]
        after = (ends[j, 0] - ends[i, 1] - levels[j] * length) / jump
        if 0.0 <= after <= length:
            yield float(knots[i + 1] + after)


def with_knots_at(mesh: Mesh, fractions: Array) -> Mesh:
    """Return a mesh whose nearest inner knots are moved to the fractions; knots that are near enough stay."""
    knots = np.array(mesh.knots)
    free = np.arange(1, len(knots) - 1)
    for fraction in fractions:
        if not len(free):
            break
        nearest = int(np.argmin(np.abs(knots[free] - fraction)))
        at = free[nearest]
        length = min(knots[at + 1] - knots[at], knots[at] - knots[at - 1])
        free = np.delete(free, nearest)
        if abs(knots[at] - fraction) > AT_KNOT * length and knots[at - 1] < fraction < knots[at + 1]:
            knots[at] = fraction
    return mesh if np.array_equal(knots, mesh.knots) else replace(mesh, intervals=tuple(knots.tolist()))
