"""Times at which a bounded rate jumps from one constant to another, and meshes with knots there.

In least time under limits of jerk, da/dt is at a limit or 0 nearly everywhere, and jumps between these values. The
polynomial of an interval cannot jump inside it, so that a motion takes longer by the square of the interval's length.
With a knot at the jump it does not. Where the rate is constant, l_0 before time t_0 and l_1 after t_1, the change of a
gives the time of the jump,

    t_0 + (a(t_1) - a(t_0) - l_1 (t_1 - t_0)) / (l_0 - l_1).

Where both are the same, l, an arc at a limit m may be shorter than the intervals between. With D = t_1 - t_0, the arc
lasts (a(t_1) - a(t_0) - l D) / (m - l), and the integral of a over D gives its middle.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from robotraj._util.arrays import Array
from robotraj.problem.phase import Phase
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.schemes.lobatto import HermiteSimpson
from robotraj.transcription.schemes.mesh import Mesh

FLAT, JUMP = 1e-3, 0.02
"""Largest change of a constant rate on an interval, and least jump, relative to the limit.

A jump that is nearer to a knot, relative to the interval, is at the knot.
"""
WIDEST = 2
"""Largest number of intervals on which a jump is spread."""
SITES, SIMPSON = HermiteSimpson().nodes, HermiteSimpson().objective_weights
"""Places in an interval, and the weights of Simpson's rule there."""


def switches(phase: Phase, trajectory: PhaseTrajectory) -> Array:
    """Return the fractions of a phase at which bounded rates jump inside an interval, ascending, (n,)."""
    found: list[float] = []
    for variables, curve in ((phase.dae.algebraic, trajectory.z), (phase.dae.controls, trajectory.u)):
        bounds = phase.rows.rates_of(variables)
        if bounds:
            values, rates = curve.inside(SITES), curve.derivative().inside(SITES[[0, -1]])
            for row, column in bounds:
                found += _jumps(curve.breaks, values[:, :, column], rates[:, :, column], row.greatest_bound)
    breaks = trajectory.x.breaks
    return np.sort((np.array(found) - breaks[0]) / (breaks[-1] - breaks[0]))


def _jumps(knots: Array, values: Array, rates: Array, limit: float) -> Iterator[float]:
    """Yield the times of the jumps of one rate inside intervals.

    ``values`` are those at ``SITES`` of every interval, ``rates`` those at its ends.
    """
    at = np.append(values[:, 0], values[-1, -1])
    for i, j, first, last in _flat_pairs(rates, limit):
        length = knots[j] - knots[i]
        jump, changed = first - last, at[j] - at[i] - last * length
        if abs(jump) >= JUMP * limit:
            places = [changed / jump]
        elif abs(changed) > JUMP * limit * length:
            mean = np.diff(knots[i : j + 1]) @ (values[i:j] @ SIMPSON) / length
            # An arc in the middle of the intervals changes the mean by half of what it changes the value.
            after = length * (mean - at[i] - 0.5 * last * length) / changed
            half = 0.5 * abs(changed / (np.copysign(limit, changed) - last))
            places = [length - after - half, length - after + half]
        else:
            continue
        yield from (float(knots[i] + place) for place in places if 0.0 <= place <= length)


def _flat_pairs(rates: Array, limit: float) -> Iterator[tuple[int, int, float, float]]:
    """Yield the knots between which a rate changes, on few intervals, and the constants before and after.

    It is constant on intervals, or 0 at a knot between two others: an arc at 0 as short as an interval.
    """
    is_flat = np.abs(rates[:, 1] - rates[:, 0]) < FLAT * limit
    flat = np.flatnonzero(is_flat)
    zero = np.abs(rates) < FLAT * limit
    resting = 1 + np.flatnonzero(zero[:-1, 1] & zero[1:, 0] & ~is_flat[:-1] & ~is_flat[1:])
    levels = rates.mean(axis=1)
    arcs = sorted([*((i, i + 1, levels[i]) for i in flat), *((k, k, 0.0) for k in resting)])
    for (_, i, first), (j, _, last) in zip(arcs[:-1], arcs[1:], strict=True):
        if 0 < j - i <= WIDEST:
            yield int(i), int(j), float(first), float(last)


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
        if abs(knots[at] - fraction) > JUMP * length and knots[at - 1] < fraction < knots[at + 1]:
            knots[at] = fraction
    return mesh if np.array_equal(knots, mesh.knots) else replace(mesh, intervals=tuple(knots.tolist()))
