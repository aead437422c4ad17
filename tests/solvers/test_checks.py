"""Options of solvers are checked when the value is made."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

import robotraj as rt

REFUSED = {
    "tolerance": [0.0, -1e-8, float("nan"), "1e-3", True, None],
    "max_iterations": [0, 1e3, 3_000_000_000, "10", True],
    "time_limit": [0.0, -1.0, "3"],
    "initial_barrier": [0.0, -1.0, "1"],
    "objective_change": [0.0, -1e-3, "1e-3"],
    "threads": [0, 2.5],
}


CASES = [
    (solver, field, value)
    for solver in (rt.Ipopt, rt.InteriorPoint)
    for field, values in REFUSED.items()
    if field in {each.name for each in dataclasses.fields(solver)}
    for value in values
]


@pytest.mark.parametrize(("solver", "field", "value"), CASES)
def test_bad_numbers_are_refused_by_their_names(solver: Any, field: str, value: Any) -> None:
    with pytest.raises(rt.InputError, match=rf"{solver.__name__}\({field}\).*{value!r}"):
        solver(**{field: value})


@pytest.mark.parametrize("solver", [rt.Ipopt, rt.InteriorPoint])
def test_numbers_of_numpy_are_numbers(solver: Any) -> None:
    value = solver(tolerance=np.float32(1e-6), max_iterations=np.int64(50), time_limit=np.float64(3))
    assert value.max_iterations == 50


def test_a_bound_on_iterations_is_never_raised() -> None:
    assert rt.InteriorPoint().at_most(5).max_iterations == 5
    assert rt.Ipopt(max_iterations=3).at_most(5).max_iterations == 3


@pytest.mark.parametrize("solver", [rt.Ipopt, rt.InteriorPoint])
def test_a_mapping_in_place_of_the_first_option_is_told_to_be_keywords(solver: Any) -> None:
    with pytest.raises(rt.InputError, match=rf"options as keywords, such as rt\.{solver.__name__}\(max_iterations="):
        solver({"max_iter": 10})
