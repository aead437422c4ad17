"""Poses at rest that a motor cannot hold."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.planning.diagnosis.ends import unheld_ends

A = np.array([-1.1, -1.8, 1.6, -1.2, -1.57, 0.0])
B = np.array([1.1, -0.8, 0.6, -0.6, -0.6, 1.2])


@pytest.fixture(scope="module")
def ur5() -> rt.Robot:
    return rt.load("ur5")


def reach(ur5: rt.Robot, effort: float, **changes: object) -> rt.Problem:
    phase = rt.Phase(
        ur5,
        duration=2.0,
        start=rt.State(q=A, v=0),
        end=rt.State(q=B, v=0),
        limits=ur5.limits.with_(effort={"shoulder_lift_joint": effort}),
    )
    return rt.Problem([phase.with_(**changes)])


def test_the_torque_is_that_of_gravity(ur5: rt.Robot) -> None:
    (entry,) = [e for e in unheld_ends(reach(ur5, 20.0)) if e.end == "end"]
    gravity = pin.computeGeneralizedGravity(ur5.model, ur5.model.createData(), B)
    assert entry.needed == pytest.approx(abs(gravity[1]))
    assert str(entry).startswith("holding the end of 'phase' needs") and "limit is 20" in str(entry)


def test_strong_motors_hold_everything(ur5: rt.Robot) -> None:
    assert not unheld_ends(reach(ur5, 150.0))


def test_ends_that_move_or_are_open_are_not_judged(ur5: rt.Robot) -> None:
    problem = reach(ur5, 20.0, start=rt.State(q=A, v=0.1), end=rt.State(v=0))
    assert not unheld_ends(problem)


def test_a_failed_plan_names_the_motor_that_cannot_hold_its_end(ur5: rt.Robot) -> None:
    solver = rt.Ipopt(max_iterations=3)
    with pytest.raises(
        rt.NoSolutionFound, match="a likely cause: holding the end of 'phase' needs .* shoulder_lift_joint"
    ):
        rt.plan(reach(ur5, 20.0), rt.Mesh(5), solver=solver)
