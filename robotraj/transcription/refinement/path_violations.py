"""Violations between the collocation points of path rows that depend on more than the state.

Constraint generation treats rows of the state alone, and Bernstein bounds treat bounds of controls.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj.problem.phase_row import PhaseRow
from robotraj.transcription.driven_motion import Inputs
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.interval_limits.interval_violations import input_violations

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase

Array = NDArray[np.float64]

GRAVITY = 9.81
"""Standard acceleration of free fall [m/s^2], for the weight of a robot."""
FORCE_POWERS = {"N": 1, "N m": 1, "N^2": 2}
"""Power of the force in the unit of a row of a contact, which is measured against that power of the weight."""


def broken_rows(phase: Phase, trajectory: PhaseTrajectory, inputs: Inputs | None = None) -> Array:
    """Measure violations of path rows that depend on more than the state, and of bounds of contact forces.

    Parameters
    ----------
    phase : Phase
    trajectory : PhaseTrajectory
    inputs : Inputs, optional
        Algebraic variables and controls along the motion; by default their polynomials.

    Returns
    -------
    ndarray (K,)
        Largest violation on every interval, relative to ``PhaseRow.size``, of contacts to the weight of the robot; 0
        where all rows hold.
    """
    excess = np.zeros(len(trajectory.x.values))
    for violation in input_violations(phase, 0, trajectory, inputs):
        relative = violation.amount / _size(phase, violation.row)
        excess[violation.interval] = max(excess[violation.interval], relative)
    return excess


def _size(phase: Phase, row: PhaseRow) -> float:
    contacts = {f"contact {contact.name}" for contact in phase.bound_contacts}
    if phase.robot is None or phase.rows.constraints[row.constraint].name not in contacts:
        return row.size
    return float((GRAVITY * phase.robot.mass) ** FORCE_POWERS.get(row.unit, 1))
