"""Links of a plan, evaluated at the ends of its phases: a motion whose phases do not join is not a motion."""

from dataclasses import replace

import numpy as np
import pytest

import robotraj as rt
from robotraj.witness.checks.links import link_violations

BLOCK = rt.System(states=["x", "v"], controls=["u"], dynamics=lambda point: [point.x["v"], point.u["u"]])


def move(start, end, **given):
    return rt.Phase(BLOCK, 1.0, rt.State(start), rt.State(end), rt.Lagrange(lambda point: point.u["u"] ** 2), **given)


def planned(phases, links=()):
    return rt.plan(rt.Problem(phases, links), mesh=rt.Mesh(6))


@pytest.fixture(scope="module")
def apart():
    """A block arrives at 1 m at rest and leaves from 1.5 m at 0.5 m/s: nothing joins the phases but time."""
    return planned([move([0, 0], [1, 0], name="there"), move([1.5, 0.5], [0, 0], name="back")])


def linked(solution, *links):
    return replace(solution, problem=rt.Problem(solution.problem.phases, links))


def test_phases_that_do_not_join_fail(apart):
    report = rt.validate(linked(apart, rt.Continuity(0, 1)))
    named = {v.joint: v for v in report.violations if v.name == "continuity"}
    assert not report.passed and set(named) == {"x", "v"}
    assert named["x"].amount == pytest.approx(0.5) and named["v"].amount == pytest.approx(0.5)
    assert named["x"].phase == "there to back" and named["x"].time == pytest.approx(1.0)
    with pytest.raises(rt.ValidationFailed, match="continuity, [xv], t = 1 s: 0.5 off the required 0"):
        report.check()


def test_the_same_phases_without_that_link_hold(apart):
    assert link_violations(apart) == ()


def test_a_jump_holds_where_it_is_as_large_as_allowed(apart):
    allowed = linked(apart, rt.links.Jump(0, 1, {"x": rt.between(0.4, 0.6), "v": 0.5}))
    assert link_violations(allowed) == ()
    (found,) = link_violations(linked(apart, rt.links.Jump(0, 1, {"x": rt.between(0.6, 0.8), "v": None})))
    assert found.side == "under" and found.limit == pytest.approx(0.6) and found.amount == pytest.approx(0.1)


def test_a_motion_that_does_not_repeat_fails(apart):
    found = link_violations(linked(apart, rt.Periodic({"x": 1.0}, first=0, last=0)))
    assert found == ()
    (found,) = link_violations(linked(apart, rt.Periodic(first=0, last=0)))
    assert (found.name, found.joint, found.phase) == ("periodic", "x", "there to there")


def test_a_mirrored_motion_is_seen_in_the_mirror(apart):
    mirror = rt.Mirror(negated=["x"], displacement={"x": None, "v": rt.between(-1, 1)}, first=1, last=0)
    assert link_violations(linked(apart, mirror)) == ()
    strict = rt.Mirror(displacement={"x": None}, first=1, last=0)
    (found,) = link_violations(linked(apart, strict))
    assert (found.name, found.joint) == ("mirror", "v") and found.amount == pytest.approx(0.5)


def test_rows_of_a_user_are_evaluated_on_numbers(apart):
    link = rt.links.Linkage((0, 1), lambda there, back: [back.start.x["x"] - 2 * there.end.x["x"]], name="twice as far")
    (found,) = link_violations(linked(apart, link))
    assert found.name == "twice as far" and found.amount == pytest.approx(0.5)


def test_a_touchdown_whose_step_is_longer_than_planned_fails():
    robot = rt.load("compass_walker", root="planar")
    foot = rt.PointContact("left_foot", friction=0.8, ground=rt.terrain.Slope(-0.05))
    names = robot.position_names
    start = dict.fromkeys((f"q.{name}" for name in names), 0.0)
    assert start
    stance = rt.Phase(robot, 0.3, contacts=[foot], limits=None, name="stance")
    solution = rt.plan(stance, mesh=rt.Mesh(3), check=False)
    place = solution.at(solution.duration).q - solution.at(0.0).q
    repeat = rt.Periodic({f"q.{name}": float(gain) for name, gain in zip(names, place, strict=True)})
    closed = replace(
        solution,
        problem=rt.Problem([stance], [rt.Touchdown(0, 0, repeat=repeat)]),
        impulses=({"impulse.left_foot.x": 0.0, "impulse.left_foot.y": 0.0, "impulse.left_foot.z": 0.0},),
    )
    assert link_violations(closed) == ()
    longer = rt.Periodic({**repeat.displacement, f"q.{names[0]}": float(place[0]) + 0.1})
    problem = rt.Problem([stance], [rt.Touchdown(0, 0, repeat=longer)])
    (found,) = link_violations(replace(closed, problem=problem))
    assert (found.name, found.joint) == ("continuity", f"q.{names[0]}") and np.isclose(found.amount, 0.1)


def test_an_integral_over_time_is_exact():
    """The integral of t^2 over one second is 1/3, by 1/30 above the limit; the block's motion is of no matter."""
    limit = rt.constraints.IntegralConstraint(lambda point: point.t**2, upper=0.3, name="late")
    phase = move([0, 0], [1, 0], constraints=[limit])
    report = rt.validate(rt.plan(phase, mesh=rt.Mesh(6), check=False))
    (found,) = (violation for violation in report.violations if violation.name == "late")
    assert found.amount == pytest.approx(1 / 3 - 0.3, rel=1e-9)
