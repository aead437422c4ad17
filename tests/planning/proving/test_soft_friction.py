"""Which problems are solved with softer friction first, and what is softened."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.dynamics.motors_and_friction import dry_friction
from robotraj.fixed_mesh.sizes.shares import shares_of
from robotraj.planning.proving.soft_friction import averaging_times, nearer, softened, softening_of
from robotraj.transcription.shooting.explicit_dynamics import explicit


def problem(name: str, objective: rt.objectives.Objective) -> rt.Problem:
    fixed = name in ("z1", "ur5")
    robot = rt.load(name, root="fixed" if fixed else "floating")
    end = rt.State(v=0) if fixed else rt.State(v={each: 0 for each in robot.actuated})
    return rt.Problem([rt.Phase(robot, 1.0, rt.State(q=robot.neutral, v=0), end, objective)])


@pytest.mark.parametrize(
    ("name", "objective", "needed"),
    [
        ("z1", rt.Effort(), True),
        ("z1", rt.Duration(), False),
        ("ur5", rt.Effort(), False),
        ("go1", rt.Effort(), False),
        ("solo12", rt.Effort(), False),
    ],
)
def test_integrals_over_motions_with_dry_friction_need_it(
    name: str, objective: rt.objectives.Objective, needed: bool
) -> None:
    assert shares_of(problem(name, objective)).sticking is needed


@pytest.mark.parametrize("dynamics", [rt.dynamics.InverseDynamics(), rt.dynamics.ForwardDynamics()])
def test_only_the_curve_of_friction_is_changed(
    dynamics: rt.dynamics.InverseDynamics | rt.dynamics.ForwardDynamics,
) -> None:
    (phase,) = problem("z1", rt.Effort()).phases
    given = rt.Problem([phase.with_(dynamics=dynamics)])
    (soft,), (hard,) = (each.phases for each in (softened(given, 10.0, [0.02]), given))
    assert soft.robot is hard.robot
    assert soft.with_(dynamics=dynamics).duration_bounds == hard.duration_bounds
    assert soft.dynamics.softening == 10.0
    assert getattr(soft.dynamics, "averaging", 0.02) == 0.02


def test_one_step_schemes_have_the_same_soft_friction() -> None:
    """Their forward dynamics were those of the robot's own friction."""
    soft = softened(problem("z1", rt.Effort()), 10.0, [0.02])
    (phase,) = explicit(soft, [rt.Mesh(5, rt.schemes.MultipleShooting())]).phases
    assert phase.dynamics == rt.dynamics.ForwardDynamics(10.0)


def test_after_a_failed_step_a_nearer_factor_is_halfway_in_its_logarithm() -> None:
    arm = rt.load("two_link_arm")
    ends = rt.State(q=[0, 0], v=0), rt.State(q=[0.5, 0.2], v=0)
    phase = rt.Phase(replace(arm, friction=[0.1, 0.1]), 4.0, *ends, rt.Effort())
    solved = rt.plan(phase.with_(dynamics=rt.dynamics.InverseDynamics(8.0)), rt.Mesh(5))
    assert nearer(2.0, solved) == pytest.approx(4.0)
    assert nearer(6.0, solved) is None
    assert nearer(2.0, rt.plan(phase, rt.Mesh(5))) is None
    assert nearer(2.0, None) is None


@pytest.mark.parametrize("objective", [rt.Duration(), rt.Effort()])
def test_a_given_path_needs_no_softer_friction(objective: rt.objectives.Objective) -> None:
    """It determines where joints reverse. Plans on paths with dry friction ended with an IndexError."""
    robot = rt.load("z1")
    bend = np.array([0.0, 0.4, -0.3, 0.2, 0.1, 0.0, -0.2])
    places = robot.neutral + np.array([[0.0], [1.0], [0.3]]) * bend
    rows = [rt.constraints.FollowPath(rt.applications.as_path(places))]
    limits = robot.limits.with_(position=np.inf)
    phase = rt.Phase(robot, (0.1, 10.0), objective=objective, constraints=rows, limits=limits, self_collision=False)
    assert softening_of(rt.Problem([phase])) == ()
    solution = rt.plan(phase)
    assert solution.proof is not None and solution.proof.holds


@pytest.mark.parametrize("softening", [4.0, 1.0, 0.999, 0.4, 1e-3])
@pytest.mark.parametrize("speed", [-3.0, -0.05, 0.0, 0.02, 1.0])
def test_soft_friction_is_the_curve_of_the_docstring(speed: float, softening: float) -> None:
    """It is algebraic from 1 on, and becomes the hyperbolic tangent below."""
    robot = rt.load("z1")
    zero = np.zeros(robot.nv)
    motion = [np.array(robot.neutral), np.full(robot.nv, speed), zero]

    def balance(softening: float) -> np.ndarray:
        body = rt.dynamics.InverseDynamics(softening).of(robot)
        x, z, u = ca.SX.sym("x", 2 * robot.nv), ca.SX.sym("z", robot.nv), ca.SX.sym("u", robot.nv)
        point = body.point(ca.SX(0), x, z, u, ca.SX(0, 1), ())
        residual = ca.Function("residual", [x, z, u], [body.residual(point)])
        return np.array(residual(np.append(motion[0], motion[1]), motion[2], zero)).ravel()

    frictionless = balance(0.0) - robot.friction * np.tanh(speed / robot.friction_speed)
    relative = speed / robot.friction_speed
    share = np.tanh(np.arcsinh(softening * relative) / softening)
    if softening >= 1.0:
        share = relative / np.hypot(relative, softening)
    if softening == 1e-3:
        assert share == pytest.approx(np.tanh(relative), abs=1e-4)
    np.testing.assert_allclose(balance(softening), frictionless + robot.friction * share, atol=1e-12)


