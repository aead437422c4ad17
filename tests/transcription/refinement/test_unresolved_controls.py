"""What the controls' highest degree contributes to the objective."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj.transcription.driven_motion import PlannedInputs
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.refinement.unresolved_controls import unresolved

SITES = np.array([0.0, 0.5, 1.0])
BREAKS = np.array([0.0, 1.0, 3.0])


def block(objective: rt.objectives.Objective) -> rt.Phase:
    return rt.Phase(rt.System(["x"], ["u"], lambda point: [point.u["u"]]), 3.0, objective=objective)


def of(phase: rt.Phase) -> np.ndarray:
    """Evaluate for u = 2 + s on the first interval and u = 1 + 3 P_2(s) on the second, s in [-1, 1]."""
    x, none, u = (
        PiecewisePolynomial(BREAKS, [SITES] * 2, [np.array(values)[:, None][:, :size] for values in each])
        for each, size in (([[0.0] * 3] * 2, 1), ([[0.0] * 3] * 2, 0), ([[1.0, 2.0, 3.0], [4.0, -0.5, 4.0]], 1))
    )
    motion = PhaseTrajectory(0.0, 3.0, x, none, u, BREAKS, {})
    return unresolved(phase, motion, rt.Mesh(2, rt.HermiteSimpson()).schemes, PlannedInputs(motion))


def test_of_the_least_effort_it_is_the_square_of_the_highest_coefficient() -> None:
    """h c^2 / (2 d + 1) with h = 2, c = 3 and d = 2; a line has no second degree."""
    effort = rt.Lagrange(lambda point: point.u["u"] ** 2)
    assert of(block(effort)) == pytest.approx([0.0, 2.0 * 9.0 / 5.0], abs=1e-12)


def test_where_no_control_is_paid_for_there_is_nothing_to_gain() -> None:
    assert not of(block(rt.Lagrange(lambda point: point.x["x"] ** 2))).any()
    assert not of(block(rt.Duration())).any()
