"""Plans whose mesh was left open are measured between their points until they are proved."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.fixed_mesh.at_points import AtPoints
from robotraj.fixed_mesh.solve import solve
from robotraj.planning.loop import run as loop
from robotraj.planning.proving.first_mesh import ProportionalMeshes, graded
from robotraj.planning.settings import resolve
from robotraj.solution.settings import Settings
from robotraj.solvers.status import Status
from robotraj.transcription.refinement.equidistribution import evenly_finer


def reach(objective: rt.objectives.Objective, duration: object) -> rt.Phase:
    start, end = rt.State(q=[-1.1, -1.8, 1.6, -1.2, -1.57, 0], v=0), rt.State(q=[1.1, -0.8, 0.6, -0.6, -0.6, 1.2], v=0)
    return rt.Phase(rt.load("ur5"), duration, start, end, objective)


def test_the_default_plan_is_proved() -> None:
    solution = rt.plan(reach(rt.Effort(), 1.0))
    proof = solution.proof
    assert proof is not None and proof.holds and solution.success
    assert proof.error == 0.0
    assert "proved between the points" in str(solution)
    assert 2 <= len(solution.refinement) <= 3
    fine = rt.plan(reach(rt.Effort(), 1.0), mesh=rt.Mesh.chebyshev(120))
    assert solution.objective == pytest.approx(fine.objective, rel=1e-3)


def test_fastest_motions_keep_every_limit_at_every_time() -> None:
    solution = rt.plan(reach(rt.Duration(), (0.3, 3)))
    assert solution.proof is not None and solution.proof.holds
    sample, limits = solution.at(np.linspace(0, solution.duration, 20001)), solution.phases[0].phase.robot.limits
    assert np.max(np.abs(sample.tau) / limits.effort) <= 1 + 1e-3
    assert np.max(np.abs(sample.v) / limits.velocity) <= 1 + 1e-6
    assert solution.objective == pytest.approx(0.72573, rel=2e-3)


def test_a_given_mesh_is_solved_and_nothing_is_proved() -> None:
    solution = rt.plan(reach(rt.Effort(), 1.0), mesh=rt.Mesh(20))
    assert solution.proof is None and len(solution.phases[0].knots) == 21
    assert "nothing was proved" in str(solution)


def test_a_proof_survives_storage(tmp_path) -> None:
    solution = rt.plan(reach(rt.Effort(), 1.0))
    assert rt.load_solution(solution.save(tmp_path / "reach")).proof == solution.proof


def test_a_motion_beyond_its_limits_is_not_proved_however_good_its_objective() -> None:
    beyond = rt.solution.Proof(0.0, 2e-3, 0.0, 0.0, rt.solution.Goals())
    assert not beyond.motion_holds and not beyond.holds
    assert "excess over limits 2.0e-03 (allowed 1e-03)" in " ".join(str(beyond).split())
    early = rt.solution.Proof(0.0, 0.0, 0.0, 5e-3, rt.solution.Goals())
    assert early.motion_holds and not early.holds


def test_graded_meshes_are_symmetric_and_crowd_at_both_ends() -> None:
    lengths = np.diff(graded(16).knots)
    assert lengths == pytest.approx(lengths[::-1], rel=1e-9)
    assert lengths[0] < 0.5 * lengths[8]


def cartpole(effort: float = np.inf) -> rt.Phase:
    robot = rt.load("cartpole")
    start, end = rt.State(q=[0, 0], v=0), rt.State(q=[1, np.pi], v=0)
    return rt.Phase(robot, 2.0, start, end, rt.Effort(), limits=robot.limits.with_(effort=effort))


@pytest.mark.parametrize(("effort", "optimum"), [(np.inf, 58.80767), (12.0, None)])
def test_a_robot_with_too_few_motors_is_proved(effort: float, optimum: float | None) -> None:
    solution = rt.plan(cartpole(effort))
    assert solution.success and solution.proof is not None and solution.proof.holds
    assert 0.0 < solution.proof.error <= 1e-4
    assert len(solution.refinement) <= 4
    if optimum is not None:
        assert solution.objective == pytest.approx(optimum, rel=1e-3)
    assert np.abs(solution.at(np.linspace(0, 2, 5001)).tau).max() <= effort * (1 + 1e-3)
    assert rt.validate(solution).passed


def test_a_system_is_proved_and_its_switching_force_keeps_its_limit() -> None:
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    push = rt.Phase(
        block, (0.1, 20), rt.State([0, 0]), rt.State([10, 0]), rt.Duration(), controls={"u": rt.between(-1, 1)}
    )
    solution = rt.plan(push)
    assert solution.proof is not None and solution.proof.holds and solution.success
    assert solution.duration == pytest.approx(2 * np.sqrt(10), rel=1e-3)
    assert np.abs(solution.at(np.linspace(0, solution.duration, 5001)).u["u"]).max() <= 1 + 1e-3


def test_phases_in_a_row_are_proved_together() -> None:
    there = cartpole(20.0).with_(name="there")
    on = there.with_(name="on", start=None, end=rt.State(q=[0, np.pi], v=0), duration=1.5)
    solution = rt.plan(rt.Problem([there, on], [rt.Continuity(0, 1)]))
    assert solution.proof is not None and solution.proof.holds
    assert rt.validate(solution).passed


def test_a_step_is_proved() -> None:
    robot = rt.load("five_link", root="planar")
    foot = rt.PointContact("left_foot", friction=0.6)
    solution = rt.plan(rt.gait.walk(robot, step_length=0.5, duration=0.7, contact=foot, clearance=0.05))
    assert solution.proof is not None and solution.proof.holds
    assert rt.validate(solution).passed


def test_a_goal_that_no_mesh_reaches_is_not_proved_and_the_plan_is_kept() -> None:
    with pytest.raises(rt.NoSolutionFound, match="error of the motion") as caught:
        rt.plan(cartpole(), goals=rt.solution.Goals(error=1e-14))
    kept = caught.value.solution
    assert kept.status is rt.solvers.Status.NOT_PROVED and kept.proof is not None
    assert "allowed 1e-14" in str(kept) and kept.objective == pytest.approx(58.80767, rel=1e-3)


@pytest.mark.slow
def test_dry_friction_is_met_step_by_step() -> None:
    """From a straight line at once, the solver ends in an optimum that costs more."""
    robot = rt.load("z1", locked={"jointGripper": 0.0})
    start, end = rt.State(q=[0, 1.0, -1.0, 0.2, 0, 0], v=0), rt.State(q=[1.2, 1.8, -1.6, -0.6, 0.8, 0.9], v=0)
    phase = rt.Phase(robot, 1.5, start, end, rt.Effort())
    solution = rt.plan(phase)
    assert solution.success and solution.proof is not None and solution.proof.holds
    assert solution.problem.phases[0].robot.friction_speed <= robot.friction_speed
    at_once = solve(rt.Problem([phase]), None, resolve(rt.Problem([phase]), {"mesh": graded(48)}))
    assert solution.objective < at_once.objective
    assert rt.validate(solution).passed


def test_an_objective_is_compared_with_that_of_a_mesh_that_is_clearly_coarser() -> None:
    weak = rt.load("pendulum").limits.with_(effort=0.5)
    objective = rt.Duration() + 0.1 * rt.Effort()
    up = rt.Phase(rt.load("pendulum"), (2, 20), rt.State(q=0, v=0), rt.State(q=np.pi, v=0), objective, limits=weak)
    solution = rt.plan(up)
    assert solution.proof is not None and solution.proof.holds
    fine = rt.plan(up, mesh=rt.Mesh(500, rt.HermiteSimpson()), guess=solution)
    assert solution.objective == pytest.approx(fine.objective, rel=1e-3)


def test_intervals_of_a_first_mesh_are_proportional_to_durations() -> None:
    robot = rt.load("hopper", root="planar")
    spans = (0.2, 1.0, 0.6, (0.0, np.inf), (0.2, 0.6))
    problem = rt.Problem([rt.Phase(robot, span, name=str(i)) for i, span in enumerate(spans)])
    meshes = ProportionalMeshes(4, 2, rt.schemes.LobattoIIIA(4)).of(problem)
    assert [mesh.count for mesh in meshes] == [2, 4, 3, 4, 2]
    assert all(mesh.schemes[0] == rt.schemes.LobattoIIIA(4) for mesh in meshes)


def test_torques_hold_where_dry_friction_changes_its_sign_within_an_interval() -> None:
    """The torque of joint 4 peaks 0.03 ms after the start, where its friction saturates."""
    robot = rt.load("z1", locked={"jointGripper": 0.0})
    start, end = rt.State(q=[0, 1.0, -1.0, 0.2, 0, 0], v=0), rt.State(q=[1.2, 1.8, -1.6, -0.6, 0.8, 0.9], v=0)
    solution = rt.plan(rt.Phase(robot, (0.1, 20), start, end, rt.Duration()))
    torques = solution.at(np.linspace(0.0, 3e-4, 301)).tau
    assert np.max(np.abs(torques) / robot.limits.effort) < 1.001


@pytest.mark.parametrize("seed", [1, 2])
def test_a_least_time_may_gain_about_what_its_proof_says(seed: int) -> None:
    robot = rt.load("panda", locked={"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0})
    lower, upper = np.maximum(robot.limits.position_lower, -2), np.minimum(robot.limits.position_upper, 2)
    a, b = (lower + (upper - lower) * share for share in np.random.default_rng(seed).uniform(0.15, 0.85, (2, robot.nq)))
    found = rt.plan(rt.Phase(robot, (0.1, 10.0), rt.State(q=a, v=0), rt.State(q=b, v=0), rt.Duration()))
    meshes = [evenly_finer(part.mesh, 4) for part in found.phases]
    limits = found.settings.interval_limits
    finer = rt.plan(found.problem, mesh=meshes, guess=found, interval_limits=limits, check=False)
    assert found.proof is not None and finer.success
    assert -1e-6 < found.duration / finer.duration - 1.0 < 1.5 * found.proof.unsettled < 1.5e-3


def singular(point: rt.dynamics.Point) -> list[ca.SX]:
    return [point.x["v"], point.u["u"]]


@pytest.mark.parametrize("fails", [False, True])
def test_controls_become_lines_where_they_ring_or_finer_meshes_are_not_solved(
    fails: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Jacobson, Gershwin and Lele (1970): from -1 the control enters a singular arc."""
    real, free = loop.solved_at_points, rt.HermiteSimpson()

    def solve(problem: rt.Problem, start: object, settings: Settings, *more: object, **named: object) -> AtPoints:
        found = real(problem, start, settings, *more, **named)  # type: ignore[arg-type]
        finer = isinstance(start, rt.Solution) and found.solution.phases[0].mesh.given == (free,)
        return found.changed(status=Status.STALLED) if fails and finer else found

    monkeypatch.setattr(loop, "solved_at_points", solve)
    both = rt.Lagrange(lambda point: point.x["x"] ** 2 + point.x["v"] ** 2)
    block = rt.System(["x", "v"], ["u"], singular)
    phase = rt.Phase(block, 5.0, rt.State([0, 1]), objective=both, controls={"u": rt.between(-1, 1)})
    solution = rt.plan(phase)
    assert solution.success
    assert solution.phases[0].mesh.given != (free,)
    (reason,) = [each.lacked for each in solution.history if "controls as lines" in each.response]
    assert reason.startswith("stalled" if fails else "teeth of a control")
    assert solution.objective == pytest.approx(0.7539, rel=1e-3)


