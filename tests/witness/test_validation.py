import dataclasses
import math

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest
from scipy.integrate import solve_ivp

from robotraj._util.errors import InputError, ValidationFailed
from robotraj.dynamics.row import Row
from robotraj.problem.constraints.base import BoundConstraint, Where
from robotraj.witness import validate


def test_an_exact_plan_passes(make, swinging):
    report = validate(make.solution(swinging()))
    assert report.passed and report.failure is None and report.violations == ()
    assert report.drift.largest("q.") < 1e-8
    assert report.drift.largest("v.") < 1e-7
    assert max(peak.value for peak in report.residual.dynamics.values()) < 1e-8
    assert max(peak.value for peak in report.residual.rate.values()) < 1e-9
    assert abs(report.energy.imbalance) < 1e-9
    report.check(drift=1e-7, limits=1e-9, energy=1e-9, residual=1e-7)


def test_a_simulated_pendulum_is_confirmed(make):
    # The plan comes from another integrator on the textbook equation, fitted piece by piece.
    robot = make.robot([("hinge", pin.JointModelRY())], damping=0.3)

    def force(t):
        return 2 * np.sin(3 * t)

    def acceleration(t, x):
        return force(t) - 0.3 * x[1] - 9.81 * np.sin(x[0])

    found = solve_ivp(
        lambda t, x: [x[1], acceleration(t, x)], (0, 2), [0.3, 0], method="LSODA", rtol=1e-12, atol=1e-13,
        dense_output=True,
    ).sol  # fmt: skip
    planned = make.plan(
        make.phase(robot=robot),
        np.linspace(0, 2, 41),
        degree=6,
        q=lambda t, k: found(t)[0],
        v=lambda t, k: found(t)[1],
        a=lambda t, k: acceleration(t, found(t)),
        tau=lambda t, k: force(t),
    )
    report = validate(make.solution(planned))
    assert report.drift.largest("q.") < 1e-7
    assert report.energy.relative < 1e-7
    # Damping counts: without it the balance is off by the dissipated energy.
    assert report.energy.dissipated > 0.05


def test_a_wrong_torque_fails_naming_joint_and_time(make, swinging):
    good = swinging()
    tau = good.curves["tau"]
    values = list(tau.values)
    values[15] = values[15] + np.array([0.0, 0.5])
    wrong = dataclasses.replace(good, curves={**good.curves, "tau": dataclasses.replace(tau, values=values)})
    report = validate(make.solution(wrong))
    assert not report.passed
    peak = report.residual.dynamics["elbow"]
    assert peak.value == pytest.approx(0.5, abs=1e-8) and 0.75 <= peak.time <= 0.8
    assert report.residual.dynamics["shoulder"].value < 1e-8
    # 0.5 N m for 0.05 s on the elbow: the drift begins there and is largest at the end.
    assert report.drift["q.elbow"].largest > 1e-3 and report.drift["q.elbow"].time == pytest.approx(1.0, abs=0.2)
    # The local error is there alone.
    assert report.local.worst.largest > 0.01 and report.local.worst.time == pytest.approx(0.7875, abs=0.02)
    with pytest.raises(ValidationFailed, match=r"violates .* misses its end: v\.elbow by 0\.06") as caught:
        report.check()
    with pytest.raises(ValidationFailed, match=r"Open loop, .* drifts from the plan: q\.elbow by 0\.01.* at t = 1 s"):
        report.check(local=1.0, drift=1e-3)
    assert caught.value.report is report
    with pytest.raises(ValidationFailed, match=r"collocation points: elbow by 0\.5 N m at t = 0\.(7[5-9]|8)"):
        report.check(local=1.0, residual=0.1)
    with pytest.raises(ValidationFailed, match=r"torques .* not those of the planned motion: elbow, t = 0\.77"):
        report.check(local=1.0)
    report.check(local=1.0, torques=0.1)


def test_polynomials_that_do_not_meet_at_a_knot_are_reported_as_a_jump(make, swinging):
    good = swinging(name="open")
    q = good.curves["q"]
    apart = [value + (np.array([0.0, 0.02]) if k >= 12 else 0.0) for k, value in enumerate(q.values)]
    wrong = dataclasses.replace(good, curves={**good.curves, "q": dataclasses.replace(q, values=apart)})
    report = validate(make.solution(wrong))
    jump = report.residual.jumps["q.elbow"]
    assert (jump.phase, jump.unit, jump.time) == ("open", "rad", pytest.approx(0.6))
    assert jump.value == pytest.approx(0.02, abs=1e-12)
    assert report.residual.jumps["q.shoulder"].value < 1e-12
    with pytest.raises(ValidationFailed, match=r"jumps at the knot at t = 0\.6 s, q\.elbow by 0\.02 rad"):
        report.check()
    assert report.local["q.elbow"].largest == pytest.approx(0.02, rel=0.05)
    report.check(local=1.0, tracking=1.0, residual=10.0, torques=1.0)
    assert "at a knot: 2.0e-02 rad, q.elbow, t = 0.6 s" in " ".join(str(report).split())


