"""Margins: limits of controls that are lower on single intervals."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj.problem.phase_row import Kind
from robotraj.transcription.extract import extract
from robotraj.transcription.interval_limits.margins import with_margins
from robotraj.transcription.interval_limits.row_places import LimitedInterval
from tests.programs import nlp_of


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
    nlp = with_margins(nlp_of(rt.Problem([phase]), rt.Mesh(8), interval_limits=limits), {place: 0.25})
    (trajectory,) = extract(nlp, rt.Ipopt().solve(nlp).w)
    inside = trajectory.u.inside(np.linspace(0, 1, 21))[:, :, 0]
    assert np.max(np.abs(inside[2])) <= 0.75 + 1e-6
    assert np.max(np.abs(inside[0])) > 0.99


def test_margins_do_not_add_up_and_share_the_functions() -> None:
    problem = rt.Problem([pushed()])
    limits = rt.interval_limits.BernsteinBounds(controls=True)
    nlp = nlp_of(problem, rt.Mesh(4), interval_limits=limits)
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
    nlp = nlp_of(rt.Problem([pushed()]), rt.Mesh(4, rt.HermiteSimpson()), interval_limits=limits)
    number = next(row.number for row in nlp.problem.phases[0].rows if row.variable == "u")
    tight = with_margins(nlp, {LimitedInterval(0, 1, number): 0.1})
    assert np.array_equal(np.isfinite(tight.variables.upper), np.isfinite(nlp.variables.upper))
    assert np.sum(tight.variables.upper < nlp.variables.upper) == 2  # the ends of the interval
    assert not np.isfinite(nlp.variables.upper).all()


def jerky(duration: float | tuple[float, float]) -> rt.Phase:
    robot = rt.load("block", limits={"effort": 1e3, "velocity": 1e3})
    rest, jerk = rt.constraints.JointAcceleration(0.0), rt.constraints.JointJerk(rt.between(-4, 4))
    start, end = rt.State(q=0, v=0), rt.State(q=1, v=0)
    return rt.Phase(robot, duration, start, end, rt.Duration(), constraints=[jerk, rt.AtStart(rest), rt.AtEnd(rest)])


@pytest.mark.parametrize("duration", [2.0, (1.0, 3.0)])
def test_a_margin_of_a_rate_holds_in_its_unit_whether_or_not_rows_are_multiplied_by_the_duration(duration) -> None:
    """With T free, rows sum D y / L <= u T are shifted by the margin times T of the guess."""
    nlp = nlp_of(rt.Problem([jerky(duration)]), rt.Mesh(6))
    phase, layout = nlp.problem.phases[0], nlp.layouts[0]
    row = next(row for row in phase.rows.rows if row.kind is Kind.RATE)
    tight = with_margins(nlp, {LimitedInterval(0, 2, row.number): 0.5})
    seconds = 1.0 if layout.duration.column is None else layout.duration.of(nlp.guess)
    for sign, before, after in ((1, nlp.rows.lower, tight.rows.lower), (-1, nlp.rows.upper, tight.rows.upper)):
        change = np.zeros(len(before))
        bounded = np.isfinite(before)
        change[bounded] = sign * (after[bounded] - before[bounded])
        assert set(np.round(change[change != 0.0], 12)) == {round(0.5 * seconds, 12)}
        at = nlp.rows.fraction[change != 0.0]
        assert at.min() >= 2 / 6 - 1e-12
        assert at.max() <= 3 / 6 + 1e-12


def test_no_margin_and_a_margin_as_wide_as_the_limits_change_nothing() -> None:
    limits = rt.interval_limits.BernsteinBounds(controls=True)
    nlp = nlp_of(rt.Problem([pushed()]), rt.Mesh(4), interval_limits=limits)
    number = next(row.number for row in nlp.problem.phases[0].rows if row.variable == "u")
    assert with_margins(nlp, {}) is nlp
    wide = with_margins(nlp, {LimitedInterval(0, 1, number): 1.0})
    assert np.array_equal(wide.rows.upper, nlp.rows.upper)
    assert np.array_equal(wide.variables.upper, nlp.variables.upper)


def test_a_margin_of_a_state_tightens_the_knots_of_its_interval_and_its_coefficients() -> None:
    phase = pushed().with_(states={"v": rt.between(-2, 2)})
    nlp = nlp_of(rt.Problem([phase]), rt.Mesh(4), interval_limits=rt.interval_limits.BernsteinBounds())
    number = next(row.number for row in phase.rows if row.variable == "v")
    tight = with_margins(nlp, {LimitedInterval(0, 1, number): 0.25})
    layout = nlp.layouts[0]
    changed = np.flatnonzero(tight.variables.upper != nlp.variables.upper)
    assert changed.tolist() == sorted(layout.knots[1:3, 1].tolist())
    assert tight.variables.upper[changed].tolist() == [1.75] * 2
    assert tight.variables.lower[changed].tolist() == [-1.75] * 2
    rows = np.flatnonzero(tight.rows.upper != nlp.rows.upper)
    assert rows.size and np.all((nlp.rows.fraction[rows] > 0.25) & (nlp.rows.fraction[rows] < 0.5))
    assert tight.rows.upper[rows].tolist() == [1.75] * rows.size
    assert tight.rows.lower[rows].tolist() == [-1.75] * rows.size


def test_given_ends_beyond_a_margin_stay_as_they_are() -> None:
    phase = pushed().with_(states={"v": rt.between(-1, 1)}, end=rt.State({"x": 1, "v": 0.9}))
    nlp = nlp_of(rt.Problem([phase]), rt.Mesh(4))
    number = next(row.number for row in phase.rows if row.variable == "v")
    tight = with_margins(nlp, {LimitedInterval(0, 3, number): 0.25})
    last = nlp.layouts[0].knots[-1, 1]
    assert tight.variables.lower[last] == tight.variables.upper[last] == 0.9
    assert np.all(tight.variables.lower <= tight.variables.upper)


def test_the_guess_is_within_tighter_bounds() -> None:
    phase = pushed().with_(states={"v": rt.between(-1, 1)})
    nlp = nlp_of(rt.Problem([phase]), rt.Mesh(4))
    number = next(row.number for row in phase.rows if row.variable == "v")
    at = nlp.layouts[0].knots[1:3, 1]
    nlp.guess[at] = [1.0, -1.0]
    tight = with_margins(nlp, {LimitedInterval(0, 1, number): 0.25})
    assert tight.guess[at].tolist() == [0.75, -0.75]
