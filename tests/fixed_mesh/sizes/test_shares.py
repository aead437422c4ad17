"""Shares of terms and of friction along the plain motion, and settings that follow from them without a jump."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robotraj as rt
from robotraj.fixed_mesh.sizes.shares import shares_of

TIME, MASS = 2.0, 1.0


def slide(objective: rt.objectives.Objective, friction: float = 0.0, way: float = 3.0) -> rt.Problem:
    """Push the block of 1 kg from rest to rest, along a quintic as the plain motion."""
    block = rt.load("block")
    robot = replace(block, friction=np.full(block.nv, friction))
    phase = rt.Phase(robot, TIME, rt.State(q=0, v=0), rt.State(q=way, v=0), objective, limits=None)
    return rt.Problem([phase])


def effort(way: float = 3.0) -> float:
    """Integral of the squared force of a quintic: 120/7 m^2 L^2 / T^3."""
    return 120.0 / 7.0 * (MASS * way) ** 2 / TIME**3


def test_the_share_of_the_ends_is_that_of_closed_forms() -> None:
    for weight in (1e-6, 0.1, 10.0):
        shares = shares_of(slide(rt.Duration() + weight * rt.Effort()))
        assert shares.ends == pytest.approx(TIME / (TIME + weight * effort()), rel=1e-9)


def test_the_share_of_kinks_is_that_of_closed_forms() -> None:
    # Half of the way the block speeds up to 15/8 L/T, and gives as much work back: |P| integrates to m v^2.
    power = MASS * (15.0 / 8.0 * 3.0 / TIME) ** 2
    shares = shares_of(slide(rt.Effort() + 0.5 * rt.objectives.AbsolutePower()))
    assert shares.kinks == pytest.approx(0.5 * power / (0.5 * power + effort()), rel=0.02)


def test_jerks_count_although_a_guess_leaves_them_at_zero() -> None:
    # Integral of the squared jerk of a quintic: 720 L^2 / T^5.
    jerk = 720.0 * 9.0 / TIME**5
    shares = shares_of(slide(rt.Duration() + 0.01 * rt.objectives.Jerk()))
    assert shares.ends == pytest.approx(TIME / (TIME + 0.01 * jerk), rel=1e-5)


def test_objectives_of_one_kind_have_whole_shares() -> None:
    assert (shares_of(slide(rt.Duration())).ends, shares_of(slide(rt.Effort())).ends) == (1.0, 0.0)
    assert shares_of(slide(rt.objectives.AbsolutePower())).kinks == 1.0


def test_friction_is_relative_to_the_torques_and_makes_no_joint_stick_in_least_time() -> None:
    small = shares_of(slide(rt.Effort(), 1e-6)).friction
    assert small == pytest.approx(1e-6 / np.sqrt(effort() / TIME), rel=1e-3)
    least_time = shares_of(slide(rt.Duration(), 1.0))
    assert least_time.rubbing and not least_time.sticking and not shares_of(slide(rt.Duration(), 1e-6)).rubbing
    assert shares_of(slide(rt.Effort(), 1.0)).sticking
    assert not shares_of(slide(rt.Effort(), 1e-6)).sticking
