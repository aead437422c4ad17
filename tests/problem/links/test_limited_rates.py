"""Under limits of rates, accelerations and torques are continuous from phase to phase."""

from dataclasses import replace

import numpy as np
import pytest

import robotraj as rt

JERK = 60.0


def through_the_middle(rows, **options):
    """A block of 1 kg moves 1 m through the middle of its way."""
    block = rt.load("block")
    free = block.limits.with_(velocity=100.0, effort=1e4)
    return rt.Waypoints(block, [[0.0], [0.5], [1.0]], constraints=rows, limits=free, **options)


@pytest.mark.parametrize("row", [rt.constraints.JointJerk(JERK), rt.constraints.JointTorqueRate(JERK)])
def test_a_place_on_the_way_takes_no_time_and_allows_no_jump(row):
    """The motion of least time from rest to rest passes the middle anyway: T = (32 d / J)^(1/3)."""
    found = rt.plan(through_the_middle([row]))
    assert found.duration == pytest.approx((32.0 / JERK) ** (1 / 3), rel=2e-5)
    first, second = found.phases
    for value in ("a", "tau"):
        before, after = getattr(first.at(first.knots[-1]), value), getattr(second.at(second.knots[0]), value)
        assert np.allclose(before, after, atol=1e-6)


def test_rests_have_no_row_since_each_phase_holds_there():
    rows = [rt.constraints.JointJerk(JERK)]
    names = [[row.joint for row in through_the_middle(rows, stop=stop).bound_links[0].rows] for stop in (False, True)]
    assert names == [["time", "q.slider", "v.slider", "a.slider"], ["time", "q.slider", "v.slider"]]


def test_motions_that_repeat_have_no_jump_where_they_begin_again():
    found = rt.plan(through_the_middle([rt.constraints.JointJerk(JERK)], cyclic=True))
    assert np.allclose(found.at(0.0).a, found.at(found.duration).a, atol=1e-6)


def test_speeds_that_repeat_mirrored_have_mirrored_accelerations():
    """A half of a swing to and fro: q(T) = -q(0), v(T) = -v(0), and a(T) = -a(0)."""
    block = rt.load("block")
    half = rt.Phase(block, 1.0, objective=rt.Effort(), constraints=[rt.constraints.JointJerk(JERK)])
    mirror = rt.Problem(half, [rt.links.Mirror(negated=["slider"])]).bound_links[0]
    assert [row.joint for row in mirror.rows] == ["q.slider", "v.slider", "a.slider"]


def test_a_jump_of_the_acceleration_is_noticed():
    """Without the rows of continuity the plan jumps; the same motion is no plan of the problem with them."""
    rows = [rt.constraints.JointJerk(JERK)]
    linked = through_the_middle(rows)
    jumps = rt.Problem(linked.phases, [rt.links.Jump(0, 1, {})])
    found = rt.plan(jumps)
    claimed = rt.plan(linked)
    lie = replace(claimed, phases=found.phases)
    assert any(violation.joint == "a.slider" for violation in rt.validate(lie).violations)
