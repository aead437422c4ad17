"""Plans with dry friction are those of Coulomb's law: closed forms of one mass, from smooth friction on."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import robotraj as rt
from robotraj.planning.proving import prove, sharp_friction
from robotraj.planning.proving.correction import PlanAttempt
from robotraj.planning.proving.friction_left_out import friction_left_out
from robotraj.solution.proof import FRICTION
from tests.lies import axis

G = 9.81


def mass(folder: Path, friction: float, smooth: float, speed: float, effort: float, way: str) -> rt.Robot:
    """A mass of 2 kg on a slide."""
    dynamics = f'<dynamics friction="{friction}"/>'
    robot = axis(folder, mass=2.0, effort=effort, speed=speed, axis=way, dynamics=dynamics)
    return replace(robot, friction_speed=smooth)


@pytest.mark.parametrize(("friction", "smooth"), [(4.0, 0.05), (8.0, 0.05), (4.0, 0.5)])
def test_the_least_effort_rests_for_as_long_as_coulombs_law_has_it(
    tmp_path: Path, friction: float, smooth: float
) -> None:
    """Moving for S seconds costs F^2 S + 12 m^2 d^2 / S^3, and resting nothing."""
    d, m = 0.2, 2.0
    moving = (36.0 * m**2 * d**2 / friction**2) ** 0.25
    ends = rt.State(q=[0], v=0), rt.State(q=[d], v=0)
    solution = rt.plan(rt.Phase(mass(tmp_path, friction, smooth, 100, 100, "1 0 0"), 2.0, *ends, rt.Effort()))
    assert solution.proof is not None and solution.proof.holds and 0.0 < solution.proof.friction <= FRICTION
    assert solution.objective == pytest.approx(friction**2 * moving + 12.0 * m**2 * d**2 / moving**3, rel=3e-3)
    assert friction_left_out(solution).objective == pytest.approx(solution.proof.friction)
    assert rt.validate(solution).passed


@pytest.mark.parametrize(
    ("friction", "speed", "d"), [(4.0, 3.0, 0.2), (8.0, 3.0, 0.2), (8.0, 0.25, 0.2), (4.0, 100.0, 1)]
)
def test_the_least_time_of_a_lift_is_that_of_coulombs_law(
    tmp_path: Path, friction: float, speed: float, d: float
) -> None:
    """Full force up to the speed at which full force downwards stops it at the end, or the speed limit."""
    robot = mass(tmp_path, friction, min(0.5, max(0.05, speed / 64)), speed, 30.0, "0 0 1")
    up, down = (30.0 - friction) / 2.0 - G, (30.0 + friction) / 2.0 + G
    peak = np.sqrt(2.0 * d / (1.0 / up + 1.0 / down))
    exact = peak / up + peak / down if peak < speed else d / speed + speed / 2.0 / up + speed / 2.0 / down
    solution = rt.plan(rt.Phase(robot, (0.01, 20), rt.State(q=[0], v=0), rt.State(q=[d], v=0), rt.Duration()))
    assert solution.proof is not None and solution.proof.holds
    assert -1e-3 < solution.duration / exact - 1.0 < 3e-3


@pytest.mark.parametrize(("d", "m"), [(1e-3, 0.5), (1e-6, 1e-6)])
def test_friction_of_small_machines_is_coulombs_too(tmp_path: Path, d: float, m: float) -> None:
    """The smooth friction of the file is wider than the speed of the motion, up to a thousand times."""
    acceleration = 4.0 * d / 0.1**2
    friction = 0.5 * m * acceleration
    moving = (36.0 * m**2 * d**2 / friction**2) ** 0.25
    dynamics = f'<dynamics friction="{friction}"/>'
    robot = axis(tmp_path, mass=m, effort=5.0 * m * acceleration, speed=40.0 * d, travel=10.0 * d, dynamics=dynamics)
    ends = rt.State(q=[0], v=0), rt.State(q=[d], v=0)
    solution = rt.plan(rt.Phase(robot, 0.2, *ends, rt.Effort()))
    assert moving < 0.2
    assert solution.objective == pytest.approx(friction**2 * moving + 12.0 * m**2 * d**2 / moving**3, rel=4e-3)


@pytest.mark.parametrize(("follows", "powers"), [(False, [1.0, 0.5, 0.25]), (True, [1.0])])
def test_the_width_falls_by_less_after_a_plan_that_fails_unless_the_machine_follows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, follows: bool, powers: list[float]
) -> None:
    widths: list[float] = []

    def failing(attempt: PlanAttempt, progress: object) -> rt.Solution:
        robot = attempt.problem.phases[0].robot
        assert robot is not None
        widths.append(robot.friction_speed)
        assert isinstance(attempt.guess, rt.Solution)
        return replace(attempt.guess, proof=None)

    monkeypatch.setattr(prove, "_run", failing)
    monkeypatch.setattr(sharp_friction, "deviation_of", lambda found: 0.5 if follows else 2.0)
    ends = rt.State(q=[0], v=0), rt.State(q=[0.2], v=0)
    plan = rt.plan(rt.Phase(mass(tmp_path, 4.0, 0.5, 100, 100, "1 0 0"), 2.0, *ends, rt.Effort()), check=False)
    assert plan.proof is not None and plan.proof.friction > FRICTION
    assert plan.proof.holds == plan.success == follows
    assert ("Coulomb's friction" in str(plan.cause)) == (not follows)
    assert np.array(widths) / 0.5 == pytest.approx(sharp_friction.LEAST ** np.array(powers), rel=1e-5)


@pytest.mark.slow
def test_legs_with_dry_friction_follow_their_plan_by_coulombs_law() -> None:
    """A jump of a hopper against friction that its file smooths over a tenth of its speeds."""
    hopper = rt.load("hopper", root="planar")
    rough = replace(hopper, friction=np.array([0.0, 0.0, 0.0, 1.0, 5.0]))
    effort, foot = rt.Effort(), rt.PointContact("foot", friction=0.8)
    stance = rt.Phase(rough, (0.2, 1.0), rt.State(q={"root_x": 0.0}, v=0), None, effort, contacts=[foot], name="stance")
    flight = rt.Phase(rough, (0.05, 0.6), None, rt.State(q={"root_z": 0.7}), effort, name="flight")
    solution = rt.plan(rt.Problem([stance, flight], [rt.Continuity(0, 1)]))
    assert solution.proof is not None and solution.proof.holds
    widths = [part.phase.robot.friction_speed for part in solution.phases if part.phase.robot is not None]
    assert max(widths) < rough.friction_speed
    assert rt.validate(solution).passed
