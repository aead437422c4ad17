"""The witness beside the planner itself."""

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest
from scipy.integrate import solve_ivp

import robotraj as rt
from robotraj.problem.constraints.base import symbols_of
from robotraj.witness import NumericPoint, simulate, track, validate


@pytest.fixture
def arm(make):
    """Three joints in space, one of them sliding."""
    joints = [("turn", pin.JointModelRZ()), ("lift", pin.JointModelRY()), ("reach", pin.JointModelPX())]
    return rt.load(make.robot(joints, armature=0.1).model)


def lift(arm, count):
    start, end = rt.State(q=[0.1, 0.5, 0.0], v=0), rt.State(q=[1.0, 1.5, 0.3], v=0)
    phase = rt.Phase(arm, duration=1.0, start=start, end=end, limits=None, objective=rt.Effort(), name="lift")
    return rt.plan(phase, mesh=rt.Mesh(count, rt.HermiteSimpson()))


@pytest.fixture
def passive(arm):
    """The arm with one joint that no motor drives: its torques cannot make any motion exact."""
    return rt.load(arm.model, actuated=["turn", "lift"])


def swing(arm, count):
    start, end = rt.State(q=[0.1, 0.5, 0.0], v=0), rt.State(q={"turn": 1.0, "lift": 1.5}, v={"turn": 0.0, "lift": 0.0})
    phase = rt.Phase(arm, duration=1.0, start=start, end=end, limits=None, objective=rt.Effort(), name="swing")
    return rt.plan(phase, mesh=rt.Mesh(count, rt.HermiteSimpson()))


def test_drift_of_hermite_simpson_falls_by_order_four(passive):
    coarse, fine = (validate(swing(passive, count)) for count in (20, 40))
    assert np.log2(coarse.drift.largest("q.") / fine.drift.largest("q.")) > 3.5
    # The quadrature of the energy is exact: its imbalance is the discretisation error.
    assert abs(fine.energy.imbalance) < abs(coarse.energy.imbalance) / 8


@pytest.mark.slow
def test_a_plan_of_a_stiff_arm_is_simulated_to_its_end():
    """Friction stops z1's gripper within 15 us: explicit steps would take half a minute."""
    arm = rt.load("z1")
    start = np.array([0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -0.5])
    phase = rt.Phase(arm, 1.0, rt.State(q=start, v=0), rt.State(q=start + 0.3, v=0), rt.Effort())
    solution = rt.plan(phase, rt.Mesh(8), check=False, progress=False)
    report = validate(solution)
    assert report.failure is None
    assert report.stiff is not None
    assert "implicit steps" in str(report)
    # The same to what an implicit Runge-Kutta method finds in one interval, from its planned beginning.
    (planned,) = solution.phases
    begin, end = planned.knots[3:5]
    at = planned.at(begin, interval=3)

    def rates(t, x):
        q, v = x[: arm.nq], x[arm.nq :]
        tau = planned.at(min(t, end), interval=3).tau - arm.dissipation(v)
        return np.concatenate([v, pin.aba(arm.model, arm.model.createData(), q, v, tau)])

    exact = solve_ivp(rates, (begin, end), np.concatenate([at.q, at.v]), "Radau", rtol=1e-9, atol=1e-11).y[:, -1]
    own = simulate(arm, at.q, at.v, lambda t, k, q, v: planned.at(t, interval=3).tau, (begin, end))
    np.testing.assert_allclose(np.concatenate([own.q[-1], own.v[-1]]), exact, atol=1e-7)


def test_a_plan_with_other_inertia_is_refused(passive, make):
    solution = swing(passive, 20)
    heavier = pin.Model(passive.model)
    heavier.armature = heavier.armature + 0.02
    other = rt.load(heavier, actuated=["turn", "lift"])
    phase = rt.Phase(other, duration=1.0, limits=None, name="heavier")
    (planned,) = solution.phases
    moved = type(planned)(phase, planned.mesh, planned.trajectory)
    report = validate(make.solution(moved))
    assert not report.passed
    with pytest.raises(rt.ValidationFailed, match="violates the equations of motion"):
        report.check()


def test_feedback_removes_the_drift_of_a_coarse_mesh(arm):
    solution = lift(arm, 10)
    open_loop, held = validate(solution).drift, track(solution, kp=400.0, kd=40.0).error
    joints = [f"q.{joint}" for joint in arm.joint_names]
    assert max(held[name].final for name in joints) < 0.1 * max(open_loop[name].final for name in joints)


