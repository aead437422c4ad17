"""Sensitivities are the derivatives of closed forms, and the differences of optima that were planned again."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import robotraj as rt

BLOCK = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"] / point.p["mass"]])


def move(mass: float = 2.0, duration: float = 1.5, length: float = 1.0) -> rt.Phase:
    """Rest to rest with the least effort: J = 12 m^2 L^2 / T^3."""
    return rt.Phase(
        BLOCK,
        duration=duration,
        start=rt.State([0, 0]),
        end=rt.State([length, 0]),
        parameters={"mass": mass},
        objective=rt.Lagrange(lambda point: point.u["u"] ** 2),
    )


@pytest.mark.parametrize("solver", [rt.InteriorPoint(), rt.Ipopt()])
def test_sensitivities_of_an_effort_are_those_of_its_closed_form(solver: rt.solvers.Solver) -> None:
    mass, duration = 2.0, 1.5
    solution = rt.plan(move(), rt.Mesh(8), solver=solver)
    effort = 12.0 * mass**2 / duration**3
    assert solution.objective == pytest.approx(effort, rel=1e-7)
    assert solution.sensitivity("mass") == pytest.approx(2.0 * effort / mass, rel=1e-6)
    assert solution.sensitivity("duration") == pytest.approx(-3.0 * effort / duration, rel=1e-6)
    assert solution.sensitivity(lambda h: move(length=1.0 + h)) == pytest.approx(2.0 * effort, rel=1e-6)


def test_an_active_limit_has_the_sensitivity_of_least_time() -> None:
    """T = 2 sqrt(L / a): dT/da = -T / (2 a)."""
    start, end = rt.State({"x": 0, "v": 0}), rt.State({"x": 1.0, "v": 0})
    double = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])

    def fastest(limit: float) -> rt.Phase:
        bound = {"u": rt.between(-limit, limit)}
        return rt.Phase(double, (0.1, 9.0), start, end, rt.Duration(), controls=bound)

    solution = rt.plan(fastest(4.0), rt.Mesh(10))
    assert solution.objective == pytest.approx(1.0, rel=1e-5)
    assert solution.sensitivity(lambda h: fastest(4.0 + h)) == pytest.approx(-1.0 / 8.0, rel=1e-4)


def arm(load: float, reach: float = 1.2) -> rt.Phase:
    robot = rt.load("two_link_arm")
    return rt.Phase(
        robot,
        1.5,
        rt.State(q=[0.0, 0.3], v=0),
        rt.State(q=[reach, 0.5], v=0),
        rt.Effort(),
        parameters={"load": load},
        design={"load": rt.design.Payload("tip")},
        limits=robot.limits.with_(effort=40.0, velocity=10.0),
    )


@pytest.mark.parametrize(
    ("by", "again"),
    [("load", lambda h: arm(1.0 + h)), (lambda h: arm(1.0, 1.2 + h), lambda h: arm(1.0, 1.2 + h))],
    ids=["a payload", "a goal"],
)
def test_sensitivities_of_a_robot_are_differences_of_optima(by: object, again: Callable[[float], rt.Phase]) -> None:
    # Rows that are added between the points move with the load, which the sensitivity does not count.
    options = {
        "mesh": rt.Mesh(12),
        "solver": rt.InteriorPoint(tolerance=1e-9),
        "interval_limits": rt.interval_limits.ConstraintGeneration(rounds=0),
    }
    solution = rt.plan(arm(1.0), **options)
    step = 1e-3
    above, below = (rt.plan(again(h), **options).objective for h in (step, -step))
    found = solution.sensitivity(by)  # type: ignore[arg-type]
    assert found == pytest.approx((above - below) / (2 * step), rel=1e-6)
    assert np.isclose(rt.plan(arm(1.0), **options, keep_program=True).sensitivity(by), found, rtol=1e-6)


def test_what_has_no_sensitivity_is_named() -> None:
    solution = rt.plan(move(), rt.Mesh(4))
    with pytest.raises(rt.UnknownName, match=r"fixed number of the problem named 'mas'.*mass"):
        solution.sensitivity("mas")
    held = rt.PathConstraint(lambda point: point.x["v"] * point.x["x"], lower=-9, upper=9)
    with pytest.raises(rt.InputError, match="more than numbers"):
        solution.sensitivity(lambda h: move().with_(constraints=[held]))
    failed = rt.plan(move().with_(controls={"u": rt.between(-1, 1)}), rt.Mesh(4), check=False)
    with pytest.raises(rt.InputError, match="sensitivity"):
        failed.sensitivity("mass")