@pytest.mark.parametrize("softening", [0.9, 0.5])
def test_averaged_friction_below_one_is_wider_and_the_same_where_speeds_are_steady(softening: float) -> None:
    speed, change = ca.SX.sym("speed", 7), ca.SX.sym("change", 7)
    robot = rt.load("z1")
    friction = ca.Function("friction", [speed, change], [dry_friction(robot, speed, softening, change)])
    still = ca.Function("still", [speed], [dry_friction(robot, speed, softening)])
    speeds = 0.02 * np.linspace(-1.0, 1.0, 7)
    np.testing.assert_allclose(np.array(friction(speeds, np.zeros(7))), np.array(still(speeds)), atol=1e-12)
    averaged, own = np.abs(np.array(friction(speeds, np.full(7, 0.05)))), np.abs(np.array(still(speeds)))
    assert np.all(averaged <= own) and np.all((averaged < own)[own > 0.0])


@pytest.mark.parametrize(("speed", "acceleration"), [(0.0, 2.0), (0.3, 0.0), (0.3, -5.0), (-0.1, 20.0)])
def test_averaged_friction_is_the_mean_over_a_time(speed: float, acceleration: float) -> None:
    robot, time, softening = rt.load("z1"), 0.02, 1.2
    x, z, u = ca.SX.sym("x", 2 * robot.nv), ca.SX.sym("z", robot.nv), ca.SX.sym("u", robot.nv)
    at = np.append(robot.neutral, np.full(robot.nv, speed)), np.full(robot.nv, acceleration), np.zeros(robot.nv)

    def balance(averaging: float) -> np.ndarray:
        body = rt.dynamics.InverseDynamics(softening, averaging).of(robot)
        residual = body.residual(body.point(ca.SX(0), x, z, u, ca.SX(0, 1), ()))
        return np.array(ca.Function("residual", [x, z, u], [residual])(*at)).ravel()

    width = softening * robot.friction_speed
    speeds = speed + acceleration * np.linspace(-time, time, 20001)
    mean = np.trapezoid(speeds / np.hypot(speeds, width), dx=1e-4 / 2)
    expected = robot.friction * (mean - speed / np.hypot(speed, width))
    np.testing.assert_allclose(balance(time) - balance(0.0), expected, atol=1e-6)


def test_a_free_duration_is_that_of_the_last_solution() -> None:
    given, meshes = problem("z1", rt.Effort()), (rt.Mesh(20),)
    free = rt.Problem([given.phases[0].with_(duration=(0.5, 20.0))])
    assert averaging_times(given, meshes, None) == pytest.approx((0.1 * 1.0 / 20,))
    assert averaging_times(free, meshes, None) == (0.0,)


@pytest.mark.parametrize("averaging", [-1.0, np.inf, "long"])
def test_other_times_are_refused(averaging: object) -> None:
    with pytest.raises(rt.InputError, match="averaging"):
        rt.dynamics.InverseDynamics(1.2, averaging)


@pytest.mark.parametrize("softening", [-1.0, np.inf, np.nan, "soft"])
def test_other_softenings_are_refused(softening: object) -> None:
    for form in (rt.dynamics.InverseDynamics, rt.dynamics.ForwardDynamics):
        with pytest.raises(rt.InputError, match="softening"):
            form(softening)


def test_rates_of_torque_balances_have_the_same_friction() -> None:
    robot = rt.load("xarm7")
    start, end = (0, -0.5, 0, 0.8, 0, 1.2, 0), (1.2, 0.3, -0.6, 1.6, 0.5, 0.6, 0.8)
    soft = rt.dynamics.InverseDynamics(softening=10.0)
    phase = rt.Phase(robot, 1.5, rt.State(q=start, v=0), rt.State(q=end, v=0), rt.objectives.Jerk(), dynamics=soft)
    solver = rt.InteriorPoint(tolerance=1e-6, max_iterations=100, fallback=None)
    assert rt.plan(phase, rt.Mesh(20, rt.HermiteSimpson()), solver=solver, check=False).success


@pytest.mark.slow
def test_trots_with_dry_friction_take_few_iterations() -> None:
    robot = rt.load("go1", root="floating")
    feet = tuple(name for name in rt.gait.limb_ends(robot) if name.endswith("foot"))
    trots = [
        rt.plan(rt.gait.trot(robot, feet=feet, duration=0.3, speed=speed, clearance=0.018), check=False)
        for speed in (0.18, 0.2, 0.25)
    ]
    assert all(solution.success for solution in trots)
    assert sum(solution.iterations for solution in trots) <= 150
