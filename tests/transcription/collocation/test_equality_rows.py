"""Rows of path equalities with another value than zero, and on meshes of several schemes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.dynamics.row import Row
from robotraj.transcription.collocation.index_reduction import carried_equalities, rate_row
from tests.programs import nlp_of
from tests.transcription.collocation.test_index_reduction import ALONE, diagonal, effort, moved, places, plane


@pytest.mark.parametrize("value", [0.5, -2.0])
def test_an_equality_with_another_value_has_its_rows_at_the_same_places(value: float) -> None:
    """Ends at rest on x - y = value determine the rate there, whatever the value."""
    ends = {"start": (value, 0, 0, 0), "end": (1 + value, 1, 0, 0)}
    nlp, zero = (
        nlp_of(rt.Problem([each]), rt.Mesh(3)) for each in (moved(diagonal(value=value), **ends), moved(diagonal()))
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


RADAU, SIMPSON, GAUSS, TRAPEZOID = (
    rt.schemes.RadauIIA(3),
    rt.HermiteSimpson(),
    rt.schemes.GaussLegendre(3),
    rt.schemes.Trapezoidal(),
)


@pytest.mark.parametrize(
    ("schemes", "held", "rates"),
    [
        # A fixed end determines both rows at the last Gauss point, 0.955.
        ((RADAU, SIMPSON, GAUSS), [0.047, 0.3, 0.6, 0.645], [0.3, 0.6]),
        ((GAUSS, RADAU, SIMPSON), [0.034, 0.266, 0.347, 0.6, 1.0], [0.266, 0.6]),
        ((SIMPSON, GAUSS, RADAU), [0.0, 0.3, 0.334, 0.566, 0.662, 1.0], [0.3, 0.566]),
        # One control of the last interval cannot serve the row before the end and the one at the end.
        ((SIMPSON, SIMPSON, TRAPEZOID), [0.0, 0.3, 1.0], [0.3, 0.6]),
        ((TRAPEZOID, TRAPEZOID, SIMPSON), [0.0, 0.3, 0.6, 1.0], []),
    ],
    ids=["Gauss last", "Simpson last", "Radau last", "trapezoid last", "trapezoids first"],
)
def test_the_last_scheme_decides_which_rows_the_end_determines(
    schemes: tuple[Any, ...], held: list[float], rates: list[float]
) -> None:
    nlp = nlp_of(rt.Problem([moved(diagonal())]), rt.Mesh([0, 0.3, 0.6, 1], schemes))
    np.testing.assert_allclose(places(nlp, "diagonal"), held, atol=1e-3)
    np.testing.assert_allclose(places(nlp, "rate of diagonal"), rates, atol=1e-3)


@pytest.mark.parametrize(
    ("unit", "order", "name", "wanted"),
    [
        ("m", 1, "rate of gap", "m/s"),
        ("m", 2, "rate 2 of gap", "m/s^2"),
        ("", 1, "rate of gap", "1/s"),
        ("rad", 3, "rate 3 of gap", "rad/s^3"),
    ],
)
def test_rates_have_the_unit_and_the_joint_of_their_row(unit: str, order: int, name: str, wanted: str) -> None:
    row = rate_row(Row("gap", unit, 0.3, 0.3, "elbow"), order)
    assert (row.name, row.unit, row.joint, row.lower, row.upper) == (name, wanted, "elbow", 0.0, 0.0)


@pytest.mark.parametrize(
    ("second", "runs_on"),
    [
        (diagonal(), True),
        (diagonal(lambda p: p.x["x"] - p.x["y"] + 0.0), True),
        (diagonal(value=0.5), False),
        (diagonal(lambda p: 2 * p.x["x"] - p.x["y"]), False),
        (diagonal(lambda p: p.x["x"] - p.p["slope"] * p.x["y"]), False),
    ],
    ids=["same", "written otherwise", "another value", "another line", "of a parameter"],
)
def test_an_equality_is_carried_over_a_knot_where_both_phases_hold_the_same(second: Any, runs_on: bool) -> None:
    free = rt.State()
    slope = {"slope": 1.0} if not runs_on else {}
    parts = [
        rt.Phase(plane(), 0.5, free, free, effort(), constraints=[diagonal()]),
        rt.Phase(plane(), 0.5, free, free, effort(), constraints=[second], parameters=slope),
    ]
    problem = rt.Problem(parts, [rt.Continuity(0, 1)])
    assert carried_equalities(parts, 1, problem.bound_links) == (frozenset({0}) if runs_on else frozenset())
    assert carried_equalities(parts, 0, problem.bound_links) == frozenset()
    nlp = nlp_of(problem, rt.Mesh(2))
    entries = [nlp.rows.entries[m] for m in nlp.rows.meaning]
    at_start = {
        str(entry)
        for entry, fraction in zip(entries, nlp.rows.fraction, strict=True)
        if entry.phase == 1 and fraction == 0.0
    }
    # The second rate determines the control at the start in both cases.
    assert ("rate of diagonal" in at_start) is not runs_on
