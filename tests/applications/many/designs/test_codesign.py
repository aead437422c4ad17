"""Designs for several motions end at closed forms and at optima of plans with unknown numbers."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.applications import codesign

ROTOR, LOAD = 2e-4, 0.5


def turntable() -> rt.Robot:
    """A disc of inertia ``LOAD`` [kg m^2] on a vertical axis."""
    model = pin.Model()
    model.name = "turntable"
    axis = model.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), "axis")
    model.appendBodyToJoint(axis, pin.Inertia(1.0, np.zeros(3), LOAD * np.eye(3)), pin.SE3.Identity())
    model.lowerPositionLimit[:], model.upperPositionLimit[:] = -10, 10
    model.upperEffortLimit[:] = model.upperVelocityLimit[:] = 1e30
    return rt.load(model)


TABLE = turntable()


def turns(case: Mapping[str, float]) -> list[rt.Phase]:
    """Two turns, whose motor has the torque tau / n."""
    return [
        rt.Phase(
            TABLE,
            1.0,
            rt.State(q=0, v=0),
            rt.State(q=angle, v=0),
            rt.Lagrange(lambda point: (point.tau[0] / point.p["n"]) ** 2),
            parameters={"n": case["n"]},
            design={"n": rt.design.GearRatio("axis", ROTOR)},
        )
        for angle in (0.5, 1.5)
    ]


def test_the_best_gear_matches_the_inertias_of_rotor_and_load() -> None:
    """The motor's torque is (I n + J / n) a: it is least for every motion at n = sqrt(J / I)."""
    found = codesign(turns, {"n": (10.0, 150.0)}, mesh=rt.Mesh(4), accuracy=1e-9)
    assert found.values["n"] == pytest.approx(np.sqrt(LOAD / ROTOR), rel=1e-2)
    moved = 12.0 * (0.5**2 + 1.5**2)  # of the integral of a^2 over one second
    assert found.objective == pytest.approx((2.0 * np.sqrt(LOAD * ROTOR)) ** 2 * moved, rel=1e-4)
    assert found.converged and not found.at_bounds and len(found.solutions) == 2


def test_a_best_gear_outside_the_range_ends_at_its_bound() -> None:
    found = codesign(turns, {"n": (10.0, 30.0)}, start={"n": 15.0}, mesh=rt.Mesh(4))
    assert found.at_bounds == ("n",) and found.gradient["n"] < 0.0 and "bound" in str(found)


ARM = rt.load("two_link_arm")


def reach(length: object, goal: float) -> rt.Phase:
    return rt.Phase(
        ARM,
        6.0,
        rt.State(q=[0.0, 0.3], v=0),
        rt.State(q=[goal, 0.5], v=0),
        rt.Effort(),
        parameters={"length": length},
        design={"length": rt.design.LinkLength("shoulder", along=(1, 0, 0))},
        limits=None,
    )


def test_the_slopes_of_a_design_are_differences_of_its_objectives() -> None:
    def make(case: Mapping[str, float]) -> list[rt.Phase]:
        return [reach(case["length"], goal) for goal in (0.8, 1.2)]

    options = {"mesh": rt.Mesh(10), "solver": rt.InteriorPoint(tolerance=1e-9)}
    found = codesign(make, {"length": (0.9, 1.1)}, most=1, **options)
    at = found.values["length"]

    def planned(length: float) -> float:
        # From the motions of the design: another start may end at another local optimum.
        pairs = zip(make({"length": length}), found.solutions, strict=True)
        return sum(rt.plan(problem, guess=near, **options).objective for problem, near in pairs)

    above, below = planned(at + 1e-3), planned(at - 1e-3)
    assert found.gradient["length"] == pytest.approx((above - below) / 2e-3, rel=1e-4)
    assert found.objective <= found.steps[0][1]


@pytest.mark.parametrize(
    ("numbers", "start", "message"),
    [
        ({}, None, "empty"),
        ({"n": (3.0, 3.0)}, None, "low, high"),
        ({"n": (1.0, 2.0)}, {"n": 3.0}, "within their bounds"),
    ],
)
def test_wrong_ranges_are_named(numbers: dict[str, tuple[float, float]], start: object, message: str) -> None:
    with pytest.raises(rt.InputError, match=message):
        codesign(turns, numbers, start=start)  # type: ignore[arg-type]
