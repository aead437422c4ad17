"""A kick shorter than the steps of a simulation is seen, by the planner and by the witness."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from tests.lies import elsewhere

DURATION = 3.0


def mass(at: float = 0.0, width: float = 1e-3, speed: float = 0.0) -> rt.System:
    """A mass of 1 kg that is kicked to another speed [m/s] at a time [s] within a width [s]."""

    def rates(point: rt.SystemPoint) -> list[ca.SX]:
        kick = speed / (width * np.sqrt(np.pi)) * ca.exp(-(((point.t - at) / width) ** 2))
        return [point.x["v"], point.u["u"] + kick]

    return rt.System(["x", "v"], ["u"], rates)


def reach(system: rt.System) -> rt.Phase:
    return rt.Phase(system, DURATION, rt.State([0, 0]), rt.State([1, 0]), rt.Effort())


def closed_form(at: float) -> float:
    """The least effort that moves the mass by 1 m less what the kick of 1 m/s does, and takes its speed away."""
    gramian = np.array([[DURATION**3 / 3, DURATION**2 / 2], [DURATION**2 / 2, DURATION]])
    moved = np.array([1 - (DURATION - at), -1.0])
    return float(moved @ np.linalg.solve(gramian, moved))


@pytest.mark.parametrize(("at", "width"), [(1.2345, 2e-4), (0.777, 2e-3)])
def test_a_plan_takes_a_short_kick_into_account(at: float, width: float) -> None:
    plan = rt.plan(reach(mass(at, width, 1.0)), progress=False, check=False)
    assert plan.objective == pytest.approx(closed_form(at), rel=2e-3)
    assert rt.validate(plan).passed


@pytest.mark.parametrize("at", [0.3141, 1.2345, 2.9])
@pytest.mark.parametrize("width", [2e-4, 1e-3])
@pytest.mark.parametrize("speed", [1.0, -0.1])
def test_a_plan_without_the_kick_is_refused(at: float, width: float, speed: float) -> None:
    plan = rt.plan(reach(mass()), progress=False)
    assert rt.validate(plan).passed
    assert not rt.validate(elsewhere(plan, lambda _: reach(mass(at, width, speed)))).passed


def test_a_kick_that_no_mesh_meets_is_not_proved() -> None:
    plan = rt.plan(reach(mass(2.71828, 5e-4, 1.0)), progress=False, check=False)
    right = plan.objective == pytest.approx(closed_form(2.71828), rel=2e-3)
    assert plan.proof is not None and plan.proof.holds == rt.validate(plan).passed == right
