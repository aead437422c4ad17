"""Meshes that follow from the measures of a plan."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.planning.loop.measures import measured
from robotraj.transcription.refinement.equidistribution import Equidistribute


def test_only_phases_that_miss_a_goal_get_many_more_intervals() -> None:
    """A fast oscillator errs on four intervals, and uniform motion does not."""
    block = rt.System(["x", "v"], [], lambda point: [point.x["v"], 0.0])
    spring = rt.System(["x", "v"], [], lambda point: [point.x["v"], -40.0 * ca.sin(point.x["x"])])
    start = rt.State({"x": 0.0, "v": 1.0})
    moves = [rt.Phase(system, 1.0, start=start) for system in (spring, block)]
    solution = rt.plan(rt.Problem(moves, []), rt.Mesh(4))
    measures = measured(solution, None, rt.solution.Goals())
    assert measures.errors[0].max() > measures.proof.goals.error > measures.errors[1].max()
    missing, met = measures.next_meshes(solution.phases, Equidistribute(), 1.0, 2.0)
    assert missing.count >= 8 and met.count == 4
    finer = measures.next_meshes(solution.phases, Equidistribute(), 3.0, 2.0)
    assert min(mesh.count for mesh in finer) >= 12


def test_an_error_that_moves_to_another_place_does_not_stagnate() -> None:
    """Before, the error was above its goal in the first half of the first phase alone."""
    spring = rt.System(["x", "v"], [], lambda point: [point.x["v"], -40.0 * ca.sin(point.x["x"])])
    start = rt.State({"x": 0.0, "v": 1.0})
    moves = [rt.Phase(spring, 1.0, start=start) for _ in range(2)]
    coarse, fine = (measured(rt.plan(rt.Problem(moves, []), rt.Mesh(n)), None, rt.solution.Goals()) for n in (2, 4))
    before = replace(coarse, local=(np.array([3e-4, 1e-6]), np.array([1e-6, 1e-6])))

    def stagnant(*errors: float) -> int | None:
        proof = replace(fine.proof, error=max(errors))
        return replace(fine, proof=proof, before=before, local=(np.array(errors), np.full(4, 1e-6))).stagnant

    assert stagnant(1e-6, 2.9e-4, 1e-6, 1e-6) == 0
    assert stagnant(1e-6, 1e-6, 2.9e-4, 1e-6) is None
    assert stagnant(1e-6, 1.5e-4, 1e-6, 1e-6) is None
    assert stagnant(1e-6, 0.9e-4, 1e-6, 1e-6) is None
    # The motion changed: its error fell tenfold, but exceeds the one that was at its place.
    before = replace(coarse, local=(np.array([3e-3, 2e-4]), np.array([1e-6, 1e-6])))
    assert stagnant(1e-6, 1e-6, 2.9e-4, 1e-6) is None


def test_errors_wander_that_hardly_fall_on_two_meshes_in_a_row() -> None:
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    solution = rt.plan(rt.Phase(block, 1.0, rt.State([0.0, 0.0]), rt.State([1.0, 0.0]), rt.Effort()), rt.Mesh(4))
    one = measured(solution, None, rt.solution.Goals())

    def wanders(*largest: float) -> bool:
        measures = None
        for error in largest:
            measures = replace(one, before=measures, proof=replace(one.proof, error=error))
        assert measures is not None
        return measures.wanders

    assert wanders(3e-4, 2.5e-4, 2.4e-4)
    assert not wanders(3e-4, 2.5e-4)
    assert not wanders(3e-4, 1.5e-4, 1.4e-4)
    assert not wanders(3e-4, 2.5e-4, 1.4e-4)
    assert not wanders(1.1e-4, 1.0e-4, 0.9e-4)


@pytest.mark.parametrize("bending", [False, True])
def test_a_mesh_that_is_no_finer_says_nothing_of_the_objective(bending: bool) -> None:
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    ends = {"start": rt.State([0.0, 0.0]), "end": rt.State([1.0, 0.0])}
    solution = rt.plan(rt.Phase(block, 1.0, **ends, objective=rt.Effort()), rt.Mesh(4))
    first = measured(solution, None, rt.solution.Goals(), bending)
    again = measured(solution, first, rt.solution.Goals(), bending)
    assert first.proof.unsettled == again.proof.unsettled == np.inf
    assert measured(solution, first, rt.solution.Goals(), bending, expected=0.5).proof.unsettled == 0.5


def test_a_better_motion_on_another_mesh_as_fine_is_still_to_gain() -> None:
    """Objectives 1.2 and 1.01 on 20 and 40 intervals: by the order 2 a third of the change is left."""
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    phase = rt.Phase(block, 1.0, rt.State([0.0, 0.0]), rt.State([1.0, 0.0]), rt.Effort())
    solution = rt.plan(phase, rt.Mesh(40, rt.HermiteSimpson()))
    fine = measured(solution, None, rt.solution.Goals())
    coarse = replace(fine, objective=1.2 * fine.objective, meshes=(rt.Mesh(20),), before=fine)
    better = replace(fine, objective=0.99 * fine.objective, before=coarse)

    def unsettled(before: object) -> float:
        return measured(solution, before, rt.solution.Goals()).proof.unsettled

    assert unsettled(coarse) == pytest.approx(0.2 / 3, rel=1e-3)
    assert unsettled(better) == pytest.approx(0.21 / 3 + 0.01, rel=1e-3)
    # A mesh whose solution is no motion shows nothing.
    assert unsettled(replace(better, proof=replace(better.proof, error=1.0))) == pytest.approx(0.2 / 3, rel=1e-3)
