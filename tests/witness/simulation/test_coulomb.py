"""A machine that may stick by Coulomb's law follows a proved plan, and none that smooths friction away."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import robotraj as rt
from robotraj.solution.claims.claim import Judgement
from robotraj.witness.simulation.coulomb import coulomb_drift, dry_impulses
from tests.lies import axis, elsewhere, lying

FRICTION, MASS = 4.0, 2.0


def slide(folder: Path, smooth: float, mesh: rt.Mesh | None = None, distance: float = 0.2) -> rt.Solution:
    """A mass with dry friction, smoothed below ``smooth`` [m/s], moves a distance [m] in 2 s."""
    robot = axis(folder, mass=MASS, effort=200, speed=50, dynamics=f'<dynamics friction="{FRICTION}"/>')
    ends = rt.State(q=[0], v=0), rt.State(q=[distance], v=0)
    return rt.plan(rt.Phase(replace(robot, friction_speed=smooth), 2.0, *ends, rt.Effort()), mesh)


def model(solution: rt.Solution) -> rt.witness.Claim:
    (claim,) = (each for each in rt.validate(solution).claims if each.name == "model")
    return claim


@pytest.mark.parametrize("count", [1, 2, 5])
def test_impulses_obey_coulombs_law(count: int) -> None:
    """p = -most sign(v) where v is not 0, and |p| <= most where it is, from any signs to begin with."""
    rng = np.random.default_rng(count)
    for _ in range(200):
        root = rng.normal(size=(count, count))
        response, free = root @ root.T + 0.1 * np.eye(count), rng.normal(size=count)
        most = rng.uniform(0.01, 1.0, count)
        impulses, sliding = dry_impulses(response, free, most, rng.integers(-1, 2, count).astype(float))
        after = free + response @ impulses
        assert np.all(np.abs(impulses) <= most * (1.0 + 1e-8))
        np.testing.assert_allclose(after[sliding == 0.0], 0.0, atol=1e-9)
        assert np.all(sliding[sliding != 0.0] * after[sliding != 0.0] >= 0.0)
        np.testing.assert_allclose(impulses[sliding != 0.0], (-sliding * most)[sliding != 0.0])


@pytest.mark.parametrize("smooth", [0.05, 0.5])
def test_a_machine_that_sticks_follows_a_proved_plan(tmp_path: Path, smooth: float) -> None:
    claim = model(slide(tmp_path, smooth))
    assert claim.holds and claim.figure is not None and claim.figure < 5e-3


def test_friction_that_is_smoothed_away_is_noticed(tmp_path: Path) -> None:
    """Below 0.5 m/s the plan on a given mesh takes a fraction of the friction, and the machine sticks."""
    claim = model(slide(tmp_path, 0.5, rt.Mesh(40), distance=0.02))
    assert claim.judgement is Judgement.FAILS and "friction_speed" in claim.notes[0]


def followed(plan: rt.Solution, friction: float, step: float = 1e-4) -> float:
    """Return how far a mass that sticks lags behind its plan [m], by explicit Euler steps."""
    times = np.arange(0.0, plan.duration, step)
    planned, gains = plan.at(times), plan.gains.phases[0]
    matrices = [np.interp(times, gains.times, gains.matrices[:, 0, k])[:, None] for k in range(2)]
    q = v = worst = 0.0
    for wanted, speed, torque, stiffness, damping in np.column_stack([planned.q, planned.v, planned.tau, *matrices]):
        push = torque + abs(stiffness) * (wanted - q) + abs(damping) * (speed - v)
        sign = np.sign(v or push)
        after = 0.0 if v == 0.0 and abs(push) <= friction else v + step * (push - sign * friction) / MASS
        v = 0.0 if v * after < 0.0 else after
        q += step * v
        worst = max(worst, abs(wanted - q))
    return worst


def test_friction_of_another_machine_is_noticed(tmp_path: Path) -> None:
    """The mass lags as far behind as explicit steps of the same feedback let it."""
    plan = slide(tmp_path, 0.05)
    rough = elsewhere(plan, lambda phase: replace(phase, subject=replace(phase.robot, friction=[2.0 * FRICTION])))
    rough = lying(rough, tau=lambda t, x: plan.at(t[..., 0]).tau)
    drift = coulomb_drift(rough)
    assert not isinstance(drift, str) and drift is not None
    assert drift.largest("q.") == pytest.approx(followed(plan, 2.0 * FRICTION), rel=0.03)
    assert not model(rough).holds


def test_a_robot_without_dry_friction_has_no_such_claim() -> None:
    ends = rt.State(q=[0, 0], v=0), rt.State(q=[0.5, 0], v=0)
    report = rt.validate(rt.plan(rt.Phase(rt.load("cartpole"), 2.0, *ends, rt.Effort())))
    assert "model" not in {claim.name for claim in report.claims}


def test_legs_that_keep_the_smooth_law_have_a_figure_and_no_claim() -> None:
    """A trot of go1 smooths the friction of its file over 0.47 rad/s; by Coulomb's law its hips stick."""
    robot = rt.load("go1", root="floating")
    claim = model(rt.plan(rt.gait.trot(robot, speed=0.4, duration=0.25), rt.Mesh(6)))
    assert claim.judgement is Judgement.NOT_JUDGED
    assert claim.figure is not None and claim.bound is not None and claim.figure > claim.bound
    assert "hip_joint" in claim.notes[0] and "friction_speed" in claim.notes[0]


@pytest.mark.slow
def test_legs_with_sharp_friction_follow_their_plan_by_coulombs_law() -> None:
    """The deviation falls in proportion to the width of the smooth law."""
    robot = replace(rt.load("go1", root="floating"), friction_speed=0.01)
    drift = coulomb_drift(rt.plan(rt.gait.trot(robot, speed=0.4, duration=0.25), rt.Mesh(12)))
    assert not isinstance(drift, str) and drift is not None
    assert drift.worst.relative < 1e-2
