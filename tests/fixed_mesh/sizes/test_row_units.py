"""The same constraint in any unit gives the same plan and the same verdict."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import robotraj as rt

FACTORS, LENGTHS = (1e-6, 1.0, 1e6), (1e-3, 1.0)
ROWS: dict[str, tuple[Callable[[Any, float], Any], float]] = {
    "speed": (lambda p, d: p.x["v"] / d - 1.2, 15.3605),
    "force": (lambda p, d: p.u["u"] / d - 4.5, 12.1503),
    "power": (lambda p, d: p.x["v"] * p.u["u"] / d**2 - 3.0, 12.0283),
}
"""Rows that are at most 0, and the least effort by d^2 of a mass of 1 kg that moves by d in 1 s."""


def reach(row: Callable[[Any, float], Any], factor: float, length: float, lower: float | None = None) -> rt.Phase:
    """From rest to rest, with factor times a row at most 0."""
    mass = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    limit = rt.PathConstraint(lambda p: factor * row(p, length), lower=lower, upper=0.0, name="limit")
    return rt.Phase(mass, 1.0, rt.State([0, 0]), rt.State([length, 0]), rt.Effort(), constraints=[limit])


@pytest.mark.parametrize("name", ROWS)
@pytest.mark.parametrize("length", LENGTHS)
@pytest.mark.parametrize("factor", FACTORS)
def test_a_row_written_in_any_unit_gives_the_same_plan_and_verdict(name: str, length: float, factor: float) -> None:
    """Power limits of 3e-6 W, written times 1e-6, had no effect on plans that were called proved."""
    row, optimum = ROWS[name]
    solution = rt.plan(reach(row, factor, length), progress=False)
    assert solution.objective / length**2 == pytest.approx(optimum, rel=1e-3)
    assert solution.proof is not None and solution.proof.holds
    assert rt.validate(solution).passed


@pytest.mark.parametrize("lower", [None, -1e9])
@pytest.mark.parametrize("name", ROWS)
@pytest.mark.parametrize("factor", FACTORS)
def test_a_violation_by_a_hundredth_of_the_range_of_a_row_is_noticed(
    name: str, factor: float, lower: float | None
) -> None:
    """The motion of a looser limit fails under the tighter one, whose other side may be a number far away."""
    row, _ = ROWS[name]
    solution = rt.plan(reach(row, factor, 1.0, lower), progress=False)
    sample = solution.at(np.linspace(0.0, 1.0, 2001))
    values = row(sample, 1.0)
    by = 0.01 * float(np.ptp(values))

    def tighter(point: Any, length: float) -> Any:
        return row(point, length) + by

    judged = reach(tighter, factor, 1.0, lower)
    part = replace(solution.phases[0], phase=judged)
    lie = replace(solution, problem=rt.Problem([judged]), phases=(part,))
    report = rt.validate(lie)
    assert not report.passed
    assert any(breach.name == "limit" for breach in report.breaches)


@pytest.mark.parametrize("factor", FACTORS)
@pytest.mark.parametrize("radius", [0.01, 0.2])
def test_a_circle_to_keep_out_of_is_kept_out_of_by_a_bound_of_zero(factor: float, radius: float) -> None:
    """The way from (-1, 0.001) to (1, 0) leads through the middle of the circle."""
    point = rt.System(["x", "y"], ["u", "w"], lambda p: [p.u["u"], p.u["w"]])
    circle = rt.PathConstraint(lambda p: factor * (p.x["x"] ** 2 + p.x["y"] ** 2 - radius**2), lower=0.0)
    phase = rt.Phase(point, 1.0, rt.State([-1, 1e-3]), rt.State([1, 0]), rt.Effort(), constraints=[circle])
    solution = rt.plan(phase, progress=False)
    sample = solution.at(np.linspace(0.0, 1.0, 4001))
    assert np.hypot(sample.x["x"], sample.x["y"]).min() > radius * (1 - 1e-3)
    assert rt.validate(solution).passed


def test_a_phase_that_hardly_moves_is_measured_by_the_whole_motion() -> None:
    """Where a mass dwells, its speed is a rounding error, and so is the violation of a bound of 0."""
    mass = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    forwards = rt.PathConstraint(lambda p: p.x["v"], lower=0.0)
    move, dwell = (
        rt.Phase(mass, 1.0, rt.State([a, 0]), rt.State([0, 0]), rt.Effort(), constraints=[forwards]) for a in (-1, 0)
    )
    solution = rt.plan(rt.Problem([move, dwell], links=[rt.Continuity(0, 1)]), progress=False)
    assert solution.objective == pytest.approx(12.0, rel=1e-4)
    assert rt.validate(solution).passed
