"""What a solution on a mesh says about its mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj._util.polynomials import basis
from robotraj.dynamics.rows import as_rows
from robotraj.problem.constraints.base import Row, Where
from robotraj.transcription.exact_motion import is_exact
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.interval_limits.constraint_generation import Curve, guardable
from robotraj.transcription.refinement.error import interval_errors
from robotraj.transcription.refinement.integrals import integral_errors
from robotraj.transcription.refinement.strategy import Assessment
from robotraj.transcription.schemes.mesh import Mesh, MovingMesh

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase

Array = NDArray[np.float64]

SAMPLES = 48
"""Places looked at inside an interval."""


def assess(phase: Phase, trajectory: PhaseTrajectory, mesh: Mesh, settled: bool) -> Assessment:
    """Assess every interval of a phase; knots that move may have jumps of the control on them."""
    moving = isinstance(mesh, MovingMesh)
    return Assessment(
        np.maximum(interval_errors(phase, trajectory), integral_errors(phase, trajectory, mesh.schemes)),
        _jumps(trajectory, moving),
        _decays(trajectory),
        broken_rows(phase, trajectory),
        settled,
        _coarse(trajectory, moving),
    )


def errors_of(phase: Phase, trajectory: PhaseTrajectory, mesh: Mesh) -> Array:
    """Relative error of every interval, of its states or of an integral constraint, (K,).

    States of an exact motion have none: its torques follow from inverse dynamics (``transcription.exact_motion``).
    """
    of_integrals = integral_errors(phase, trajectory, mesh.schemes)
    if is_exact(phase, mesh.schemes):
        return of_integrals
    return np.maximum(interval_errors(phase, trajectory), of_integrals)


def _jumps(trajectory: PhaseTrajectory, moving: bool) -> Array:
    values = trajectory.u.values
    every = np.vstack(list(values))
    if not every.shape[1]:
        return np.zeros(len(values))
    span = np.ptp(every, axis=0)
    span = np.where(span > 0, span, 1.0)
    inside = np.array([np.max(np.ptp(value, axis=0) / span) for value in values])
    if moving:
        # A switch belongs on a knot that moves.
        return inside
    # A switch may also stand between the last node of one interval and the first of the next.
    ends = np.array([np.max(np.abs(b[0] - a[-1]) / span) for a, b in zip(values[:-1], values[1:], strict=True)])
    return np.maximum(inside, np.maximum(np.append(ends, 0.0), np.append(0.0, ends)))


def _coarse(trajectory: PhaseTrajectory, moving: bool) -> Array:
    """Duration times the square of how far the neighbours' controls, carried on, miss the interval's own (K,).

    For constants that is the step, for lines the kink; relative to the control's range over the phase. Steps on knots
    that move belong there.
    """
    values, sites, lengths = trajectory.u.values, trajectory.u.sites, np.diff(trajectory.u.breaks)
    missed = np.zeros(len(values))
    if moving or not values[0].shape[1]:
        return missed
    span = np.ptp(np.vstack(list(values)), axis=0)
    span = np.where(span > 0, span, 1.0)
    middles = 0.5 * (trajectory.u.breaks[:-1] + trajectory.u.breaks[1:])
    own = np.array([basis(at, np.array([0.5]))[0] @ value for at, value in zip(sites, values, strict=True)])
    for k in range(len(values) - 1):
        for here, there in ((k, k + 1), (k + 1, k)):
            tau = np.array([0.5 + (middles[there] - middles[here]) / lengths[here]])
            carried = basis(sites[here], tau)[0] @ values[here]
            missed[there] = max(missed[there], np.max(np.abs(carried - own[there]) / span))
    return np.asarray(lengths * missed**2)


def broken_rows(phase: Phase, trajectory: PhaseTrajectory, torques: Curve | None = None) -> Array:
    """Look between the nodes at path rows that read more than the state; those of states alone have guards.

    Parameters
    ----------
    phase : Phase
    trajectory : PhaseTrajectory
    torques : Curve, optional
        Torques at any time, where they are known better than from their polynomials.

    Returns
    -------
    ndarray (K,)
        Largest excess over a bound on every interval, relative to 1 + |bound|; not above 0 where all hold.
    """
    breaks, count = trajectory.x.breaks, len(trajectory.x.values)
    guarded = {(constraint, row) for constraint, row, *_ in guardable(phase)}
    dae = phase.dae
    sizes = {
        "t": 1,
        "x": len(dae.states),
        "z": len(dae.algebraic),
        "u": len(dae.controls),
        "p": len(trajectory.parameters),
    }
    t, x, z, u, p = symbols = [ca.SX.sym(name, size) for name, size in sizes.items()]
    point = dae.point(t, x, z, u, p, phase.parameter_names)
    rows: list[Row] = []
    values: list[ca.SX] = []
    for c, constraint in enumerate(phase.bound_constraints):
        if constraint.where is Where.THROUGHOUT and any(row.variable is None for row in constraint.rows):
            entries = as_rows(constraint.expression(point), f"expression of {constraint.name!r}")
            chosen = [r for r, row in enumerate(constraint.rows) if row.variable is None and (c, r) not in guarded]
            rows += [constraint.rows[r] for r in chosen]
            values += [entries[r] for r in chosen]
    if not rows:
        return np.zeros(count)
    inner = (np.arange(SAMPLES) + 0.5) / SAMPLES
    times = (breaks[:-1, None] + np.diff(breaks)[:, None] * inner).ravel()
    curves = [curve(times).T for curve in (trajectory.x, trajectory.z, trajectory.u)]
    if torques is not None and dae.controls == phase.body.controls:
        curves[2] = torques(times).T
    parameters = np.tile(np.array(list(trajectory.parameters.values()))[:, None], len(times))
    function = ca.Function("rows", symbols, [ca.densify(ca.vertcat(*values))]).map(len(times))
    seen = np.array(function(times[None, :], *curves, parameters)).reshape(len(rows), count, SAMPLES)
    lower, upper = (np.array([getattr(row, side) for row in rows])[:, None, None] for side in ("lower", "upper"))
    over = np.maximum(
        (lower - seen) / (1 + np.abs(np.where(np.isfinite(lower), lower, 0.0))),
        (seen - upper) / (1 + np.abs(np.where(np.isfinite(upper), upper, 0.0))),
    )
    return np.asarray(over.max(axis=(0, 2)))


def _decays(trajectory: PhaseTrajectory) -> Array:
    """Slope of log10 |c_n| over the degree n of the states' Legendre coefficients, least over the states."""
    decays = []
    for sites, values in zip(trajectory.x.sites, trajectory.x.values, strict=True):
        degree = len(sites) - 1
        coefficients = np.abs(np.polynomial.legendre.legfit(2 * sites - 1, values, degree))
        scale = np.maximum(np.abs(values).max(axis=0), 1e-8)
        # What lies below round-off says nothing of smoothness.
        logs = np.log10(np.maximum(coefficients / scale, 1e-14))
        slopes = np.polyfit(np.arange(1, degree + 1), logs[1:], 1)[0] if degree > 1 else logs[1] - logs[0]
        moving = coefficients[1:].max(axis=0) > 1e-10 * scale
        decays.append(float(np.min(-slopes[moving], initial=np.inf)))
    return np.array(decays)
