"""Redundant rows are removed; contradicting rows are kept."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from scipy.optimize import least_squares

import robotraj as rt
from robotraj._util.arrays import Array
from robotraj.solvers.stagewise.reduction import reduce
from robotraj.transcription.reuse import transcribed_again
from tests.programs import nlp_of

HEIGHT = 0.3
LEVEL = rt.FramePosition("tool0", {"z": HEIGHT})
MESH = rt.Mesh(12)


@pytest.fixture(scope="module")
def robot() -> rt.Robot:
    return rt.load("ur5")


def reaching(robot: rt.Robot, x: float, y: float) -> Array:
    """Joint positions with the tool at (x, y, HEIGHT)."""
    model, data = robot.model, robot.model.createData()
    frame = model.getFrameId("tool0")

    def missed(q: Array) -> Array:
        pin.framesForwardKinematics(model, data, q)
        return np.asarray(data.oMf[frame].translation - [x, y, HEIGHT])

    found = least_squares(missed, np.array([0.3, -1.2, 1.4, -1.7, -1.57, 0.0]), xtol=1e-15, ftol=1e-15, gtol=1e-15)
    return np.asarray(found.x)


def level(robot: rt.Robot, end: rt.State, *more: rt.constraints.Constraint, **options: object) -> rt.Problem:
    start = rt.State(q=reaching(robot, 0.4, 0.3), v=0)
    settings = {"duration": 1.5, "objective": rt.Effort()} | options
    return rt.Problem([rt.Phase(robot, start=start, end=end, constraints=[LEVEL, *more], **settings)])  # type: ignore[arg-type]


def solve(problem: rt.Problem, solver: rt.solvers.Solver, guess: rt.Solution | None = None) -> rt.Solution:
    return rt.plan(
        problem,
        MESH,
        guess,
        solver=solver,
        interval_limits=rt.interval_limits.ConstraintGeneration(rounds=0),
        check=False,
        progress=False,
    )


def test_rows_of_fixed_columns_are_no_equations(robot: rt.Robot) -> None:
    held = level(robot, rt.State(q=reaching(robot, 0.4, -0.3), v=0))
    program = reduce(nlp_of(held, MESH)).program
    # A stage has the height of its first knot and its rate. The fixed joint positions and the rest at both ends imply
    # them; the first stage has the height's acceleration.
    assert program.equalities.tolist() == [1, *[2] * 11, 12]


@pytest.mark.parametrize("objective", [rt.Effort(), rt.Duration()], ids=["effort", "time"])
def test_a_hand_held_at_a_height_is_planned_as_by_ipopt(robot: rt.Robot, objective: rt.objectives.Objective) -> None:
    duration = 1.5 if isinstance(objective, rt.Effort) else (0.3, 4.0)
    end = rt.State(q=reaching(robot, 0.4, -0.3), v=0)
    problem = level(robot, end, objective=objective, duration=duration)
    staged = solve(problem, rt.InteriorPoint(fallback=None))
    # Least times are flat in accelerations along the equation: from the same one IPOPT finds no better optimum.
    ipopt = solve(problem, rt.Ipopt(), staged)
    assert staged.success
    assert staged.iterations < 200
    assert not staged.violations()
    assert ipopt.objective * (1.0 - 1e-5) < staged.objective < ipopt.objective * (1.0 + 1e-6)


def test_a_goal_that_repeats_the_height_is_one_row(robot: rt.Robot) -> None:
    goal = rt.AtEnd(rt.FramePosition("tool0", [0.1, 0.5, HEIGHT]))
    problem = level(robot, rt.State(v=0), goal)
    program = reduce(nlp_of(problem, MESH)).program
    # Rest, x and y, and one height.
    assert program.equalities.tolist() == [1, *[2] * 11, 9]
    staged = solve(problem, rt.InteriorPoint(fallback=None))
    # There are several ways to take the joints there; from the same one IPOPT finds the same optimum.
    ipopt = solve(problem, rt.Ipopt(), staged)
    assert staged.success
    assert staged.iterations < 200
    assert not staged.violations()
    assert staged.objective == pytest.approx(ipopt.objective, rel=1e-6)


def test_a_goal_at_another_height_stays_a_contradiction(robot: rt.Robot) -> None:
    # Contradictions of FramePosition are refused before a solve.
    z = HEIGHT + 0.01
    goal = rt.AtEnd(
        rt.PathConstraint(
            lambda point: [point.frame("tool0").position[i] for i in range(3)], [0.4, -0.3, z], [0.4, -0.3, z]
        )
    )
    problem = level(robot, rt.State(v=0), goal)
    assert reduce(nlp_of(problem, MESH)).program.equalities[-1] == 10
    solution = solve(problem, rt.InteriorPoint(fallback=None, max_iterations=200))
    assert not solution.success
    assert solution.violations()


def test_another_goal_that_holds_the_row_refreshes_the_program(robot: rt.Robot) -> None:
    problem = level(robot, rt.State(q=reaching(robot, 0.4, -0.3), v=0))
    first = nlp_of(problem, MESH)
    moved = problem.with_(end=rt.State(q=reaching(robot, 0.4, -0.25), v=0))
    other = transcribed_again(first, moved, MESH, None, rt.interval_limits.ConstraintGeneration(), 0.0, first.guess)
    assert other is not None
    refreshed = reduce(first).refreshed(other)
    assert refreshed is not None
    assert refreshed.program.equalities[-1] == 12


def test_a_base_at_rest_needs_no_equation_of_rolling() -> None:
    """s(yaw) . v = 0 holds at v = 0 for every yaw; its gradient is zero there, and the Newton system was singular."""
    mobile = rt.robot.on_wheels(rt.load("two_link_arm"), mass=20.0, inertia=0.8)
    rolling = rt.constraints.DifferentialDrive(radius=0.1, track=0.4, torque=5.0)
    goal = rt.AtEnd(rt.FramePosition("tip", {"x": 2.0, "y": 0.7}))
    move = rt.Phase(mobile, (0.1, 9.0), rt.State(q=0, v=0), rt.State(v=0), rt.Duration(), [rolling, goal], limits=None)
    solution = solve(rt.Problem([move]), rt.InteriorPoint(fallback=None))
    assert solution.success and solution.iterations < 300
    assert not solution.violations()


def test_a_linear_program_without_blocks_is_reduced() -> None:
    system = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]])
    row = rt.PathConstraint(lambda p: p.x["v"] + p.u["u"], upper=10.0, name="slow", unit="m/s")
    ends = rt.State([0, 0]), rt.State([1, 0])
    program = reduce(nlp_of(rt.Problem([rt.Phase(system, 1.0, *ends, constraints=[row])]), MESH)).program
    assert not program.blocks
