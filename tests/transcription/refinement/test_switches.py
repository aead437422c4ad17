"""Jumps of bounded rates: found from the polynomials of a plan, and put at knots."""

import numpy as np
import pytest

import robotraj as rt
from robotraj.transcription.refinement.switches import switches, with_knots_at

JERK = 60.0


@pytest.fixture(scope="module")
def phase():
    """A block moves 1 m from rest to rest with a limit of jerk: T = (32 d / J)^(1/3), jumps at T/4 and 3T/4."""
    rows = [rt.constraints.JointJerk(JERK)]
    block = rt.load("block")
    free = block.limits.with_(velocity=100.0, effort=1e4)
    ends = rt.State(q=0.0, v=0.0), rt.State(q=1.0, v=0.0)
    return rt.Phase(block, (0.05, 9.0), *ends, rt.Duration(), rows, limits=free)


def test_jumps_inside_intervals_are_found_and_those_at_knots_are_not(phase):
    for count, wanted in ((10, [0.25, 0.75]), (12, [])):
        part = rt.plan(phase, rt.Mesh(count)).phases[0]
        assert np.allclose(switches(part.phase, part.trajectory), wanted, atol=5e-3)


def test_knots_move_to_the_jumps_and_others_stay():
    mesh = with_knots_at(rt.Mesh(10), np.array([0.25, 0.71, 0.71]))
    assert np.allclose(mesh.knots, [0.0, 0.1, 0.25, 0.3, 0.4, 0.5, 0.6, 0.71, 0.8, 0.9, 1.0])
    same = rt.Mesh(10)
    assert with_knots_at(same, np.array([0.5, 0.3001])) is same


def test_a_plan_takes_the_least_time_of_the_closed_form(phase):
    assert rt.plan(phase).duration == pytest.approx((32.0 / JERK) ** (1 / 3), rel=2e-5)


@pytest.mark.parametrize(
    ("way", "speed", "acceleration", "jerk"),
    [(13.0, 4.0, 5.5, 100.0), (6.482, 3.016, 82.95, 4778.0)],
)
def test_arcs_that_are_as_short_as_the_intervals_get_knots(phase, way, speed, acceleration, jerk):
    """From rest to full speed by full acceleration: T = d / v + v / A + A / J. The jerk is at its limit for A / J."""
    limits = phase.limits.with_(velocity=speed, acceleration=acceleration)
    rows = [rt.constraints.JointJerk(jerk)]
    short = phase.with_(start=rt.State(q=0.0, v=0.0), end=rt.State(q=way, v=0.0), limits=limits, constraints=rows)
    least = way / speed + speed / acceleration + acceleration / jerk
    assert rt.plan(short).duration == pytest.approx(least, rel=2e-5)
