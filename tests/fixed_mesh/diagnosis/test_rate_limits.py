"""Limits of jerks and of rates of torques that must give, with a value that would do."""

from __future__ import annotations

import pytest

import robotraj as rt


def reach(*constraints: rt.constraints.Constraint, duration: float = 1.0) -> rt.Phase:
    robot = rt.load("two_link_arm")
    fast = robot.limits.with_(velocity=20.0, effort=500.0)
    ends = rt.State(q=[0.2, 0.3], v=0), rt.State(q=[1.2, 0.8], v=0)
    return rt.Phase(robot, duration, *ends, rt.Effort(), list(constraints), limits=fast)


def failure(phase: rt.Phase) -> rt.Solution:
    with pytest.raises(rt.NoSolutionFound) as found:
        rt.plan(phase)
    return found.value.solution


def test_the_jerk_that_would_do_is_that_of_the_fastest_joint() -> None:
    """From rest to rest over 1 rad in 1 s, without acceleration at the ends, the least largest jerk is 32 rad/s^3."""
    duration, jerk = failure(reach(rt.constraints.JointJerk(rt.between(-6, 6)))).conflicts
    assert (jerk.name, jerk.unit, abs(jerk.bound)) == ("jerk limit, shoulder", "rad/s^3", 6.0)
    assert abs(jerk.needed) == pytest.approx(32.0, rel=0.1)
    # Jerks fall with the cube of the duration.
    assert duration.name == "duration" and duration.needed == pytest.approx((32 / 6) ** (1 / 3), rel=0.05)


@pytest.mark.slow
def test_the_named_values_do() -> None:
    limits = rt.constraints.JointTorqueRate(rt.between(-3, 3))
    duration, rate = failure(reach(limits)).conflicts
    assert rate.name.startswith("torque rate limit") and rate.unit == "N m/s"
    most = 1.01 * abs(rate.needed)
    assert rt.plan(reach(rt.constraints.JointTorqueRate(rt.between(-most, most)))).success
    assert rt.plan(reach(limits, duration=1.01 * duration.needed)).success


def test_a_limit_of_jerks_is_not_blamed_for_weak_motors() -> None:
    phase = reach(rt.constraints.JointJerk(rt.between(-500, 500)))
    assert phase.robot is not None
    weak = phase.with_(limits=phase.robot.limits.with_(velocity=20.0, effort=1.0))
    names = [conflict.name for conflict in failure(weak).conflicts]
    assert names and all(name.startswith(("effort limit", "duration")) for name in names)


def test_rows_that_must_give_whatever_the_rates_are_named() -> None:
    """Motors too weak for the duration had no cause where rates of their torques were limited too."""
    robot = rt.load("two_link_arm")
    ends = rt.State(q=[0.0, 0.0], v=0), rt.State(q=[1.0, 1.0], v=0)
    slow = rt.constraints.JointTorqueRate(rt.between(-3.0, 3.0))
    phase = rt.Phase(robot, 0.5, *ends, rt.Effort(), limits=robot.limits.with_(effort=0.2), constraints=[slow])
    conflicts = rt.plan(phase, check=False).conflicts
    assert conflicts[0].name == "duration" and conflicts[1].name.startswith("effort limit")


def test_every_phase_names_a_rate_that_would_do() -> None:
    """The value of one phase alone did not suffice where limits of several must give."""

    def problem(first: float, second: float) -> rt.Problem:
        whole = reach()
        limits = [rt.constraints.JointJerk(rt.between(-most, most)) for most in (first, second)]
        there = whole.with_(duration=0.5, end=rt.State(q=[0.7, 0.5], v=0), constraints=[limits[0]], name="there")
        on = whole.with_(duration=0.7, start=None, constraints=[limits[1]], name="on")
        return rt.Problem([there, on], [rt.Continuity(0, 1)])

    rates = [each for each in rt.plan(problem(6, 6), check=False).conflicts if each.name.startswith("jerk limit")]
    assert {each.phase for each in rates} == {"there", "on"}
    needed = {each.phase: 1.01 * abs(each.needed) for each in rates}
    assert rt.plan(problem(needed["there"], needed["on"])).success
