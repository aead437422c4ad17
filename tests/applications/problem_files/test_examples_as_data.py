"""Problems in TOML are those of the Python examples beside them."""

from __future__ import annotations

from pathlib import Path

import pytest

import robotraj as rt
from tests.examples import EXAMPLES, assert_one_problem, first_call

FILES = sorted(EXAMPLES.glob("*.toml"))


@pytest.mark.parametrize("file", FILES, ids=lambda path: path.stem)
def test_the_problem_and_the_options_are_those_of_the_example(file: Path) -> None:
    """Equal functions have equal plans: ``test_examples.py`` makes them."""
    problem, options = first_call(file.stem)
    written = rt.load_problem(file)
    expected = problem if isinstance(problem, rt.Problem) else rt.Problem([problem])
    assert str(written.problem) == str(expected)
    assert repr(written.options) == repr(options)
    assert_one_problem(written.problem, problem)


@pytest.mark.slow
def test_a_plan_is_that_of_the_example_to_the_last_digits() -> None:
    problem, options = first_call("05_ur5")
    expected, found = rt.plan(problem, **options), rt.load_problem(EXAMPLES / "05_ur5.toml").plan()
    assert found.success and found.status is expected.status
    assert found.objective == expected.objective
