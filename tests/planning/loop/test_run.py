"""Solves of the loop: where each starts, when it ends, and when limits are imposed between the points."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import robotraj as rt
from robotraj.fixed_mesh import at_points
from robotraj.fixed_mesh import solve as one_solve
from robotraj.fixed_mesh.at_points import AtPoints
from robotraj.fixed_mesh.between import limits_between
from robotraj.planning.loop import run as loop
from robotraj.planning.loop.respond import ENOUGH_OF_POWERS
from robotraj.planning.loop.run import NEARLY, is_guess
from robotraj.planning.loop.state import Task, begin
from robotraj.planning.proving.soft_friction import softened
from robotraj.planning.settings import resolve
from robotraj.solution.proof import Goals, Proof
from robotraj.solvers.base import NEARBY_BARRIER
from robotraj.solvers.status import Status


def _damped() -> rt.Phase:
    """Move an arm with much damping in least time under limits of the rates of its torques."""
    arm = replace(rt.load("two_link_arm"), damping=np.full(2, 5.0), friction=np.full(2, 0.5))
    limit = rt.constraints.JointTorqueRate(rt.between(-30, 30))
    ends = rt.State(q=[0, 0], v=0), rt.State(q=[1.0, 0.5], v=0)
    limits = arm.limits.with_(effort=20.0)
    return rt.Phase(arm, (0.05, 10.0), *ends, rt.Duration(), constraints=[limit], limits=limits)


def test_solves_with_lower_limits_on_the_same_mesh_start_from_a_small_barrier(monkeypatch):
    """Limits of rates alternate from mesh to mesh, but not where limits are lowered on the same mesh."""
    barriers: list[tuple[tuple[object, ...], float]] = []
    plain = at_points.solve_nlp

    def recorded(nlp, guess, multipliers, solver, *rest):
        # Sharper friction is another problem.
        speeds = [phase.robot.friction_speed for phase in nlp.problem.phases]
        barriers.append(((*speeds, *(layout.mesh for layout in nlp.layouts)), solver.initial_barrier))
        return plain(nlp, guess, multipliers, solver, *rest)

    for module in (at_points, limits_between):
        monkeypatch.setattr(module, "solve_nlp", recorded)
    assert rt.plan(_damped()).proof.motion_holds
    again = [
        barrier for (before, _), (mesh, barrier) in zip(barriers[:-1], barriers[1:], strict=True) if mesh == before
    ]
    assert again
    assert max(again) <= NEARBY_BARRIER


@pytest.mark.parametrize(("excess", "imposed"), [(0.5, True), (2.0, False)])
def test_limits_between_the_points_wait_for_a_finer_mesh_where_they_are_exceeded_by_more_than_themselves(
    monkeypatch, excess, imposed
):
    phase = _damped()
    mesh = rt.plan(phase, mesh=rt.Mesh(4), check=False)
    settings = replace(mesh.settings, goals=Goals())
    measures = SimpleNamespace(proof=Proof(0.0, excess, 0.0, 0.0, Goals()), growth=1.0)
    answers = []

    def limited(attempt, settings, progress, imposed, lower):
        answers.append(imposed)
        return replace(mesh, status=Status.STALLED)

    monkeypatch.setattr(loop, "measured", lambda *given: measures)
    monkeypatch.setattr(loop, "solved_at_points", lambda *given: AtPoints(None, mesh, None))
    monkeypatch.setattr(loop, "limited_between", limited)
    second = replace(begin(rt.Problem([phase]), None, settings), number=1)
    without = replace(second.traits, full_friction=False)
    loop.solved(replace(second, traits=without))
    assert answers == [imposed]


def reach() -> rt.Problem:
    robot = rt.load("z1", locked={"jointGripper": 0.0})
    ends = rt.State(q=[0, 1.0, -1.0, 0.2, 0, 0], v=0), rt.State(q=[1.2, 1.8, -1.6, -0.6, 0.8, 0.9], v=0)
    return rt.Problem([rt.Phase(robot, 1.5, *ends, rt.Effort())])


def test_solves_end_with_their_rows_met_where_the_objective_hardly_falls() -> None:
    solver, mesh, counts = rt.InteriorPoint(tolerance=1e-6, fallback=None), rt.Mesh(24, rt.schemes.RadauIIA(3)), []
    for duration in (1.2, 1.5, 2.0):
        soft = softened(rt.Problem([reach().phases[0].with_(duration=duration)]), 40.0, [0.1 * duration / 24])
        settings = resolve(soft, {"mesh": mesh, "solver": solver})
        whole = one_solve.solve(soft, None, settings)
        early = one_solve.solve(soft, None, replace(settings, solver=solver.until_settled(Goals().objective)))
        assert early.status is Status.SOLVED
        assert 8 <= early.iterations <= whole.iterations
        assert abs(early.objective - whole.objective) < 20 * Goals().objective * whole.objective
        counts.append((early.iterations, whole.iterations))
    # A single solve may end at the same iteration, as its last ones may gain much.
    assert np.sum(counts, axis=0)[0] < np.sum(counts, axis=0)[1]


def test_an_iterate_at_the_limit_of_iterations_is_a_guess_where_its_rows_nearly_hold() -> None:
    block = rt.Phase(rt.load("block"), 3.0, rt.State(q=0, v=0), rt.State(q=1, v=0), rt.Effort())
    solved = rt.plan(block, mesh=rt.Mesh(4))
    assert is_guess(solved)
    ended = replace(solved, status=Status.ITERATION_LIMIT)
    assert is_guess(ended)
    failed = rt.plan(block.with_(duration=1e-3), mesh=rt.Mesh(4), check=False)
    assert not is_guess(failed)
    far = failed.violations(1)[0]
    assert far.relative > NEARLY
    assert not is_guess(replace(ended, violation_list=(far,)))
    assert is_guess(replace(ended, violation_list=(replace(far, amount=0.5 * NEARLY * far.size),)))


@pytest.mark.slow
def test_a_plan_by_early_ended_guesses_is_proved() -> None:
    solution = rt.plan(reach(), check=False, progress=False)
    assert solution.success
    assert solution.proof is not None
    assert solution.proof.holds


def test_works_with_dry_friction_are_limited_between_the_points_from_the_second_mesh(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A proved motion ends on the third mesh with the robot's own friction."""
    robot = replace(rt.load("two_link_arm"), friction=np.full(2, 0.5))
    ends = rt.State(q=[0, 0], v=0), rt.State(q=[0.8, -0.5], v=0)
    limited: list[bool] = []
    real = loop.solved

    def recorded(state, *given):  # type: ignore[no-untyped-def]
        found = real(state, *given)
        if state.task is Task.MESH:
            limited.append(found.limited)
        return found

    monkeypatch.setattr(loop, "solved", recorded)
    limits = robot.limits.with_(effort=20.0, velocity=6.0)
    solution = rt.plan(rt.Phase(robot, 2.0, *ends, rt.objectives.MechanicalWork(), limits=limits))
    assert limited[:2] == [False, True][: len(limited)]
    # A better solution from the plan itself is a further step on the same mesh.
    assert len({step.intervals for step in solution.refinement}) <= ENOUGH_OF_POWERS
    assert solution.proof is not None and solution.proof.motion_holds