def test_a_velocity_that_is_not_the_rate_of_the_position_is_seen(make, swinging):
    good = swinging()
    q = good.curves["q"]
    bent = [value + np.array([1e-3, 0]) * np.sin(np.pi * q.sites[0])[:, None] for value in q.values]
    wrong = dataclasses.replace(good, curves={**good.curves, "q": dataclasses.replace(q, values=bent)})
    report = validate(make.solution(wrong))
    # The knots are right; between them q' is off by 1e-3 pi / h.
    assert report.residual.rate["shoulder"].value == pytest.approx(1e-3 * np.pi / 0.05, rel=1e-3)
    assert report.residual.rate["elbow"].value < 1e-9


@pytest.mark.parametrize(
    ("kind", "name", "unit", "limit", "joint", "time", "sign"),
    [
        ("position_upper", "position limit", "rad", [0.9, 2.0], "shoulder", np.pi / 4, 1),
        ("velocity", "velocity limit", "rad/s", [9.0, 2.9], "elbow", np.pi / 6, -1),
        ("acceleration", "acceleration limit", "rad/s^2", [3.9, 99.0], "shoulder", np.pi / 4, -1),
    ],
)
def test_a_limit_broken_only_between_knots_is_found(make, swinging, kind, name, unit, limit, joint, time, sign):
    report = validate(make.solution(swinging(name="swing", limits=make.limits(2, **{kind: limit}))))
    (violation,) = report.violations
    peak = {"position_upper": 1.0, "velocity": 3.0, "acceleration": 4.0}[kind]
    bound = limit[0 if joint == "shoulder" else 1]
    assert (violation.name, violation.joint, violation.unit, violation.limit) == (
        name,
        joint,
        unit,
        sign * bound,
    )
    assert violation.amount == pytest.approx(peak - bound, abs=1e-4)
    assert violation.time == pytest.approx(time, abs=0.005)
    with pytest.raises(
        ValidationFailed, match=f"{name}, {joint}, t = .* (over|under) the limit of .* in phase 'swing'"
    ):
        report.check()
    report.check(limits=(peak - bound) / violation.size + 1e-6)


def test_of_several_broken_bounds_the_worst_is_named_and_the_others_counted(make, swinging):
    report = validate(make.solution(swinging(limits=make.limits(2, velocity=[1.9, 2.5]))))
    assert [v.joint for v in report.violations] == ["elbow", "shoulder"]
    with pytest.raises(ValidationFailed, match="velocity limit, elbow, .*, and 1 more; 0.0025 is allowed"):
        report.check()


def test_a_bump_between_two_knots_is_found_though_every_knot_holds(make):
    robot = make.robot([("x", pin.JointModelPX())])
    knots = np.array([0.0, 0.5, 1.0])

    def v(t, k):
        return np.sin(2 * np.pi * t) ** 2 if k == 1 else 0.0 * t

    planned = make.plan(
        make.phase(robot=robot, limits=make.limits(1, velocity=[0.5])),
        knots,
        q=lambda t, k: 0.0 * t,
        v=v,
        a=lambda t, k: 0.0 * t,
        tau=lambda t, k: 0.0 * t,
    )
    assert np.all(np.abs(planned.at(knots).v) < 0.5)
    (violation,) = validate(make.solution(planned)).violations
    assert violation.time == pytest.approx(0.75, abs=0.01)
    assert violation.amount == pytest.approx(0.5, abs=1e-3)


def test_effort_limits_go_by_actuated_joint(make):
    robot = make.robot([("free", pin.JointModelPX()), ("driven", pin.JointModelPY())], actuated=["driven"])
    still = np.zeros(2)
    planned = make.plan(
        make.phase(robot=robot, limits=make.limits(2, effort=[0.0, 1.0])),
        [0.0, 1.0],
        q=lambda t, k: still,
        v=lambda t, k: still,
        a=lambda t, k: still,
        tau=lambda t, k: -1.5,
    )
    (violation,) = validate(make.solution(planned)).violations
    assert (violation.name, violation.joint, violation.unit) == ("effort limit", "driven", "N")
    assert (violation.limit, violation.side) == (-1.0, "under")
    assert violation.amount == pytest.approx(0.5)
    assert "0.5 N under the limit of -1 N" in str(violation)


