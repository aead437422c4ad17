"""Path rows between the collocation points, relative to what they are measured by."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

import robotraj as rt
from robotraj.transcription.refinement.path_violations import broken_rows
from robotraj.witness.contacts.slip_and_friction import holding_of, part_of


def test_power_between_the_points_is_seen() -> None:
    """On two intervals a power limit holds at the points alone."""
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    power = rt.PathConstraint(lambda point: point.x["v"] * point.u["u"], upper=20.0, name="power", unit="W")
    phase = rt.Phase(block, 2.0, rt.State([0, 0]), rt.State([10, 0]), rt.Effort(), constraints=[power])
    part = rt.plan(phase, rt.Mesh(2)).phases[0]
    times = np.linspace(0, 2, 4001)
    sample = part.at(times)
    most = float(np.max(sample.x["v"] * sample.u["u"]))
    assert most > 20.1
    assert broken_rows(phase, part.trajectory).max() == pytest.approx((most - 20) / 20, rel=1e-2)


def test_forces_of_contacts_are_measured_by_the_weight() -> None:
    robot = rt.load("five_link", root="planar")
    foot = rt.PointContact("left_foot", friction=2.0)
    step = rt.gait.walk(robot, step_length=0.5, duration=0.7, contact=foot, clearance=0.1, upright=None)
    solution = rt.plan(step, rt.Mesh(8))
    part = solution.phases[0]
    lightest = rt.PointContact("left_foot", friction=2.0, normal_force=(300.0, np.inf))
    asked = part.phase.with_(contacts=[lightest])
    (held,) = holding_of(part, 25)
    shortest = 300 - min(part.at(part.points).forces["left_foot"][:, 2])
    excess = broken_rows(asked, part.trajectory, part.inputs).max()
    assert not held.planned and not held.solved
    assert excess >= shortest / (9.81 * robot.mass)
    assert excess == pytest.approx(shortest / (9.81 * robot.mass), rel=0.05)


def test_forces_that_hold_contacts_are_measured_as_the_witness_does() -> None:
    """On three intervals the accelerations move the feet a little: the forces that stop this pull at the ground."""
    robot = rt.load("five_link", root="planar")
    foot = partial(rt.PointContact, friction=0.3)
    solution = rt.plan(rt.gait.steps(robot, [{"left_foot": (-0.148,)}], contact=foot), rt.Mesh(3))
    part = solution.phases[-1]
    found = [(part_of(v, held.weight), v) for held in holding_of(part, 25) for v in (*held.planned, *held.solved)]
    worst = max(size for size, _ in found)
    assert worst > 0.1
    assert broken_rows(part.phase, part.trajectory, part.inputs).max() == pytest.approx(worst, rel=1e-6)
