"""The problems of the examples, without their plans."""

from __future__ import annotations

import contextlib
import runpy
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from tests.programs import nlp_of

EXAMPLES = Path(__file__).parents[1] / "examples"


class Planned(Exception):
    """Ends an example at its first plan."""


@cache
def first_call(stem: str) -> tuple[rt.Problem | rt.Phase, dict[str, Any]]:
    """Problem and options of the first plan of an example."""
    calls: list[tuple[rt.Problem | rt.Phase, dict[str, Any]]] = []

    def recorded(problem: rt.Problem | rt.Phase, *meshes: rt.Mesh, **options: object) -> None:
        calls.append((problem, {**({"mesh": meshes[0]} if meshes else {}), **options}))
        raise Planned

    with pytest.MonkeyPatch.context() as patch, contextlib.suppress(Planned):
        patch.setattr(rt, "plan", recorded)
        runpy.run_path(str(EXAMPLES / f"{stem}.py"), run_name="__main__")
    return calls[0]


def assert_one_problem(one: rt.Problem | rt.Phase, other: rt.Problem | rt.Phase) -> None:
    """Assert that two problems have the same bounds, and the same guess, objective and rows at a random point."""
    first, second = (
        nlp_of(problem, [rt.Mesh(2)] * len(problem.phases))
        for problem in (given if isinstance(given, rt.Problem) else rt.Problem([given]) for given in (one, other))
    )
    for a, b in ((first.rows, second.rows), (first.variables, second.variables)):
        np.testing.assert_array_equal(a.lower, b.lower)
        np.testing.assert_array_equal(a.upper, b.upper)
    np.testing.assert_array_equal(first.guess, second.guess)
    w = first.guess + 0.1 * first.scale * np.random.default_rng(0).normal(size=len(first.guess))
    np.testing.assert_array_equal(first.values(w), second.values(w))
    assert first.objective(w) == second.objective(w)