ARM_LINK = (
    '<link name="{0}"><inertial><origin xyz="0 0 -.1"/><mass value="1"/><inertia ixx=".01" iyy=".01" izz=".01" '
    'ixy="0" ixz="0" iyz="0"/></inertial><collision><origin xyz="0 0 {1}"/><geometry><box size="{2}"/></geometry>'
    "</collision></link>"
)
ARM_JOINT = (
    '<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/><origin xyz="0 0 {3}"/>'
    '<axis xyz="0 1 0"/><limit lower="-2" upper="2" velocity="20" effort="60"/></joint>'
)
CENTRE, RADIUS = np.array([0.0, 0.0, 0.85]), 0.1


def gap_of_tool(a: float, b: float) -> float:
    """Distance of the tool, a box of 0.1 x 0.1 x 0.6 m above the end of the first link, from the ball [m]."""

    def turn(angle: float) -> np.ndarray:
        c, s = np.cos(angle), np.sin(angle)
        return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])

    inside = turn(a + b).T @ (CENTRE - turn(a) @ [0.0, 0.0, 0.4]) - [0.0, 0.0, 0.3]
    return float(np.linalg.norm(np.maximum(np.abs(inside) - [0.05, 0.05, 0.3], 0.0)) - RADIUS)


def test_an_arm_folds_below_a_ball_that_its_straight_swing_meets(tmp_path: Path) -> None:
    links = ARM_LINK.format("upper", 0.2, ".06 .06 .2") + ARM_LINK.format("tool", 0.3, ".1 .1 .6")
    joints = ARM_JOINT.format("shoulder", "base", "upper", 0) + ARM_JOINT.format("elbow", "upper", "tool", 0.4)
    (tmp_path / "arm.urdf").write_text(f'<robot name="arm"><link name="base"/>{links}{joints}</robot>')
    arm = rt.load(tmp_path / "arm.urdf")
    swing = rt.Phase(
        arm,
        3.0,
        rt.State(q=[-1.2, 0.0], v=0),
        rt.State(q=[1.2, 0.0], v=0),
        rt.Effort(),
        [rt.CollisionFree([rt.obstacles.Sphere(RADIUS, CENTRE)])],
    )
    assert gap_of_tool(0.0, 0.0) < 0.0
    plan = rt.plan(swing)
    assert plan.proof.holds
    assert min(gap_of_tool(a, b) for a, b in plan.at(np.linspace(0.0, 3.0, 3001)).q) > 0.0


@pytest.mark.slow
def test_a_heavy_base_under_a_light_arm_moves_by_the_integral_of_its_effort() -> None:
    """Light joints that swing between the points lowered Simpson's sum by 10 percent, on every finer mesh anew."""
    arm = rt.load("panda")
    robot = rt.robot.on_wheels(arm, mass=100.0, inertia=10.0)
    lower, upper = np.maximum(arm.limits.position_lower, -2.0), np.minimum(arm.limits.position_upper, 2.0)
    start, end = lower + (upper - lower) * (0.1 + 0.8 * np.random.default_rng(2).random((2, arm.nq)))
    ends = rt.State(q=[0.0, 0.0, 0.0, *start], v=0), rt.State(q=[1.0, 0.5, 0.3, *end], v=0)
    solution = rt.plan(rt.Phase(robot, 3.0, *ends, rt.Effort()), progress=False)
    assert solution.proof is not None and solution.proof.holds
    assert solution.proof.quadrature < 1e-4
    assert solution.phases[0].mesh.given == (rt.schemes.GaussLegendre(3, joined=True),)
    beside = 1e-9
    before, after = solution.at(solution.knots[1:-1] - beside), solution.at(solution.knots[1:-1] + beside)
    np.testing.assert_allclose(after.tau, before.tau, atol=1e-5 * np.abs(before.tau).max())
