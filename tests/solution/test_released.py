"""Solutions hold raw multipliers: from these follow the multipliers, costates and warm starts of the program itself."""

from __future__ import annotations

import copy
import gc
import weakref

import cloudpickle
import numpy as np
import pytest

import robotraj as rt
from robotraj.cli.demos.table import DEMOS
from robotraj.solution.released import attached, detached, released
from robotraj.solution.solution import Solution
from robotraj.solvers.kept_multipliers import KeptMultipliers


def swing(**changes: object) -> rt.Problem:
    robot = rt.load("cartpole")
    ends = rt.State(q=0, v=0), rt.State(q=[0.5, 0.6], v=0)
    known = {"duration": (0.5, 2.0), "objective": rt.Effort() + rt.Duration()}
    return rt.Problem([rt.Phase(robot, start=ends[0], end=ends[1], **(known | changes))])


CASES: dict[str, tuple[object, dict[str, object]]] = {
    "stages, free duration": (swing, {"mesh": rt.Mesh(8)}),
    "stages, proved": (lambda: rt.Problem([DEMOS["ur5"].make().problem]), {}),
    "stages, two phases": (lambda: DEMOS["bouncing_mass"].make().problem, {}),
    "assembled": (lambda: DEMOS["compass_walker"].make().problem, {"mesh": rt.Mesh(8), "solver": rt.InteriorPoint()}),
    "assembled, rows between the points": (lambda: DEMOS["design"].make().problem, {"mesh": rt.Mesh(8)}),
    "ipopt": (swing, {"mesh": rt.Mesh(8), "solver": rt.Ipopt()}),
    "shooting": (swing, {"mesh": rt.Mesh(8, rt.schemes.MultipleShooting())}),
    "radau": (swing, {"mesh": rt.Mesh(6, rt.schemes.RadauIIA(3))}),
}


def posed(make: object) -> rt.Problem:
    problem = make()  # type: ignore[operator]
    return rt.Problem([problem]) if isinstance(problem, rt.Phase) else problem


def largest(one: np.ndarray, other: np.ndarray) -> float:
    return float(np.max(np.abs(one - other), initial=0.0) / max(np.max(np.abs(one), initial=0.0), 1e-300))


@pytest.mark.parametrize("case", CASES)
def test_multipliers_and_costates_follow_from_the_raw_ones(case: str) -> None:
    make, options = CASES[case]
    problem = posed(make)
    whole = rt.plan(problem, check=False, keep_program=True, **options)
    assert whole.success and bool(whole.added_rows) == (case == "assembled, rows between the points")
    data = cloudpickle.dumps(detached(whole, problem))
    assert len(data) < 250_000
    other = attached(cloudpickle.loads(data), problem)
    assert isinstance(other.multipliers, KeptMultipliers) and not vars(other.multipliers).get("plain")
    assert other.multipliers.sizes == whole.multipliers.sizes
    for name in ("rows", "bounds"):
        assert largest(getattr(whole.multipliers, name), getattr(other.multipliers, name)) < 1e-9
    assert len(other.duals) == len(whole.duals)
    for one, two in zip(whole.duals, other.duals, strict=True):
        assert largest(np.concatenate(one.costate.values), np.concatenate(two.costate.values)) < 1e-9


@pytest.mark.parametrize("case", ["stages, free duration", "ipopt"])
def test_a_plan_from_a_released_solution_is_that_from_the_whole_one(case: str) -> None:
    make, options = CASES[case]
    problem = posed(make)
    whole = rt.plan(problem, keep_program=True, **options)
    nearby = problem.with_(start=rt.State(q=np.asarray(problem.phases[0].start_bounds.lower[:2]) + 0.01, v=0))
    from_whole = rt.plan(nearby, guess=whole, **options)
    from_released = rt.plan(nearby, guess=released(whole), **options)
    assert from_released.objective == pytest.approx(from_whole.objective, rel=1e-9)
    assert from_released.iterations == from_whole.iterations


def test_a_plan_lets_go_of_its_program_unless_asked() -> None:
    kept = rt.plan(swing(), rt.Mesh(8), keep_program=True)
    program = weakref.ref(kept.multipliers.origin.nlp)
    assert program() is not None
    lean = released(kept)
    del kept
    gc.collect()
    assert program() is None
    assert isinstance(rt.plan(swing(), rt.Mesh(8)).multipliers, KeptMultipliers)
    assert lean.multipliers.rows.size == lean.multipliers.sizes[0]


@pytest.mark.parametrize(
    "copied", [copy.copy, copy.deepcopy, lambda value: cloudpickle.loads(cloudpickle.dumps(value))]
)
def test_copies_of_a_solution_have_its_polynomials_costates_and_gains(copied) -> None:
    whole = rt.plan(swing(), rt.Mesh(8), keep_program=True)
    other: Solution = copied(whole)
    times = np.linspace(0, whole.duration, 9)
    assert np.array_equal(other.at(times).tau, whole.at(times).tau)
    assert isinstance(other.multipliers, KeptMultipliers)
    assert np.allclose(other.duals[0].costate(times), whole.duals[0].costate(times), rtol=1e-9)
    assert np.allclose(other.gains.at(0.1), whole.gains.at(0.1), rtol=1e-9)


def test_a_motion_among_obstacles_takes_its_costates_along() -> None:
    arm = rt.load("two_link_arm")
    ball = rt.obstacles.Sphere(0.1, position=(0.9, 0.0, 0.4))
    clear = rt.CollisionFree([ball], self_collision=False)
    ends = rt.State(q=[-0.5, 0.3], v=0), rt.State(q=[0.8, 0.2], v=0)
    problem = rt.Problem([rt.Phase(arm, 1.0, *ends, rt.Effort(), constraints=[clear])])
    whole = rt.plan(problem, rt.Mesh(8), check=False)
    other = attached(cloudpickle.loads(cloudpickle.dumps(detached(whole, problem))), problem)
    assert np.array_equal(other.multipliers.rows, whole.multipliers.rows)
    assert len(other.duals) == len(whole.duals)
