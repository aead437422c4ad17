"""A plan with feet on the ground ends early, with its cause, where no motion exists."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

import robotraj as rt
from robotraj.fixed_mesh.coarse import CoarseSolves
from robotraj.fixed_mesh.diagnosis.infeasibility_check import (
    ITERATIONS,
    NEAR,
    Excluded,
    InfeasibilityCheck,
)
from robotraj.fixed_mesh.diagnosis.unreached_ends import unreached_ends
from robotraj.solution.conflict import Conflict, are_certain
from robotraj.solvers.base import Iteration

MODULE = "robotraj.fixed_mesh.diagnosis.infeasibility_check"
FEET = ("FL_FOOT", "FR_FOOT", "HL_FOOT", "HR_FOOT")


def rising(height: float) -> rt.Problem:
    """Raise the root of a standing quadruped, whose feet stay."""
    robot = rt.load("solo12", root="floating")
    stand = np.array(rt.gait.stand(robot, FEET))
    ends = rt.State(q=stand, v=0), rt.State(q={"root_z": float(stand[2]) + height}, v=0)
    return rt.Problem([rt.Phase(robot, 0.5, *ends, contacts=[rt.PointContact(foot) for foot in FEET])])


class Unsolved(CoarseSolves):
    """No relaxed problem is solved."""

    def __init__(self) -> None:
        pass

    def solve(self, problem: rt.Problem, guess: object) -> rt.Solution:
        pytest.fail("a relaxed problem was solved")


def test_feet_that_cannot_stay_are_named_before_other_solvers_are_tried() -> None:
    solution = rt.plan(rising(0.3), check=False)
    assert solution.status.name == "INFEASIBLE" and solution.iterations <= ITERATIONS
    assert solution.conflicts[0].name.startswith("contact position")
    assert "quaternion" not in str(solution.conflicts[0])
    # Legs of 0.32 m below hips at 0.24 m rise by less than a decimetre.
    assert 0.1 < abs(solution.conflicts[0].needed) < 0.3


def test_conflicts_are_looked_for_once_where_iterations_begin_again(monkeypatch: pytest.MonkeyPatch) -> None:
    looked = []

    def found(*_: object, **__: object) -> tuple[Conflict, ...]:
        looked.append(1)
        return ()

    monkeypatch.setattr(f"{MODULE}.conflicts_of", found)
    check = InfeasibilityCheck(rising(0.02), Unsolved(), None)
    for number in (0, 1, 2):
        check(Iteration(number, 0.0, 1.0))
    assert not looked
    for number in (0, 1, ITERATIONS, 0):
        check(Iteration(number, 0.0, 1.0))
    assert len(looked) == 1 and not check.conflicts


@pytest.mark.parametrize(("violation", "number"), [(0.5 * NEAR, ITERATIONS), (2.0 * NEAR, ITERATIONS // 2)])
def test_conflicts_are_looked_for_earlier_far_from_any_motion(
    monkeypatch: pytest.MonkeyPatch, violation: float, number: int
) -> None:
    looked = []
    monkeypatch.setattr(f"{MODULE}.conflicts_of", lambda *_, **__: looked.append(1) or ())
    check = InfeasibilityCheck(rising(0.02), Unsolved(), None)
    check(Iteration(number - 1, 0.0, violation))
    assert not looked
    check(Iteration(number, 0.0, violation))
    assert looked


def test_a_certain_conflict_ends_the_solve(monkeypatch: pytest.MonkeyPatch) -> None:
    certain = Conflict("phase", "effort limit, elbow", 0.0, 1.0, 2.0, "N m", 1.0)
    monkeypatch.setattr(f"{MODULE}.conflicts_of", lambda *_, **__: (certain,))
    check = InfeasibilityCheck(rising(0.02), Unsolved(), None)
    with pytest.raises(Excluded):
        check(Iteration(ITERATIONS, 0.0, 1.0))
    assert check.conflicts == (certain,)


def test_a_motion_that_is_found_ends_the_solve_and_starts_the_next(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = rising(0.02)
    motion = rt.plan(problem, rt.Mesh(4))
    monkeypatch.setattr(f"{MODULE}.narrowed_speeds", lambda *_: ((), motion))
    check = InfeasibilityCheck(problem, Unsolved(), None)
    for _ in range(3 * ITERATIONS - 1):
        check(Iteration(1, 0.0, 1.0))
    with pytest.raises(Excluded):
        check(Iteration(1, 0.0, 1.0))
    assert check.motion is motion and not check.conflicts
    monkeypatch.setattr(f"{MODULE}.ITERATIONS", 1)
    solution = rt.plan(problem, rt.Mesh(6))
    assert solution.success and solution.iterations < 15


def test_the_iterate_of_the_solver_is_the_first_start(monkeypatch: pytest.MonkeyPatch) -> None:
    # Stairs of go1, whose plan is proved, were refused: no other start reached the footholds.
    problem = rising(0.02)
    motion = [part.trajectory for part in rt.plan(problem, rt.Mesh(4)).phases]

    def another(problem: rt.Problem) -> Iterator[np.ndarray]:
        pytest.fail("another start was needed")
        yield

    monkeypatch.setattr("robotraj.fixed_mesh.diagnosis.unreached_ends._starts", another)
    assert not unreached_ends(problem, near=motion)


def test_searches_that_do_not_agree_exclude_no_motion(monkeypatch: pytest.MonkeyPatch) -> None:
    # Interrupted searches end at sums far apart: stairs of talos_legs, whose plan is proved, were refused for one.
    problem = rising(0.3)
    assert are_certain(unreached_ends(problem))
    monkeypatch.setattr("robotraj.fixed_mesh.diagnosis.unreached_ends.PATIENCE", 2)
    assert unreached_ends(problem) and not are_certain(unreached_ends(problem))