def test_the_block_in_minimum_time_keeps_its_end_though_the_corner_is_smeared():
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    phase = rt.Phase(
        block,
        duration=(0.1, 20),
        start=rt.State({"x": 0, "v": 0}),
        end=rt.State({"x": 10, "v": 0}),
        controls={"u": rt.between(-1, 1)},
        objective=rt.Duration(),
    )
    report = validate(rt.plan(phase, mesh=rt.Mesh(20, rt.HermiteSimpson())))
    assert report.failure is None
    assert report.drift["x"].final < 1e-7 and report.drift["v"].final < 1e-7


def test_every_kind_of_constraint_reads_the_same_on_numbers_as_on_symbols(arm):
    pose = pin.SE3(pin.utils.rotate("x", 0.3), np.array([0.1, 0.2, 0.3]))
    phase = rt.Phase(
        arm,
        duration=1.0,
        limits=None,
        parameters={"c": 2.0},
        constraints=[
            rt.GroundClearance("tip", 0.05, ground=rt.terrain.Slope(0.1, 0.2)),
            rt.FramePosition("tip", {"x": rt.between(0, 1), "z": 0.3}),
            rt.FramePose("tip", pose),
            rt.constraints.JointVelocity({"lift": rt.between(-1, 1)}),
            rt.PathConstraint(lambda p: ca.mtimes(p.tau.T, p.v) * p.p["c"], upper=5.0, name="power"),
            rt.PathConstraint(lambda p: [p.com[1], p.momentum[4], p.x["q.lift"] * p.z["a.turn"]], upper=9.0),
            rt.PathConstraint(lambda p: p.frame("tip").acceleration, upper=9.0),
            rt.PathConstraint(lambda p: p.frame("tip").velocity[:3], upper=9.0),
        ],
    )
    symbols = symbols_of(phase.dae, phase.parameter_names)
    random = np.random.default_rng(7)
    q, v, a, tau = random.uniform(-1, 1, (4, 3))
    point = NumericPoint(arm, 0.0, q, v, a, tau, parameters={"c": 2.0}, columns=True)
    columns = [ca.vertcat(symbols.q, symbols.v), symbols.a, symbols.tau, symbols.p["c"]]
    for constraint in phase.bound_constraints:
        rows = ca.vertcat(*constraint.expression(symbols))
        expected = ca.Function("rows", columns, [rows])(np.concatenate([q, v]), a, tau, 2.0)
        found = [float(value) for value in constraint.expression(point)]
        np.testing.assert_allclose(found, np.array(expected).ravel(), atol=1e-12, err_msg=constraint.name)


def test_a_climb_from_sea_level_is_proved_and_validated() -> None:
    """The altitude is 15 km at the end and near zero in the first seconds, where an error of 1 m is small."""

    def flight(p):
        h, v, climb, m, a = p.x["h"], p.x["v"], p.x["climb"], p.x["m"], p.u["a"]
        pressure, r = 0.5 * 1.225 * ca.exp(-h / 8500) * v**2 * 49.2386, 6378145 + h
        thrust, weight = 110e3 * (0.7 * ca.exp(-h / 9000) + 0.3), 3.986004e14 / r**2
        lift, drag = 3.44 * pressure * a, pressure * (0.013 + 0.54 * 3.44 * a**2)
        return [
            v * ca.sin(climb),
            (thrust * ca.cos(a) - drag) / m - weight * ca.sin(climb),
            (thrust * ca.sin(a) + lift) / (m * v) + ca.cos(climb) * (v / r - weight / v),
            -thrust / (1600 * 9.80665),
        ]

    phase = rt.Phase(
        rt.System(["h", "v", "climb", "m"], ["a"], flight),
        (50.0, 1000.0),
        rt.State([100, 135.964, 0, 19030.468]),
        rt.State({"h": 15000, "v": 295, "climb": 0}),
        rt.Duration(),
        controls={"a": rt.between(-0.78, 0.78)},
        states={
            "h": rt.between(0, 21000),
            "v": rt.between(5, 1000),
            "climb": rt.between(-0.7, 0.7),
            "m": rt.between(10000, 20410),
        },
    )
    solution = rt.plan(phase)
    assert solution.duration == pytest.approx(198.3, abs=0.1)
    assert rt.validate(solution).passed
