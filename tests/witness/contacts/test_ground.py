"""Feet below the ground and false contact forces are noticed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.dynamics.variable import Named
from robotraj.solution.phase_solution import PhaseSolution
from tests.lies import lying


@pytest.fixture(scope="module")
def hopper() -> rt.Robot:
    return rt.load("hopper", root="planar")


def flight(hopper: rt.Robot, *constraints: Any) -> rt.Solution:
    """A foot starts 0.1 m below the ground, rises, and lands from below."""
    q = {"root_x": 0.0, "root_z": 0.4, "root_pitch": 0.0, "hip": 0.0, "leg": 0.5}
    start = rt.State(q=q, v={"root_x": 0, "root_z": 1.0, "root_pitch": 0})
    fly = rt.Phase(hopper, (0.05, 0.3), start, None, rt.Effort(), constraints, name="flight")
    stance = rt.Phase(
        hopper, (0.2, 1.0), None, rt.State(v=0), rt.Effort(), contacts=[rt.PointContact("foot")], name="stance"
    )
    return rt.plan(rt.Problem([fly, stance], [rt.Touchdown(0, 1)]), rt.Mesh(8), progress=False)


def test_a_foot_that_rises_through_the_ground_is_noticed(hopper: rt.Robot) -> None:
    allowed = flight(hopper, rt.GroundClearance("foot", None))
    first, second = allowed.phases
    bare = replace(
        allowed, phases=(PhaseSolution(first.phase.with_(constraints=[]), first.mesh, first.trajectory), second)
    )
    report = rt.validate(bare)
    (swing,) = report.swings
    assert swing.depth == pytest.approx(0.1) and swing.time == 0.0
    assert not report.passed
    assert any("below the ground" in sentence for sentence in report.failures(report.tolerances))
    report = rt.validate(allowed)
    assert report.passed and report.swings[0].free
    assert "not judged: foot may pass through the ground" in str(report)


def test_a_touchdown_from_below_is_noticed(hopper: rt.Robot) -> None:
    allowed = flight(hopper, rt.GroundClearance("foot", None))
    first, second = allowed.phases
    end = first.at(first.duration)
    point = rt.witness.NumericPoint(hopper, 0.0, end.q, end.v, end.a, end.tau)
    rise = max(float(point.frame("foot").velocity[2]), 0.0)
    assert rt.validate(allowed).swings[0].rise == pytest.approx(rise, abs=1e-9)


BOX, SLOPE = rt.terrain.Flat(0.15), rt.terrain.Slope(0.2, level=-0.1)


@pytest.mark.slow
@pytest.mark.parametrize("onto", [BOX, SLOPE])
def test_between_several_grounds_the_lowest_counts(hopper: rt.Robot, onto: rt.terrain.Ground) -> None:
    """A foot on the floor is below the top of the box onto which it jumps, and no link is below both."""
    floor = rt.terrain.Flat(0.0)

    def standing(ground: rt.terrain.Ground, where: float, **ends: Any) -> rt.Phase:
        foot = rt.PointContact("foot", friction=0.8, ground=ground)
        return rt.Phase(hopper, (0.2, 1.0), objective=rt.Effort(), contacts=[foot], name=f"at {where}", **ends)

    phases = [
        standing(floor, 0.0, start=rt.State(q={"root_x": 0.0}, v=0)),
        rt.Phase(hopper, (0.05, 0.8), objective=rt.Effort(), name="flight"),
        standing(onto, 0.6, end=rt.State(q={"root_x": 0.6}, v=0)),
    ]
    solution = rt.plan(rt.Problem(phases, [rt.links.Liftoff(0, 1), rt.Touchdown(1, 2)]), progress=False)
    report = rt.validate(solution)
    assert solution.proof is not None and solution.proof.holds and report.passed
    assert {each.link for each in report.link_depths} >= {"body", "rod"}
    first, last = solution.phases[1].knots[[0, -1]]
    down = 0.3 * np.array([name == "root_z" for name in hopper.position_names])
    report = rt.validate(lying(solution, q=lambda t, q: q - down * ((t > first) & (t < last))))
    assert max(each.depth for each in report.link_depths) > 0.1
    assert any("below the ground" in each for each in report.failures(report.tolerances))


def changed(solution: rt.Solution, factor: Callable[[str], float]) -> rt.Solution:
    """Return a solution whose contact forces are multiplied, by name."""

    class Changed(PhaseSolution):
        def at(self, t: Any, interval: Any = None) -> Any:
            sample = super().at(t, interval=interval)
            values = [np.asarray(sample.z[name]) * factor(name) for name in sample.z]
            return replace(sample, z=Named("algebraic variable", list(sample.z), values))

    return replace(solution, phases=tuple(Changed(p.phase, p.mesh, p.trajectory) for p in solution.phases))


@pytest.mark.parametrize("factor", [0.0, 0.5, 0.9, 1.1, -1.0])
def test_contact_forces_that_do_not_balance_the_motion_are_noticed(hopper: rt.Robot, factor: float) -> None:
    stance = rt.Phase(
        hopper,
        (0.2, 1.0),
        rt.State(q={"root_x": 0.0}, v=0),
        None,
        rt.Effort() + rt.Duration(),
        contacts=[rt.PointContact("foot")],
    )
    solution = rt.plan(stance, progress=False)
    assert rt.validate(solution).passed
    report = rt.validate(changed(solution, lambda name: factor if name.startswith("force.") else 1.0))
    assert not report.passed
    assert report.holdings[0].force_error == pytest.approx(abs(1.0 - factor), rel=1e-3)


def test_of_feet_that_share_a_load_the_forces_that_the_equations_determine_are_judged() -> None:
    robot = rt.load("five_link", root="planar")
    feet = [rt.PointContact(foot) for foot in ("left_foot", "right_foot")]
    q = dict(zip(robot.position_names, rt.gait.stand(robot), strict=True))
    sway = rt.Phase(robot, 0.4, rt.State(q=q, v=0), rt.State(v=0), rt.Effort(), contacts=feet)
    solution = rt.plan(sway, rt.Mesh(6), progress=False)
    assert rt.validate(solution).passed
    assert not rt.validate(changed(solution, lambda name: 0.8 if name == "force.left_foot.z" else 1.0)).passed
