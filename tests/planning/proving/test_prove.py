"""Plans whose mesh was left open are measured between their points until they are proved."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj.planning.proving.first_mesh import graded


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
    assert "excess over limits 2.0e-03 (allowed 1e-03)" in str(beyond)
    early = rt.solution.Proof(0.0, 0.0, 0.0, 5e-3, rt.solution.Goals())
    assert early.motion_holds and not early.holds


def test_graded_meshes_are_symmetric_and_crowd_at_both_ends() -> None:
    lengths = np.diff(graded(16).knots)
    assert lengths == pytest.approx(lengths[::-1], rel=1e-9)
    assert lengths[0] < 0.5 * lengths[8]
