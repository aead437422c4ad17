"""Controls that are angles have no whole turns between points."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.transcription.collocation.unwrap_angles import unwrapped
from tests.programs import nlp_of


def boat(**more: Any) -> rt.Phase:
    """Zermelo's boat in a linear current, steered by its heading."""
    system = rt.System(
        ["x", "y"],
        ["heading", "sail"],
        lambda point: [ca.cos(point.u["heading"]) - point.x["y"], ca.sin(point.u["heading"])],
    )
    return rt.Phase(system, 5.0, rt.State([3, -1]), rt.State([0, 0]), rt.Lagrange(lambda p: p.u["sail"] ** 2), **more)


def headings(nlp: rt.transcription.Nlp) -> np.ndarray:
    return np.unique(np.concatenate([run.controls[..., 0].ravel() for run in nlp.layouts[0].runs]))


@pytest.mark.parametrize(
    "scheme", [rt.HermiteSimpson(), rt.schemes.RadauIIA(3), rt.schemes.GaussLegendre(2), rt.schemes.MultipleShooting()]
)
def test_turns_without_effect_on_rows_are_removed(scheme: rt.HermiteSimpson) -> None:
    nlp = nlp_of(rt.Problem([boat()]), rt.Mesh(5, scheme))
    rng = np.random.default_rng(0)
    columns = headings(nlp)
    smooth = nlp.guess.copy()
    smooth[columns] = 1.0 + nlp.variables.fraction[columns]
    wound = smooth.copy()
    wound[columns] += 2 * np.pi * rng.integers(-3, 4, columns.size)
    assert np.ptp(wound[columns]) > np.pi
    found = unwrapped(nlp, wound)
    assert found == pytest.approx(smooth, abs=1e-12)
    assert nlp.values(found) == pytest.approx(nlp.values(wound), abs=1e-12)


def test_turns_that_rows_depend_on_or_bounds_forbid_stay() -> None:
    seen = rt.PathConstraint(lambda point: point.u["heading"], upper=100.0, name="heading")
    for phase in (boat(constraints=[seen]), boat(controls={"heading": rt.between(3, 8)})):
        nlp = nlp_of(rt.Problem([phase]), rt.Mesh(5))
        w = nlp.guess.copy()
        w[headings(nlp)] = np.tile([3.1, 7.9], 6)[:11]
        assert unwrapped(nlp, w) == pytest.approx(w, abs=0)


def test_a_control_that_is_no_angle_may_jump() -> None:
    nlp = nlp_of(rt.Problem([boat()]), rt.Mesh(5))
    w = nlp.guess.copy()
    w[headings(nlp) + 1] = np.tile([0.0, 2 * np.pi], 6)[:11]
    assert unwrapped(nlp, w) is w


def test_a_fastest_descent_by_its_angle_needs_no_bounds() -> None:
    """Without it the directions differ by whole turns between points, and refinement divides these intervals."""
    bead = rt.System(
        ["x", "y", "v"],
        ["angle"],
        lambda point: [
            point.x["v"] * ca.sin(point.u["angle"]),
            point.x["v"] * ca.cos(point.u["angle"]),
            9.81 * ca.cos(point.u["angle"]),
        ],
    )
    solution = rt.plan(
        rt.Phase(bead, (0.1, 10), rt.State([0, 0, 0]), rt.State({"x": 10, "y": 5}), rt.Duration()), tolerance=1e-6
    )
    assert solution.duration == pytest.approx(1.8012954829, rel=1e-8)
    assert len(solution.refinement) <= 3
    angles = solution.at(np.linspace(0, solution.duration, 500)).u["angle"]
    assert np.ptp(angles) < np.pi
