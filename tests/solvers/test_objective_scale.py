"""The scale of the objective: its formula, and solves that are the same in any unit and on any mesh."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj.solvers.objective_scale import FINE, LEAST, SHARE, objective_scale
from tests.programs import nlp_of

SOLVER = rt.InteriorPoint(fallback=None, threads=1)
START, GOAL = [-1.1, -1.8, 1.6, -1.2, -1.57, 0.0], [1.1, -0.8, 0.6, -0.6, -0.6, 1.2]


def reach(weight: float = 1.0) -> rt.Phase:
    """A motion of ur5 in 1 s, by its effort in other units."""
    return rt.Phase(rt.load("ur5"), 1.0, rt.State(q=START, v=0), rt.State(q=GOAL, v=0), weight * rt.Effort())


def test_the_gap_of_the_first_barrier_is_a_share_of_the_objective() -> None:
    scale = objective_scale(1456.0, 4200, 50, 1e-2)
    assert SHARE * scale * 1456.0 == pytest.approx(4200 * 1e-2)
    assert objective_scale(-1456.0, 4200, 50, 1e-2) == scale


@pytest.mark.parametrize(("objective", "bounds"), [(0.0, 100), (np.nan, 100), (np.inf, 100), (5.0, 0)])
def test_an_objective_without_a_meaningful_size_is_not_scaled(objective: float, bounds: int) -> None:
    assert objective_scale(objective, bounds, 50, 1e-2) == 1.0


def test_only_objectives_of_fine_meshes_are_enlarged() -> None:
    assert objective_scale(1e-3, 4200, 50, 1e-2) == 1.0
    assert objective_scale(1e-3, 4200, 4 * FINE, 1e-2) == 4.0
    assert objective_scale(1e30, 4200, 50, 1e-2) == LEAST


@pytest.mark.parametrize("weight", [10.0, 1e3])
def test_an_objective_in_larger_units_takes_the_same_iterations_to_the_same_motion(weight: float) -> None:
    one, other = (
        rt.plan(reach(each), rt.Mesh(20), solver=SOLVER, check=False, progress=False) for each in (2.0, 2.0 * weight)
    )
    assert other.success
    assert other.iterations == pytest.approx(one.iterations, abs=2)
    assert other.objective == pytest.approx(weight * one.objective, rel=1e-9)
    assert one.multipliers is not None and other.multipliers is not None
    size = np.abs(one.multipliers.rows).max()
    np.testing.assert_allclose(other.multipliers.rows / weight, one.multipliers.rows, atol=1e-4 * size)


@pytest.mark.parametrize("weight", [1e-3, 1e-6, 1e-12])
def test_an_objective_in_smaller_units_has_the_same_size_for_the_solver(weight: float) -> None:
    """Efforts of a robot of 5 cm are 1e-11 of those of a robot of 1 m."""
    nlp = nlp_of(rt.Problem([reach(weight)]), rt.Mesh(20))
    first = nlp.objective(nlp.guess + 0.1 * nlp.scale)
    assert nlp.objective_scale(first) * first == pytest.approx(1.0)


def test_iterations_hardly_grow_with_the_mesh() -> None:
    counts = [
        rt.plan(reach(), rt.Mesh(n), solver=SOLVER, check=False, progress=False).iterations for n in (25, 100, 400)
    ]
    assert max(counts) <= 1.3 * min(counts), counts


def test_a_solve_starts_from_multipliers_of_another_scale() -> None:
    """Multipliers are of the objective as it is: a second solve from the first one's end has next to nothing to do."""
    problem = reach(50.0)
    cold = rt.plan(problem, rt.Mesh(20), solver=SOLVER, check=False, progress=False)
    warm = rt.plan(problem, rt.Mesh(20), guess=cold, solver=SOLVER, check=False, progress=False)
    assert warm.iterations < cold.iterations / 2
    assert warm.objective == pytest.approx(cold.objective, rel=1e-7)


def test_a_scale_that_is_given_is_taken_and_nonsense_refused() -> None:
    plain = rt.InteriorPoint(fallback=None, threads=1, objective_scale=1.0)
    chosen, given = (
        rt.plan(reach(1e3), rt.Mesh(20), solver=solver, check=False, progress=False) for solver in (SOLVER, plain)
    )
    assert given.iterations > 1.5 * chosen.iterations
    assert given.objective == pytest.approx(chosen.objective, rel=1e-7)
    for scale in (0.0, -1.0, np.inf, np.nan):
        with pytest.raises(rt.InputError, match="objective_scale"):
            rt.InteriorPoint(objective_scale=scale)