def test_clearance_between_knots_is_checked_through_the_constraints_own_expression(make, swinging):
    # The tip's height, -cos q0 - cos(q0 + q1), is lowest inside the motion.
    row = Row("ground clearance", "m", -1.25, np.inf, "tip")
    clear = BoundConstraint("ground clearance", (row,), lambda point: [point.frame("tip").position[2]])
    planned = swinging(bound_constraints=(clear,))
    t = np.linspace(0, 1, 20001)
    height = -np.cos(np.sin(2 * t)) - np.cos(np.sin(2 * t) + np.cos(3 * t))
    (violation,) = validate(make.solution(planned)).violations
    assert (violation.name, violation.joint) == ("ground clearance", "tip")
    assert violation.amount == pytest.approx(-1.25 - height.min(), abs=1e-5)
    assert violation.time == pytest.approx(t[height.argmin()], abs=0.005)


def test_constraints_at_one_end_are_checked_there_alone(make, swinging):
    row = Row("square", "rad^2", -np.inf, 0.5)

    def expression(point):
        return [ca.mtimes(point.q.T, point.q)]

    def broken(where):
        constraint = BoundConstraint("square", (row,), expression, where)
        return validate(make.solution(swinging(bound_constraints=(constraint,)))).violations

    assert [(v.time, round(v.amount, 9)) for v in broken(Where.START)] == [(0.0, 0.5)]
    end = np.sin(2) ** 2 + np.cos(3) ** 2
    assert [(v.time, v.amount) for v in broken(Where.END)] == [(1.0, pytest.approx(end - 0.5))]
    assert broken(Where.THROUGHOUT)[0].amount > end - 0.5


def test_states_at_the_ends_are_checked(make, swinging):
    from types import SimpleNamespace

    low = np.array([-np.inf, 0.0, -np.inf, -np.inf])
    wanted = SimpleNamespace(lower=low, upper=np.array([np.inf, 0.0, np.inf, np.inf]))
    violations = validate(make.solution(swinging(end_bounds=wanted))).violations
    assert [(v.name, v.joint, v.time, v.side) for v in violations] == [("end state", "q.elbow", 1.0, "off")]
    assert violations[0].amount == pytest.approx(abs(np.cos(3)))


def test_limits_that_are_also_constraints_are_reported_once(make, swinging):
    row = Row("velocity limit", "rad/s", -2.9, 2.9, "elbow")
    same = BoundConstraint("velocity limit", (row,), lambda point: [point.v[1]])
    planned = swinging(limits=make.limits(2, velocity=[np.inf, 2.9]), bound_constraints=(same,))
    assert len(validate(make.solution(planned)).violations) == 1


def test_an_expression_that_is_no_number_is_named(make, swinging):
    bad = BoundConstraint("power", (Row("power", "W", 0, 1),), lambda point: [ca.SX.sym("x")])
    with pytest.raises(InputError, match="expression of 'power'"):
        validate(make.solution(swinging(bound_constraints=(bad,))))


def bang_bang(make, duration=1.0, push=1.0):
    """The double integrator in minimum time, and plans that push otherwise."""
    robot = make.robot([("slider", pin.JointModelPX())])
    half = duration / 2
    top = half

    def v(t, k):
        return t if k == 0 else duration - t

    def q(t, k):
        return t**2 / 2 if k == 0 else top**2 - (duration - t) ** 2 / 2

    return make.plan(
        make.phase(robot=robot, limits=make.limits(1, effort=[1.0])),
        [0.0, half, duration],
        degree=3,
        q=q,
        v=v,
        a=lambda t, k: 1.0 if k == 0 else -1.0,
        tau=lambda t, k: push if k == 0 else -push,
    )


def test_bang_bang_control_is_exact_to_round_off(make):
    report = validate(make.solution(bang_bang(make)))
    assert report.passed and report.violations == ()
    assert report.drift.largest() < 1e-13
    assert report.energy.work == pytest.approx(0.0, abs=1e-14)


def test_bang_bang_with_a_tenth_less_force_drifts_by_a_tenth_of_the_way(make):
    report = validate(make.solution(bang_bang(make, push=0.9)))
    assert report.drift["q.slider"].final == pytest.approx(0.1 * 0.25, abs=1e-12)
    assert report.drift["v.slider"].largest == pytest.approx(0.05, abs=1e-12)
    assert report.drift["v.slider"].time == pytest.approx(0.5)
    assert report.residual.dynamics["slider"].value == pytest.approx(0.1)
    # 10 % less force does 10 % less work while speeding up, and removes 10 % less while slowing down.
    assert report.energy.worst == pytest.approx(0.1 * 0.5 * 0.25)
    with pytest.raises(ValidationFailed, match="v.slider by 0.005 m/s"):
        report.check()


