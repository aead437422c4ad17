"""The adaptive mesh reaches 1e-6 with at most a quarter of the points of a uniform mesh of the same scheme."""

from __future__ import annotations

import pytest
from adaptive import INTERVALS, Reach, adaptive, cases, needed, uniform
from problems.case import Case

CASES = list(cases())


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_the_adaptive_mesh_reaches_the_tolerance(case: Case) -> None:
    assert adaptive(case).error <= 1e-6


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_uniform_mesh_of_four_times_the_points_misses_it(case: Case) -> None:
    points = 4 * adaptive(case).points
    reach = uniform(case, (points + 2) // 3 | 1)
    assert reach.points >= points
    assert reach.error > 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_the_uniform_mesh_that_reaches_it_has_four_times_the_points(case: Case) -> None:
    reach = needed(case)
    assert reach.error <= 1e-6
    assert 4 * adaptive(case).points <= reach.points


def test_needed_takes_the_mesh_from_which_on_all_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    """A coarse mesh that is lucky does not count."""
    errors = dict(zip(INTERVALS, [1e-3, 1e-7, 1e-5] + [1e-8] * (len(INTERVALS) - 3), strict=True))
    monkeypatch.setattr("adaptive.uniform", lambda case, intervals: Reach(3 * intervals, errors[intervals]))
    assert needed(CASES[0]).points == 3 * INTERVALS[3]
