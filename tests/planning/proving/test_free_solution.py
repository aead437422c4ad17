"""The search for a solution without overlaps: what follows from a free one, and from one that overlaps."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.planning.proving.free_solution import REACH, SHALLOW, FreeSearch
from robotraj.problem.clearance.own_shapes import MARGIN, own_shapes
from robotraj.transcription.clearance.surface_rows import FRACTIONS, NearPair, NearSurfaces

DEEP = 2.0 * SHALLOW
FIRST, LAST = np.array([0, -1.5, 0.5, 0.6, 0, 0]), np.array([0, -1.5, 0.5, 2.4, 0, 0])


def straight(fractions: np.ndarray) -> np.ndarray:
    """Turns the wrist through the forearm, which overlap between 1.2 and 1.9 rad."""
    return FIRST + np.reshape(fractions, (-1, 1)) * (LAST - FIRST)


def aside(fractions: np.ndarray) -> np.ndarray:
    """The same with the next wrist joint bent."""
    return straight(fractions) + np.outer(np.sin(np.pi * np.asarray(fractions)), [0, 0, 0, 0, 1.0, 0])


class Solved:
    """What a state reads of a solution."""

    def __init__(self, objective: float) -> None:
        self.objective = objective


@pytest.fixture(scope="module")
def begin() -> FreeSearch:
    phase = rt.Phase(rt.load("ur5"), 1.0, rt.State(q=FIRST, v=0), rt.State(q=LAST, v=0), rt.Effort())
    problem = rt.Problem([phase])
    guess: Any = None
    return FreeSearch.begin(problem, [own_shapes(phase)], [aside], True, [{9}], guess)


def rows_of(state: FreeSearch) -> NearSurfaces:
    (surfaces,) = state.surfaces
    assert surfaces is not None
    return surfaces


def is_along(each: NearPair, motion: Any) -> bool:
    return np.array_equal(each.configurations, motion(FRACTIONS))


def after(state: FreeSearch, objective: float, motion: Any, hit: dict[int, float]) -> FreeSearch:
    solution: Any = Solved(objective)
    return state.respond(solution, [motion], [hit])


def test_rows_are_fixed_along_the_free_motion_everywhere(begin: FreeSearch) -> None:
    (each,) = rows_of(begin).pairs
    assert (each.pair, each.reach) == (9, np.inf) and is_along(each, aside)


def test_rows_along_a_motion_are_fixed_once_for_all_solves_along_it(begin: FreeSearch) -> None:
    (known,) = rows_of(begin).pairs
    again = rows_of(after(begin, 3.0, straight, {9: DEEP})).pairs
    assert again[0] is known and len(again) == 2
    (other,) = rows_of(after(begin, 2.0, aside, {})).pairs
    assert other is not known


def test_a_pair_without_rows_gets_some_along_the_free_motion_first(begin: FreeSearch) -> None:
    found = after(begin, 3.0, straight, {5: DEEP})
    assert [each.pair for each in rows_of(found).pairs] == [5, 9]
    assert all(is_along(each, aside) for each in rows_of(found).pairs)
    assert found.best is None and not found.is_over and begin.pairs == (frozenset({9}),)


def test_a_pair_with_rows_gets_more_where_the_motions_part_with_margins_beyond_its_depth(begin: FreeSearch) -> None:
    twice = after(after(begin, 3.0, straight, {9: DEEP}), 3.0, straight, {9: DEEP})
    along, *more = rows_of(twice).pairs
    assert is_along(along, aside) and along.margin == MARGIN
    assert [(each.pair, each.reach) for each in more] == [(9, REACH), (9, REACH)]
    assert [each.margin for each in more] == pytest.approx([2 * MARGIN, 3 * MARGIN + DEEP])


def test_a_shallow_overlap_is_pushed_out_from_where_it_is_a_deep_one_from_the_free_motion(begin: FreeSearch) -> None:
    assert after(begin, 3.0, straight, {9: DEEP}).start is begin.start
    pushed = after(begin, 3.0, straight, {9: 0.5 * SHALLOW}).start
    assert isinstance(pushed, Solved) and pushed.objective == 3.0


def test_a_free_solution_releases_all_rows_but_those_along_itself(begin: FreeSearch) -> None:
    overlapped = after(begin, 3.0, straight, {9: DEEP})
    found = after(overlapped, 2.0, aside, {})
    assert len(rows_of(found).pairs) == 1 and found.start is found.best and found.best.objective == 2.0
    assert found.behind is overlapped and not found.is_over


def test_a_gain_below_a_hundredth_ends_the_search_with_the_best_solution(begin: FreeSearch) -> None:
    first = after(begin, 2.0, aside, {})
    assert not after(first, 1.97, aside, {}).is_over
    over = after(first, 1.99, aside, {})
    assert over.is_over and over.best is first.best and over.motions == first.motions


@pytest.mark.parametrize(("cost", "is_over"), [(0.019, True), (0.021, False)])
def test_a_free_solution_whose_rows_cost_less_than_a_hundredth_ends_the_search(
    begin: FreeSearch, cost: float, is_over: bool
) -> None:
    solution: Any = Solved(2.0)
    found = begin.respond(solution, [aside], [{}], cost)
    assert found.is_over is is_over and found.best is solution


def test_a_motion_that_gains_below_a_hundredth_although_it_overlaps_ends_the_search_with_rows_against_it(
    begin: FreeSearch,
) -> None:
    first = after(begin, 2.0, aside, {})
    assert not after(first, 1.97, straight, {9: DEEP}).is_over
    over = after(first, 1.99, straight, {9: DEEP})
    assert over.is_over and over.best is first.best
    assert len(rows_of(over).pairs) == len(rows_of(first).pairs) + 1