def test_a_coarse_solution_that_leads_to_no_motion_is_dropped(monkeypatch: pytest.MonkeyPatch) -> None:
    real, starts = loop.solved_at_points, []

    def solve(problem: rt.Problem, start: object, settings: Settings, *more: object, **named: object) -> AtPoints:
        found = real(problem, start, settings, *more, **named)  # type: ignore[arg-type]
        starts.append(isinstance(start, rt.Solution))
        return found.changed(status=Status.INFEASIBLE) if starts[-1] else found

    monkeypatch.setattr(loop, "solved_at_points", solve)
    ends = rt.State(q=[0, 0], v=0), rt.State(q=[1, np.pi], v=0)
    solution = rt.plan(rt.Phase(rt.load("cartpole"), 2.0, *ends, rt.Effort()), check=False)
    assert starts[:4] == [False, True, True, False]
    # The finer mesh of the second beginning is kept, although no solve from it succeeds.
    assert solution.proof is not None and solution.proof.error < 1e-3


@pytest.mark.slow
@pytest.mark.parametrize(
    ("objective", "early"),
    [
        (rt.objectives.MechanicalWork(), True),
        (rt.objectives.MechanicalWork(smoothing=1.0), False),
        (rt.Effort(), False),
    ],
)
def test_solves_with_kinked_objectives_end_where_these_hardly_change(
    objective: rt.objectives.Objective, early: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Once a motion is proved, so do its later solves, whatever the objective.
    real, changes = loop.solved_at_points, []

    def solve(problem: rt.Problem, start: object, settings: Settings, *more: object, **named: object) -> AtPoints:
        assert isinstance(settings.solver, rt.InteriorPoint)
        changes.append(settings.solver.objective_change is not None)
        return real(problem, start, settings, *more, **named)  # type: ignore[arg-type]

    monkeypatch.setattr(loop, "solved_at_points", solve)
    solution = rt.plan(reach(objective, 1.0), check=False)
    assert solution.success
    assert changes[:2] == [early] * 2 and changes == sorted(changes)


def test_a_reach_by_mechanical_work_is_proved() -> None:
    arm = rt.load("panda", locked={"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0})
    start = rt.State(q=[0.41, -0.49, -1.38, -1.99, 0.94, 1.86, 0.32], v=0)
    end = rt.State(q=[0.78, -0.42, -0.68, -1.48, 0.14, 2.44, -0.43], v=0)
    solution = rt.plan(rt.Phase(arm, 1.2, start, end, rt.objectives.MechanicalWork()), check=False, time_limit=25)
    assert solution.proof is not None and solution.proof.holds
