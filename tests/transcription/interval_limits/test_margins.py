"""Margins: limits of controls that are lower on single intervals."""

from __future__ import annotations

import numpy as np

import robotraj as rt
from robotraj.transcription.extract import extract
from robotraj.transcription.interval_limits.margins import LimitedInterval, with_margins
from robotraj.transcription.transcribe import transcribe


def pushed() -> rt.Phase:
    block = rt.System(states=["x", "v"], controls=["u"], dynamics=lambda p: [p.x["v"], p.u["u"]])
    return rt.Phase(
        block,
        (0.1, 9.0),
        rt.State({"x": 0, "v": 0}),
        rt.State({"x": 1, "v": 0}),
        rt.Duration(),
        controls={"u": rt.between(-1, 1)},
    )


def test_a_control_keeps_a_margin_on_its_interval_alone() -> None:
    phase = pushed()
    place = next(LimitedInterval(0, 2, row.number) for row in phase.rows if row.variable == "u")
    limits = rt.interval_limits.BernsteinBounds(controls=True)
    nlp = with_margins(transcribe(rt.Problem([phase]), rt.Mesh(8), interval_limits=limits), {place: 0.25})
    (trajectory,) = extract(nlp, rt.Ipopt().solve(nlp).w)
    inside = trajectory.u.inside(np.linspace(0, 1, 21))[:, :, 0]
    assert np.max(np.abs(inside[2])) <= 0.75 + 1e-6
    assert np.max(np.abs(inside[0])) > 0.99


def test_margins_do_not_add_up_and_share_the_functions() -> None:
    problem = rt.Problem([pushed()])
    limits = rt.interval_limits.BernsteinBounds(controls=True)
    nlp = transcribe(problem, rt.Mesh(4), interval_limits=limits)
    phase = problem.phases[0]
    number = next(row.number for row in phase.rows if row.variable == "u")
    once = with_margins(nlp, {LimitedInterval(0, 1, number): 0.1})
    twice = with_margins(once, {LimitedInterval(0, 1, number): 0.1})
    assert np.array_equal(once.rows.upper, twice.rows.upper)
    assert np.array_equal(once.variables.upper, twice.variables.upper)
    assert once.rows.upper.tolist() != nlp.rows.upper.tolist()
    assert once.blocks is nlp.blocks and once.loose_rows is nlp.rows


def test_a_margin_bounds_no_column_that_had_no_bound() -> None:
    """A solver that works by stages keeps its program: middles of intervals are bounded by coefficients alone."""
    limits = rt.interval_limits.BernsteinBounds(controls=True)
    nlp = transcribe(rt.Problem([pushed()]), rt.Mesh(4, rt.HermiteSimpson()), interval_limits=limits)
    number = next(row.number for row in nlp.problem.phases[0].rows if row.variable == "u")
    tight = with_margins(nlp, {LimitedInterval(0, 1, number): 0.1})
    assert np.array_equal(np.isfinite(tight.variables.upper), np.isfinite(nlp.variables.upper))
    assert np.sum(tight.variables.upper < nlp.variables.upper) == 2  # the ends of the interval
    assert not np.isfinite(nlp.variables.upper).all()