def test_the_state_runs_on_through_phases_and_a_gap_between_them_is_drift(make):
    robot = make.robot([("x", pin.JointModelPX())])

    def coast(name, begin, gap):
        return make.plan(
            make.phase(robot=robot, name=name),
            [begin, begin + 1.0],
            degree=2,
            q=lambda t, k: t + gap,
            v=lambda t, k: 1.0,
            a=lambda t, k: 0.0,
            tau=lambda t, k: 0.0,
        )

    assert validate(make.solution(coast("one", 0.0, 0.0), coast("two", 1.0, 0.0))).drift.largest() < 1e-12
    report = validate(make.solution(coast("one", 0.0, 0.0), coast("two", 1.0, 0.01)))
    row = report.drift["q.x"]
    assert row.phase == "two" and row.largest == pytest.approx(0.01) and row.final == pytest.approx(0.01)
    assert report.duration == 2.0 and report.intervals == 2
    assert report.local["q.x"].largest == pytest.approx(0.01) and not report.passed


def test_a_plan_with_nan_is_reported_as_failed_not_raised(make):
    robot = make.robot([("x", pin.JointModelPX())])
    zero = {name: (lambda t, k: 0.0) for name in ("q", "v", "a")}
    planned = make.plan(
        make.phase(robot=robot, name="lost", limits=make.limits(1, effort=[1.0])),
        np.linspace(0, 1, 5),
        **zero,
        tau=lambda t, k: math.nan if k == 2 else 0.0,
    )
    report = validate(make.solution(planned))
    assert not report.passed
    assert "phase 'lost', t = 0.5 s" in report.failure
    assert report.drift["q.x"].final == np.inf
    assert report.violations[0].amount == np.inf
    with pytest.raises(ValidationFailed, match=r"stopped early: phase 'lost', t = 0\.5 s"):
        report.check(local=np.inf, drift=1e9, limits=np.inf)
    assert "FAILED" in str(report)


def test_the_report_reads_as_a_table(make, swinging):
    text = str(validate(make.solution(swinging(name="swing", limits=make.limits(2, velocity=[9.0, 2.9])))))
    lines = text.splitlines()
    assert lines[0].startswith("Validation of 'swing': 1 s, 20 intervals") and lines[-1].startswith("FAILED")
    assert any("q.elbow" in line and "rad" in line for line in lines)
    assert any("velocity limit, elbow !" in line and "2.9" in line for line in lines)
    assert any(line.strip().startswith("energy: work") for line in lines)
    assert max(map(len, lines)) <= 80


def test_nothing_to_validate_is_refused(make, swinging):
    with pytest.raises(InputError, match="no phases"):
        validate(make.solution())
    with pytest.raises(InputError, match="samples_per_interval must be a whole number from 2"):
        validate(make.solution(swinging()), samples_per_interval=1)


@pytest.mark.parametrize(
    "given",
    [{"limits": np.nan}, {"limits": None}, {"local": -1.0}, {"rtol": 0.0}, {"atol": np.nan}, {"time_limit": -1}],
)
def test_a_threshold_that_judges_nothing_is_refused(make, swinging, given):
    solution = make.solution(swinging())
    (name,) = given
    with pytest.raises(InputError, match=f"{name} must be a number"):
        validate(solution, **given)


def test_a_robot_of_many_joints_prints_its_worst_rows_only(make):
    joints = [(f"slider{i}", pin.JointModelPX()) for i in range(20)]
    still = np.zeros(20)
    planned = make.plan(
        make.phase(robot=make.robot(joints, armature=1.0)),
        [0.0, 1.0],
        degree=2,
        q=lambda t, k: still,
        v=lambda t, k: still,
        a=lambda t, k: still,
        tau=lambda t, k: 1e-3 * np.arange(20) ** 2,
    )
    text = " ".join((shown := str(validate(make.solution(planned)))).split())
    assert "(the worst 16 of 40)" in text and "(the worst 16 of 20)" in text
    assert "slider19" in text and len(shown.splitlines()) < 110


def test_a_threshold_that_does_not_exist_is_named_with_those_that_do(make, swinging):
    report = validate(make.solution(swinging()))
    with pytest.raises(InputError, match="drif.*drift"):
        report.check(drif=1.0)
