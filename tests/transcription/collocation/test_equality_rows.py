"""Rows of path equalities with another value than zero, and on meshes of several schemes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.transcription.transcribe import transcribe
from tests.transcription.collocation.test_index_reduction import ALONE, diagonal, moved, places


@pytest.mark.parametrize("value", [0.5, -2.0])
def test_an_equality_with_another_value_has_its_rows_at_the_same_places(value: float) -> None:
    """Ends at rest on x - y = value determine the rate there, whatever the value."""
    ends = {"start": (value, 0, 0, 0), "end": (1 + value, 1, 0, 0)}
    nlp, zero = (
        transcribe(rt.Problem([each]), rt.Mesh(3)) for each in (moved(diagonal(value=value), **ends), moved(diagonal()))
    )
    for name in ("diagonal", "rate of diagonal", "rate 2 of diagonal"):
        np.testing.assert_allclose(places(nlp, name), places(zero, name))
    open_start = moved(diagonal(value=value), start=(None, 0, 0, None), end=ends["end"])
    solution = rt.plan(open_start, rt.Mesh(6, rt.schemes.RadauIIA(3)), solver=ALONE, progress=False)
    assert solution.objective == pytest.approx(60.0, rel=1e-8)
    assert solution.at(0.0).x["x"] == pytest.approx(value, abs=1e-8)


@pytest.mark.parametrize(
    "schemes",
    [
        [rt.schemes.RadauIIA(3), rt.HermiteSimpson(), rt.schemes.GaussLegendre(3)],
        [rt.schemes.GaussLegendre(3), rt.schemes.RadauIIA(3), rt.HermiteSimpson()],
        [rt.HermiteSimpson(), rt.schemes.GaussLegendre(3), rt.schemes.RadauIIA(3)],
    ],
    ids=["Gauss last", "Simpson last", "Radau last"],
)
def test_intervals_of_several_schemes_hold_the_equality_to_the_end(schemes: list[Any]) -> None:
    mesh = rt.Mesh([0, 0.3, 0.6, 1], schemes)
    for end in ((1, 1, 0, 0), (1, None, None, 0)):
        solution = rt.plan(moved(diagonal(), end=end), mesh, solver=ALONE, progress=False)
        assert solution.objective == pytest.approx(60.0, rel=1e-8)
        assert not solution.violations()
