"""Arcs: parts of a trajectory on which every control is either at one bound or between its bounds."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.indirect.costate_trajectory import PhaseCostates
from robotraj.problem.constraints.base import Where
from robotraj.problem.phase import Phase

BOUND_TOLERANCE = 1e-4
"""Distance from a bound, relative to the range, below which a control counts as at the bound."""
INTERIOR_MARGIN = 0.05
"""Distance from both bounds, relative to the range, beyond which a bang-bang control counts as interior."""


class Side(Enum):
    """Position of a control relative to its bounds on an arc."""

    LOWER = "lower bound"
    UPPER = "upper bound"
    INTERIOR = "interior"


@dataclass(frozen=True)
class Arc(OneLine):
    """An arc from ``start`` to ``end`` [s], with one side for every control."""

    start: float
    end: float
    sides: tuple[Side, ...]


def control_bounds(phase: Phase) -> tuple[Array, Array]:
    """Return the lower and upper bounds of the controls over the whole phase, (nu,) each."""
    limits = phase.rows.limits(Where.THROUGHOUT, Where.AT_NODES)
    pairs = [limits.get(control.name, (-np.inf, np.inf)) for control in phase.dae.controls]
    lower, upper = np.reshape(pairs, (-1, 2)).T
    return lower, upper


def affine_controls(costates: PhaseCostates) -> NDArray[np.bool_]:
    """Return which controls enter the Hamiltonian linearly, (nu,); they are bang-bang or singular."""
    hamiltonian = costates.hamiltonian
    hessian = ca.hessian(hamiltonian.expressions["hamiltonian"], hamiltonian.symbols["u"])[0]
    dense = [[hessian[i, j].is_zero() for j in range(hessian.shape[1])] for i in range(hessian.shape[0])]
    return np.array([all(row) for row in dense], dtype=bool)


def find_arcs(costates: PhaseCostates) -> tuple[Arc, ...]:
    """Return the sequence of arcs of a direct solution.

    Raises
    ------
    InputError
        A control that enters linearly is between its bounds: a singular arc.
    """
    solution = costates.solution
    lower, upper = control_bounds(solution.phase)
    affine = affine_controls(costates)
    times, values = _control_values(costates)
    first, last = solution.t0, solution.t0 + solution.duration
    step = float(np.median(np.diff(solution.knots)))
    changes: list[tuple[float, int, Side]] = []
    sides = []
    for i, control in enumerate(solution.phase.dae.controls):
        if affine[i]:
            _refuse_singular(control.name, times, values[:, i], lower[i], upper[i], step)
            runs = _bang_bang(times, values[:, i], lower[i], upper[i], 0.5 * step)
        else:
            runs = _bounded(times, values[:, i], lower[i], upper[i])
        sides.append(runs[0][1])
        changes += [(time, i, side) for time, side in runs[1:]]
    changes.sort(key=lambda change: change[0])
    arcs, start = [], first
    for time, i, side in changes:
        arcs.append(Arc(start, time, tuple(sides)))
        sides[i], start = side, time
    arcs.append(Arc(start, last, tuple(sides)))
    return tuple(arcs)


def _control_values(costates: PhaseCostates) -> tuple[Array, Array]:
    """Sample the controls at the nodes of every interval, in order: times (m,) and values (m, nu)."""
    u = costates.solution.trajectory.u
    lengths = np.diff(u.breaks)
    times = [b + h * z for b, h, z in zip(u.breaks[:-1], lengths, costates.duals.residual.sites, strict=True)]
    values = [u(t, k) for k, t in enumerate(times)]
    return np.concatenate(times), np.vstack(values)


def _refuse_singular(name: str, times: Array, values: Array, low: float, high: float, step: float) -> None:
    inside = np.ones(len(values), dtype=bool)
    if np.isfinite(low) and np.isfinite(high):
        margin = INTERIOR_MARGIN * (high - low)
        inside = (values > low + margin) & (values < high - margin)
    start = None
    for time, interior in zip(times, inside, strict=True):
        start = (time if start is None else start) if interior else None
        if start is not None and time - start > 2.5 * step:
            raise InputError(
                f"Control {name!r} enters the Hamiltonian linearly and is between its bounds from "
                f"t = {start:.4g} s. First-order conditions do not determine a control on such a singular arc. "
                f"Add a small quadratic cost on {name!r}, or keep the direct solution."
            )


def _bang_bang(times: Array, values: Array, low: float, high: float, least: float) -> list[tuple[float, Side]]:
    """Divide into runs at one bound, at crossings of the middle; runs shorter than ``least`` are ignored."""
    offset = values - 0.5 * (low + high)
    runs = [(float(times[0]), Side.UPPER if offset[0] > 0 else Side.LOWER)]
    for k in range(1, len(times)):
        side = Side.UPPER if offset[k] > 0 else Side.LOWER
        if side is not runs[-1][1]:
            span = offset[k] - offset[k - 1]
            runs.append((float(times[k] - (times[k] - times[k - 1]) * offset[k] / span), side))
    return _without_short(runs, float(times[-1]), least)


def _bounded(times: Array, values: Array, low: float, high: float) -> list[tuple[float, Side]]:
    """Divide into runs at a bound or between the bounds; a run has at least two nodes."""
    scale = high - low if np.isfinite(high - low) else 1.0 + float(np.max(np.abs(values)))
    runs: list[tuple[float, Side]] = []
    for k, value in enumerate(values):
        side = Side.INTERIOR
        if value <= low + BOUND_TOLERANCE * scale:
            side = Side.LOWER
        elif value >= high - BOUND_TOLERANCE * scale:
            side = Side.UPPER
        if not runs or side is not runs[-1][1]:
            runs.append((float(times[k] if k == 0 else 0.5 * (times[k - 1] + times[k])), side))
    return _without_short(runs, float(times[-1]), 0.75 * float(np.median(np.diff(np.unique(times)))))


def _without_short(runs: Sequence[tuple[float, Side]], end: float, least: float) -> list[tuple[float, Side]]:
    kept: list[tuple[float, Side]] = []
    ends = [time for time, _ in runs[1:]] + [end]
    for (time, side), stop in zip(runs, ends, strict=True):
        if kept and side is kept[-1][1]:
            continue
        if stop - time < least and len(runs) > 1:
            continue
        kept.append((time if kept else runs[0][0], side))
    return kept or [runs[0]]
