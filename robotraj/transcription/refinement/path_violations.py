"""Violations of path rows between the collocation points, of rows that read more than the state.

Rows of the state alone are the subject of constraint generation, and bounds of controls that of Bernstein bounds.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj.problem.constraints.base import Row
from robotraj.problem.rows import PhaseRow
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.interval_limits.interval_violations import Curve

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase

Array = NDArray[np.float64]

SAMPLES = 48
"""Places inside an interval at which rows are evaluated."""
GRAVITY = 9.81
"""Standard acceleration of free fall [m/s^2], for the weight of a robot."""
FORCE_POWERS = {"N": 1, "N m": 1, "N^2": 2}
"""Power of the force in the unit of a row of a contact, which is measured against that power of the weight."""


def row_size(row: Row) -> float:
    """Return what a violation of a row is relative to: half the range of two bounds, else max(1, abs(bound))."""
    width = row.upper - row.lower
    if 0.0 < width < np.inf:
        return 0.5 * width
    return max(1.0, *(abs(bound) for bound in (row.lower, row.upper) if np.isfinite(bound)))


def broken_rows(phase: Phase, trajectory: PhaseTrajectory, torques: Curve | None = None) -> Array:
    """Measure violations of path rows that read more than the state, and of bounds of contact forces.

    Parameters
    ----------
    phase : Phase
    trajectory : PhaseTrajectory
    torques : Curve, optional
        Torques at any time, where they are known better than from their polynomials.

    Returns
    -------
    ndarray (K,)
        Largest violation on every interval, relative to ``row_size``, of contacts to the weight of the robot; 0 or
        less where all rows hold.
    """
    breaks, count = trajectory.x.breaks, len(trajectory.x.values)
    rows = (*phase.rows.of_inputs, *_bounds_of_forces(phase))
    if not rows:
        return np.zeros(count)
    inner = (np.arange(SAMPLES) + 0.5) / SAMPLES
    times = (breaks[:-1, None] + np.diff(breaks)[:, None] * inner).ravel()
    exact = torques is not None and phase.dae.controls == phase.body.controls
    controls = torques if torques is not None and exact else trajectory.u
    x, z, u = (curve.inside(inner).reshape(len(times), -1) for curve in (trajectory.x, trajectory.z, controls))
    values = phase.rows.sample(rows, times, x, z, u, np.array(list(trajectory.parameters.values()), dtype=float))
    lower, upper, sizes = (
        np.array(each) for each in zip(*((row.lower, row.upper, _size(phase, row)) for row in rows), strict=True)
    )
    over = np.maximum(lower - values, values - upper) / sizes
    return np.asarray(over.reshape(count, -1).max(axis=1))


def _bounds_of_forces(phase: Phase) -> list[PhaseRow]:
    return [row for row, _ in phase.rows.bounds_of(force for c in phase.bound_contacts for force in c.forces)]


def _size(phase: Phase, row: PhaseRow) -> float:
    contacts = {f"contact {contact.name}" for contact in phase.bound_contacts}
    if phase.robot is None or phase.rows.constraints[row.constraint].name not in contacts:
        return row_size(row)
    return float((GRAVITY * phase.robot.mass) ** FORCE_POWERS.get(row.unit, 1))
