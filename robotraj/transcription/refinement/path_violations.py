"""Violations between the collocation points of path rows that depend on more than the state.

Constraint generation treats rows of the state alone, and Bernstein bounds treat bounds of controls.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj.dynamics.contacts.force_measure import FORCE_SAMPLES, GRAVITY, measure
from robotraj.dynamics.rigid_body import InverseRigidBody
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import PhaseRow
from robotraj.transcription.driven_motion import Inputs, PlannedInputs
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.held_forces import HeldForces
from robotraj.transcription.interval_limits.interval_violations import (
    IntervalViolation,
    input_violations,
    variable_violations,
)
from robotraj.transcription.interval_limits.row_values import Expressions

FORCE_PLACES = 0.5 * (1.0 + np.cos(np.linspace(-np.pi, 0.0, FORCE_SAMPLES)))
"""Places of an interval at which forces of held contacts are measured."""


def broken_rows(
    phase: Phase,
    trajectory: PhaseTrajectory,
    inputs: Inputs | None = None,
    alike: Sequence[PhaseTrajectory] = (),
) -> Array:
    """Measure violations of path rows that depend on more than the state, and of bounds of contact forces.

    Limits of held contacts must hold for the planned forces, and for those that ``HeldForces`` solves for.

    Parameters
    ----------
    phase : Phase
    trajectory : PhaseTrajectory
    inputs : Inputs, optional
        Algebraic variables and controls along the motion; by default their polynomials.
    alike : sequence of PhaseTrajectory
        Trajectories of other phases with the same variables.

    Returns
    -------
    ndarray (K,)
        Largest violation on every interval, relative to the size of the row, of contacts to the weight of the robot; 0
        where all rows hold.
    """
    inputs = inputs or PlannedInputs(trajectory)
    held = _rows_of(phase, {f"contact {contact.name}" for contact in phase.bound_contacts if contact.holds})
    excess = np.zeros(len(trajectory.x.values))
    for violation in input_violations(phase, 0, trajectory, inputs, held, alike):
        relative = violation.amount / _size(phase, violation)
        excess[violation.interval] = max(excess[violation.interval], relative)
    if held:
        sizes = np.array([_of_weight(phase, row) for row in held])
        lower, upper = (np.array([getattr(row, side) for row in held]) for side in ("lower", "upper"))
        for forces in (inputs, HeldForces(phase, trajectory, inputs)) if _determined(phase) else (inputs,):
            values = Expressions(phase.rows, held, trajectory, forces).grid(FORCE_PLACES)
            beyond = np.maximum(lower - values, values - upper) / sizes
            excess = np.maximum(excess, beyond.max(axis=(1, 2)))
    return excess


def beyond_limits(
    phase: Phase, trajectory: PhaseTrajectory, inputs: Inputs, alike: Sequence[PhaseTrajectory] = ()
) -> Array:
    """Return the relative excess over limits of controls and accelerations on every interval, (K,)."""
    excess = np.zeros(len(trajectory.x.values))
    for violation in variable_violations(phase, 0, trajectory, inputs, alike):
        excess[violation.interval] = max(excess[violation.interval], violation.relative)
    return excess


def _rows_of(phase: Phase, names: Collection[str]) -> list[PhaseRow]:
    return [row for row in phase.rows.throughout if phase.rows.constraints[row.constraint].name in names]


def _determined(phase: Phase) -> bool:
    """Whether the equations of a phase determine the forces of its contacts: all hold, and have forces of their own."""
    body, dae = phase.body, phase.dae
    if not isinstance(body, InverseRigidBody) or phase.path is not None:
        return False
    sizes = [(len(contact.holds), len(contact.forces)) for contact in body.contacts]
    return all(rows == forces > 0 for rows, forces in sizes) and dae.algebraic[: len(body.algebraic)] == body.algebraic


def _size(phase: Phase, violation: IntervalViolation) -> float:
    contacts = {f"contact {contact.name}" for contact in phase.bound_contacts}
    of_contact = phase.rows.constraints[violation.row.constraint].name in contacts
    return _of_weight(phase, violation.row) if of_contact else violation.size


def _of_weight(phase: Phase, row: PhaseRow) -> float:
    """Return the size of a row of a contact: the weight of the robot, times an arm for a moment."""
    return row.size if phase.robot is None else measure(row.unit, GRAVITY * phase.robot.mass)
