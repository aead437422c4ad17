"""Derivatives of the rows of links, against finite differences."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj._util.arrays import Array
from tests.programs import nlp_of

CART = rt.System(
    ["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"] / point.p["m"] - ca.sin(point.x["x"]) * point.t]
)


def problem() -> tuple[rt.Problem, list[rt.Mesh]]:
    """Every kind of link on three phases of other meshes and schemes, with an integral row."""
    spent = rt.constraints.IntegralConstraint(lambda point: point.u["u"] ** 2 * point.p["m"], upper=9.0)
    phases = [
        rt.Phase(
            CART,
            (0.5, 2),
            rt.State({"x": rt.between(-1, 1)}),
            objective=rt.Lagrange(lambda point: point.u["u"] ** 4),
            constraints=[spent],
            parameters={"m": rt.between(0.5, 2)},
        )
        for _ in range(3)
    ]

    def event(a: rt.links.Ends, b: rt.links.Ends, c: rt.links.Ends) -> list[object]:
        return [a.start.x["x"] * b.end.x["v"] ** 3 * c.end.p["m"], ca.sin(c.end.t) * a.end.x["v"] + b.start.t**2]

    links = [
        rt.Continuity(0, 1),
        rt.links.Jump(1, 2, {"v": rt.between(-1, 1)}),
        rt.links.Linkage((0, 1, 2), event, [-1, 0], [1, 3]),
        rt.links.Linkage((1,), lambda b: b.end.x["x"] * b.start.x["v"]),
        rt.links.EqualDuration(0, 2),
        rt.links.SameParameter("m"),
        rt.Periodic({"x": 1.0}),
        rt.Mirror({"x": "x"}, displacement={"v": None}, first=1),
    ]
    return rt.Problem(phases, links), [
        rt.Mesh(2),
        rt.Mesh(1, rt.schemes.RadauIIA(2)),
        rt.Mesh(2, rt.schemes.Trapezoidal()),
    ]


@pytest.fixture(scope="module")
def nlp() -> rt.transcription.Nlp:
    return nlp_of(*problem())


@pytest.fixture(scope="module")
def place(nlp: rt.transcription.Nlp) -> Array:
    return nlp.guess + np.random.default_rng(11).uniform(-0.3, 0.3, len(nlp.guess))


def differences(function: Callable[[Array], Array], w: Array) -> Array:
    """Central differences, once extrapolated."""

    def column(e: Array, h: float) -> Array:
        return (function(w + h * e) - function(w - h * e)) / (2 * h)

    return np.column_stack([(4 * column(e, 1e-4) - column(e, 2e-4)) / 3 for e in np.eye(len(w))])


def test_jacobian(nlp: rt.transcription.Nlp, place: Array) -> None:
    found = nlp.jacobian(place).toarray()
    np.testing.assert_allclose(found, differences(nlp.values, place), atol=1e-8)
    # Every phase's columns are read by the rows of the links.
    links = [i for i, name in enumerate(nlp.row_names) if "linkage" in name]
    assert len(links) == 3 and np.count_nonzero(found[links]) >= 8


def test_hessian(nlp: rt.transcription.Nlp, place: Array) -> None:
    multipliers = np.random.default_rng(5).normal(size=len(nlp.rows))

    def gradient(w: Array) -> Array:
        return nlp.gradient(w) + nlp.jacobian(w).T @ multipliers

    found = nlp.hessian(place, multipliers, 1.0).toarray()
    np.testing.assert_allclose(found, differences(gradient, place), atol=1e-6)


def test_rows_are_the_expressions_of_the_ends(nlp: rt.transcription.Nlp, place: Array) -> None:
    """Written out by hand from the layout of the unknowns."""
    values = nlp.values(place)
    knots = [layout.knots for layout in nlp.layouts]
    (x0, _), (x1, v1) = place[knots[0][0]], place[knots[0][-1]]
    (y0, w0), (y1, w1) = place[knots[1][0]], place[knots[1][-1]]
    rows = {
        "linkage[0]": x0 * w1**3 * _parameter(nlp, place, 2),
        "linkage": y1 * w0,
        "continuity, x": y0 - x1,
        "continuity, v": w0 - v1,
    }
    for label, expected in rows.items():
        i = next(i for i, name in enumerate(nlp.row_names) if f": {label}," in f"{name},")
        assert values[i] == pytest.approx(expected, rel=1e-12), label


def _parameter(nlp: rt.transcription.Nlp, place: Array, phase: int) -> float:
    found = [i for i, name in enumerate(nlp.variable_names) if "parameter" in name]
    return float(place[found[phase]])
