"""Windows of a plan, the local error of an unstable motion, and tracking with the plan's own feedback."""

import numpy as np
import pinocchio as pin
import pytest
import scipy

import robotraj as rt
from robotraj.witness import validate
from robotraj.witness.simulation.local_error import windows_of


def lengths(windows):
    return [round(window[-1].end - window[0].begin, 9) for window in windows]


def test_long_intervals_are_cut_and_short_ones_joined():
    assert lengths(windows_of(np.array([0.0, 1.0]), 0.25)) == [0.25] * 4
    assert lengths(windows_of(np.linspace(0.0, 1.0, 21), 0.1)) == [0.1] * 10
    mixed = windows_of(np.array([0.0, 0.04, 0.08, 0.08, 0.3, 0.34]), 0.1)
    np.testing.assert_allclose(lengths(mixed), [0.08, 0.22 / 3, 0.22 / 3, 0.22 / 3, 0.04], atol=1e-8)
    assert [[span.interval for span in window] for window in mixed] == [[0, 1], [3], [3], [3], [4]]


def pendulum():
    model = pin.Model()
    hinge = model.addJoint(0, pin.JointModelRY(), pin.SE3.Identity(), "hinge")
    model.appendBodyToJoint(hinge, pin.Inertia(1.0, np.array([0.0, 0.0, 0.1]), np.zeros((3, 3))), pin.SE3.Identity())
    return rt.load(model)


@pytest.fixture(scope="module")
def balanced():
    """An inverted pendulum of 10 cm that leans to and fro for 4 s: open loop it multiplies errors by e^40."""
    start, end = rt.State(q=[0.1], v=0), rt.State(q=[-0.1], v=0)
    phase = rt.Phase(pendulum(), 4.0, start, end, rt.Effort(), limits=None)
    return rt.plan(phase, rt.Mesh(60, rt.HermiteSimpson()), check=False)


def test_an_unstable_plan_passes_though_it_drifts(balanced):
    report = validate(balanced)
    assert report.passed, str(report)
    assert report.closed_loop.growth > 1e15 and report.closed_loop.reason is None
    assert report.closed_loop.error.worst.relative < 1e-3
    assert report.drift.worst.largest > 0.1
    with pytest.raises(rt.ValidationFailed, match="Open loop, the simulation drifts"):
        report.check(drift=1e-3)
    assert "grows by a factor" in str(report)


def test_a_torque_that_the_motion_does_not_need_shows_in_tracking(make):
    def still(value):
        return lambda t, k: np.array([value])

    # It rests upright under 3 N m that nothing balances.
    planned = make.plan(
        make.phase(robot=pendulum()), np.linspace(0, 4, 41), 4, q=still(0.0), v=still(0.0), a=still(0.0), tau=still(3.0)
    )
    report = validate(make.solution(planned))
    assert not report.passed
    # It comes to rest where the feedback holds 3 N m and gravity's pull.
    solution = make.solution(planned)
    gain = solution.gains.at(3.0)[0, 0]
    angle = scipy.optimize.brentq(lambda q: gain * q - 3.0 - 0.981 * np.sin(q), 0.0, 2.0)
    assert report.closed_loop.error["q.hinge"].final == pytest.approx(angle, rel=0.05)
    with pytest.raises(rt.ValidationFailed, match="With feedback, the robot leaves the plan: q.hinge"):
        report.check(local=1e9)


def test_the_final_local_error_is_that_of_the_last_window(make):
    """Without a control the block rises by 0.1 m in the last interval but one, and by nothing in the others."""
    block = rt.System(states=["x"], controls=["u"], dynamics=lambda point: [point.u["u"]])
    planned = make.plan(
        make.phase(system=block),
        np.linspace(0, 10, 41),
        x=lambda t, k: 0.1 * np.clip((t - 9.5) / 0.25, 0.0, 1.0),
        u=lambda t, k: 0.0,
        z=lambda t, k: np.zeros(0),
    )
    row = validate(make.solution(planned)).local["x"]
    assert row.final == pytest.approx(0.0, abs=1e-9)
    assert (row.largest, row.time) == (pytest.approx(0.1), 9.75)


