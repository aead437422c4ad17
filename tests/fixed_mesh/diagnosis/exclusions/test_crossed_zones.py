"""A state takes every value between its ends, so that a row of it alone excludes motions through a zone."""

from __future__ import annotations

from typing import Any

import pytest

import robotraj as rt
from robotraj.fixed_mesh.diagnosis.exclusions.crossed_zones import crossed_zones
from robotraj.solvers.status import Status


def block(keep_out: Any, **changes: Any) -> rt.Phase:
    """Move a mass of 1 kg by 1 m, and keep a function of its point above 0.01."""
    system = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]], units={"x": "m"})
    row = rt.PathConstraint(keep_out, lower=0.01, name="keep out", unit="m^2")
    fields = {"start": rt.State([0, 0]), "end": rt.State([1, 0]), "constraints": [row]} | changes
    return rt.Phase(system, 3.0, objective=rt.Lagrange(lambda p: p.u["u"] ** 2), **fields)


def around(p: Any) -> Any:
    return (p.x["x"] - 0.5) ** 2


@pytest.mark.parametrize("ends", [(0.0, 1.0), (1.0, 0.0), (rt.between(-1, 0.2), rt.between(0.8, 2)), (-3.0, 0.5)])
def test_a_zone_between_the_ends_excludes_every_motion(ends: tuple[Any, Any]) -> None:
    start, end = (rt.State({"x": value}) for value in ends)
    (conflict,) = crossed_zones(rt.Problem([block(around, start=start, end=end)]))
    assert conflict.certain and conflict.name == "keep out" and conflict.bound == 0.01
    assert conflict.needed == pytest.approx(0.0, abs=1e-5)
    assert str(conflict).startswith("keep out: 0.01 m^2 must become") and "x must pass 0.5" in str(conflict)


@pytest.mark.parametrize(
    ("keep_out", "changes"),
    [
        (around, {"end": rt.State({"x": 0.39})}),
        (around, {"end": rt.State({"v": 0.0})}),
        (around, {"start": rt.State({"x": rt.between(0, 0.9)}), "end": rt.State({"x": rt.between(0.1, 1)})}),
        (lambda p: around(p) + p.x["v"] ** 2, {}),
        (lambda p: around(p) + p.u["u"] ** 2, {}),
        (lambda p: around(p) + p.t, {}),
    ],
    ids=["zone behind the end", "free end", "ends that may agree", "two states", "a control", "time"],
)
def test_other_rows_exclude_nothing(keep_out: Any, changes: Any) -> None:
    assert not crossed_zones(rt.Problem([block(keep_out, **changes)]))


def test_the_plan_names_the_zone_that_it_cannot_jump_over() -> None:
    solution = rt.plan(block(around), check=False)
    assert solution.status is Status.INFEASIBLE and solution.cause.startswith("keep out: 0.01 m^2 must become")


def test_a_joint_must_cross_a_zone_too() -> None:
    robot = rt.load("two_link_arm")
    wall = rt.PathConstraint(lambda p: p.q[0] ** 2, lower=0.04, name="wall", unit="rad^2")
    ends = rt.State(q=[0.6, 0.0], v=0), rt.State(q=[-0.6, 0.0], v=0)
    (conflict,) = crossed_zones(rt.Problem([rt.Phase(robot, 2.0, *ends, rt.Effort(), [wall])]))
    assert conflict.certain and "shoulder must pass 0 rad" in conflict.reason
