"""Smoothed dry friction against Coulomb's: a slow joint has less of it than the robot will."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import robotraj as rt
from robotraj.solution.claims.claim import Judgement
from robotraj.witness.checks.friction import STILL, friction_gap
from robotraj.witness.plants.sizes import sizes_of
from tests.lies import axis

FRICTION, SPEED = 4.0, 0.5


def slide(folder: Path, distance: float) -> rt.Solution:
    """A mass of 2 kg with 4 N of dry friction, smoothed below 0.5 m/s, moves a distance [m] in 1 s."""
    robot = axis(folder, mass=2.0, effort=200, speed=50, dynamics=f'<dynamics friction="{FRICTION}"/>')
    robot = replace(robot, friction_speed=SPEED)
    return rt.plan(rt.Phase(robot, 1.0, rt.State(q=[0], v=0), rt.State(q=[distance], v=0), rt.Effort()), check=False)


@pytest.mark.parametrize(("distance", "judgement"), [(20.0, Judgement.HOLDS), (0.05, Judgement.NOT_JUDGED)])
def test_the_model_of_a_slow_joint_is_not_judged(tmp_path: Path, distance: float, judgement: Judgement) -> None:
    report = rt.validate(slide(tmp_path, distance))
    (claim,) = (each for each in report.claims if each.name == "model")
    assert claim.judgement is judgement and report.passed


def test_the_gap_is_the_mean_friction_that_is_missing(tmp_path: Path) -> None:
    """By the trapezoidal rule on the planned speed, apart from the rest at both ends."""
    plan = slide(tmp_path, 1.0)
    gap = friction_gap(plan.phases, sizes_of(plan))
    t = np.linspace(0.0, 1.0, 20001)
    speed = np.abs(plan.at(t).v[:, 0])
    missing = np.where(speed > STILL * speed.max(), FRICTION * (1.0 - np.tanh(speed / SPEED)), 0.0)
    assert gap is not None and gap.joint == "slide"
    assert gap.amount == pytest.approx(np.trapezoid(missing, t), rel=5e-3)


def test_a_robot_without_dry_friction_has_no_such_claim() -> None:
    ends = rt.State(q=[0, 0], v=0), rt.State(q=[0.5, 0], v=0)
    report = rt.validate(rt.plan(rt.Phase(rt.load("cartpole"), 2.0, *ends, rt.Effort())))
    assert "model" not in {claim.name for claim in report.claims}