@pytest.mark.parametrize("largest", [15e3, 3.0, 1e-3, 1e-6])
def test_an_error_of_a_system_is_relative_to_the_range_of_the_state_in_any_unit(make, largest):
    """The state crosses zero within the window whose error it is, and jumps there by a thousandth."""
    block = rt.System(states=["x"], controls=["u"], dynamics=lambda point: [point.u["u"]])
    planned = make.plan(
        make.phase(system=block),
        np.linspace(0, 10, 41),
        x=lambda t, k: largest * (0.2 * t - 1.0) + (1e-3 * largest if t > 5.0 else 0.0),
        u=lambda t, k: 0.2 * largest,
        z=lambda t, k: np.zeros(0),
    )
    report = validate(make.solution(planned))
    row = report.local["x"]
    assert (row.largest, row.time) == (pytest.approx(1e-3 * largest), pytest.approx(5.25))
    assert row.scale == pytest.approx(2.0 * largest, rel=2e-3)


def test_a_gap_between_phases_is_an_error_at_the_time_of_their_seam(make):
    block = rt.System(states=["x"], controls=["u"], dynamics=lambda point: [point.u["u"]])
    first, second = (
        make.plan(
            make.phase(name, system=block),
            knots,
            x=lambda t, k, place=place: place,
            u=lambda t, k: 0.0,
            z=lambda t, k: np.zeros(0),
        )
        for name, knots, place in (("first", np.linspace(0, 1, 5), 0.2), ("second", np.linspace(1, 2, 5), 0.5))
    )
    row = validate(make.solution(first, second)).local["x"]
    assert (row.largest, row.time, row.phase) == (pytest.approx(0.3), 1.0, "second")
    assert row.final == pytest.approx(0.0, abs=1e-9)


def test_feedback_goes_on_from_the_end_of_a_phase_through_a_jump():
    """The speed doubles between two phases; the state before the jump is that of the last interval's polynomial."""
    hinge = pendulum()
    start, end = rt.State(q=[0.0], v=[0.0]), rt.State(q=[2.0], v=[0.0])
    swing = rt.Phase(hinge, 0.5, start, rt.State(q=[1.0], v=[3.0]), rt.Effort(), limits=None)
    on = rt.Phase(hinge, 0.5, rt.State(v=[6.0]), end, rt.Effort(), limits=None)
    plan = rt.plan(rt.Problem([swing, on], [rt.links.Jump(0, 1, {"v.hinge": 3.0})]), rt.Mesh(6))
    report = validate(plan)
    assert report.closed_loop.reason is None
    assert report.closed_loop.error.worst.relative < 1e-3


def test_the_local_error_falls_with_the_order_of_the_scheme(make):
    model = make.robot([("driven", pin.JointModelRY()), ("free", pin.JointModelRY())], armature=0.1).model
    robot = rt.load(model, actuated=["driven"])
    errors = []
    for count in (10, 20):
        end = rt.State(q={"driven": 1.0})
        phase = rt.Phase(robot, 1.0, rt.State(q=[0.0, 0.0], v=0), end, rt.Effort(), limits=None)
        report = validate(rt.plan(phase, rt.Mesh(count, rt.HermiteSimpson()), check=False))
        errors.append(report.local["q.free"].largest)
    assert np.log2(errors[0] / errors[1]) > 3.0


def test_what_there_was_no_time_for_is_named_and_is_no_pass(balanced):
    report = validate(balanced, time_limit=0.0)
    assert not report.passed and report.local is None and report.drift is None
    (late,) = report.unchecked
    assert "local error" in late and "tracking" in late and "limits and constraints" in late and "0.0 s" in late
    assert "open-loop drift" in report.unseen and "no time for" in str(report)
    with pytest.raises(rt.ValidationFailed, match="Not checked: limits and constraints"):
        report.check()
    assert validate(balanced, time_limit=None).passed
