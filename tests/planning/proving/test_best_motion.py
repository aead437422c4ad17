"""Solves with lower limits start near the solution, and no limit is lowered by more than itself."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import robotraj as rt
from robotraj.planning import solve as one_solve
from robotraj.planning.proving import best_motion
from robotraj.solution.proof import Goals, Proof
from robotraj.solvers.interior_point import NEARBY_BARRIER


def _damped() -> rt.Phase:
    """Move an arm with much damping in least time under limits of the rates of its torques."""
    arm = replace(rt.load("two_link_arm"), damping=np.full(2, 5.0), friction=np.full(2, 0.5))
    limit = rt.constraints.JointTorqueRate(rt.between(-30, 30))
    ends = rt.State(q=[0, 0], v=0), rt.State(q=[1.0, 0.5], v=0)
    limits = arm.limits.with_(effort=20.0)
    return rt.Phase(arm, (0.05, 10.0), *ends, rt.Duration(), constraints=[limit], limits=limits)


def test_solves_with_lower_limits_on_the_same_mesh_start_from_a_small_barrier(monkeypatch):
    """Limits of rates alternate from mesh to mesh, but not where limits are lowered on the same mesh."""
    barriers: list[tuple[tuple[rt.Mesh, ...], float]] = []
    plain = one_solve._solve

    def recorded(nlp, guess, multipliers, solver, *rest):
        barriers.append((tuple(layout.mesh for layout in nlp.layouts), solver.initial_barrier))
        return plain(nlp, guess, multipliers, solver, *rest)

    monkeypatch.setattr(one_solve, "_solve", recorded)
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
    problem = rt.Problem([phase])
    settings = rt.plan(phase, mesh=rt.Mesh(4), check=False).settings
    motion = best_motion.BestMotion(problem, replace(settings, goals=Goals()), None)
    found = SimpleNamespace(proof=Proof(0.0, excess, 0.0, 0.0, Goals()), growth=1.0)
    monkeypatch.setattr(best_motion, "measured", lambda *given: found)
    assert motion._is_settled(SimpleNamespace(phases=())) is imposed
