"""Works of a small share are rounded within a part of the goal, and those of a larger one stay exact."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import robotraj as rt
from robotraj.fixed_mesh.sizes.soft_kinks import PART, with_soft_kinks
from robotraj.problem.objectives.work import SoftWork

GOALS = rt.solution.Goals()
WORK = rt.objectives.AbsolutePower()


def slide(objective: rt.objectives.Objective) -> rt.Problem:
    """Push the block of 1 kg over 3 m in 2 s, from rest to rest."""
    ends = rt.State(q=0, v=0), rt.State(q=3, v=0)
    return rt.Problem([rt.Phase(rt.load("block"), 2.0, *ends, objective, limits=None)])


def cost_of_the_plain_motion(weight: float) -> float:
    """Effort 120/7 m^2 L^2 / T^3 of a quintic, and its absolute power m v^2 at the largest speed 15/8 L/T."""
    return 120.0 / 7.0 * 9.0 / 8.0 + weight * (15.0 / 8.0 * 1.5) ** 2


def soft_terms(problem: rt.Problem) -> list[SoftWork]:
    return [term for phase in problem.phases for _, term in phase.integrals if isinstance(term, SoftWork)]


def test_small_shares_are_rounded_and_large_ones_are_not() -> None:
    for objective, is_rounded in (
        (rt.Effort() + 1e-9 * WORK, True),
        (rt.Effort() + 1e-2 * WORK, True),
        (rt.Effort() + 0.5 * WORK, False),
        (rt.Duration() + 1e-6 * WORK, True),
        # A least time has the curvature of its smoothing alone.
        (rt.Duration() + 1e-2 * WORK, False),
        (WORK, False),
        (rt.Effort() + 1e-3 * rt.objectives.MechanicalWork(), True),
    ):
        problem = slide(objective)
        soft = with_soft_kinks(problem, GOALS, 5e-3)
        assert (soft is not problem) is is_rounded, objective
        assert bool(soft_terms(soft)) is is_rounded
        assert len(soft.phases[0].dae.controls) == (1 if is_rounded else 2)


def test_a_problem_is_rounded_once() -> None:
    problem = slide(rt.Effort() + 1e-6 * WORK)
    assert with_soft_kinks(problem, GOALS, 0.0) is with_soft_kinks(problem, GOALS, 0.0)


def test_problems_without_kinks_stay() -> None:
    problem = slide(rt.Effort() + 1e-6 * rt.Duration())
    assert with_soft_kinks(problem, GOALS, 0.0) is problem


def test_rounding_leaves_out_a_part_of_the_goal_and_no_more() -> None:
    weight = 1e-3
    (term,) = soft_terms(with_soft_kinks(slide(rt.Effort() + weight * WORK), GOALS, 0.0))
    # |P| - sqrt(P^2 + e^2) + e is at most e, over 2 s.
    assert term.smoothing is not None
    left_out = PART * GOALS.objective * cost_of_the_plain_motion(weight)
    assert weight * term.smoothing * 2.0 == pytest.approx(left_out, rel=1e-3)


def test_a_solution_states_the_exact_work_of_its_motion(tmp_path: Path) -> None:
    weight = 2e-2
    solution = rt.plan(slide(rt.Effort() + weight * WORK))
    (term,) = soft_terms(solution.problem)
    assert solution.proof is not None and solution.proof.holds
    times = np.linspace(0.0, 2.0, 20001)
    sample = solution.at(times)
    power = np.abs(sample.tau * sample.v).sum(axis=1)
    exact = np.trapezoid((sample.tau**2).sum(axis=1) + weight * power, times)
    rounded = exact - weight * np.trapezoid(power - np.sqrt(power**2 + term.smoothing**2) + term.smoothing, times)
    assert solution.objective == pytest.approx(exact, rel=1e-6)
    assert 1e-5 * exact < exact - rounded < PART * GOALS.objective * cost_of_the_plain_motion(weight)
    loaded = rt.load_solution(solution.save(tmp_path / "slide.npz"))
    assert soft_terms(loaded.problem) == [term] and loaded.objective == solution.objective


@pytest.mark.filterwarnings("ignore:Torques on this mesh are free")
def test_a_rounded_plan_is_as_good_as_one_with_slacks() -> None:
    problem = slide(rt.Effort() + 2e-2 * WORK)
    exact = rt.plan(problem, mesh=rt.Mesh(96))
    assert not soft_terms(exact.problem)
    assert rt.plan(problem).objective == pytest.approx(exact.objective, rel=PART * GOALS.objective)
