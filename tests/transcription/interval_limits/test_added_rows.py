"""Rows between collocation points, added to an NLP."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.problem.phase_row import Kind
from robotraj.transcription.extract import extract
from robotraj.transcription.interval_limits.added_rows import (
    SPREAD,
    SWINGS,
    exceeded_although_added,
    rows_against_swings,
    rows_to_add,
    with_added_rows,
    with_added_states,
)
from robotraj.transcription.interval_limits.interval_violations import IntervalViolation
from robotraj.transcription.interval_limits.row_places import AddedRow
from tests.programs import nlp_of


def tip(point: Any) -> Any:
    return [point.q[0] ** 2 + point.q[1]]


def tip_row(nlp: rt.transcription.Nlp) -> int:
    """Number of the one state path row."""
    (row,) = (row for row in nlp.problem.phases[0].rows.of_state if row.kind is Kind.PATH)
    return row.number


@pytest.fixture(scope="module")
def nlp() -> rt.transcription.Nlp:
    phase = rt.Phase(
        rt.load("cartpole"),
        duration=(1.0, 3.0),
        start=rt.State(q=[0, 0], v=0),
        end=rt.State(q=[1, np.pi], v=0),
        objective=rt.Effort(),
        constraints=[rt.PathConstraint(tip, upper=5.0, name="tip")],
    )
    return rt.transcription.transcribe(rt.Problem([phase]), rt.Mesh(4), rt.guess.StraightLine(2.0))


def test_rows_and_states_between_points_come_last_and_follow_the_polynomial(nlp: rt.transcription.Nlp) -> None:
    w = nlp.guess + 0.1 * np.random.default_rng(0).normal(size=len(nlp.guess))
    known = nlp.problem.phases[0].rows.of_state
    (variable,) = (row.number for row in known if row.variable == "q.slider")
    path = tip_row(nlp)
    more = with_added_rows(nlp, [AddedRow(0, 2, variable, 0.3), AddedRow(0, 1, path, 0.7)], w)

    x = extract(nlp, w)[0].x
    first, second = (x.breaks[k] + tau * (x.breaks[k + 1] - x.breaks[k]) for k, tau in ((2, 0.3), (1, 0.7)))
    n, m = len(nlp.variables), len(nlp.rows)
    assert len(more.variables) == n + 4
    assert more.guess[:n] == pytest.approx(w)
    assert more.guess[n:] == pytest.approx(x(second))
    values = more.values(more.guess)
    assert values[:m] == pytest.approx(nlp.values(w))
    q = x(second)
    assert values[m:] == pytest.approx([x(first)[0], 0, 0, 0, 0, q[0] ** 2 + q[1]], abs=1e-9)
    assert more.rows.lower[m:].tolist() == [nlp.problem.phases[0].rows.rows[variable].lower, 0, 0, 0, 0, -np.inf]
    assert more.rows.upper[m:].tolist() == [nlp.problem.phases[0].rows.rows[variable].upper, 0, 0, 0, 0, 5.0]
    assert more.objective(more.guess) == pytest.approx(nlp.objective(w))
    assert np.array_equal(more.row_scale[:m], nlp.row_scale)
    assert np.array_equal(more.scale[n:], more.scale[nlp.layouts[0].knots[0]])


def test_derivatives_with_added_rows_are_those_of_finite_differences(nlp: rt.transcription.Nlp) -> None:
    path = tip_row(nlp)
    more = with_added_rows(nlp, [AddedRow(0, 1, path, 0.7)], nlp.guess)
    w = more.guess + 0.1 * np.random.default_rng(1).normal(size=len(more.guess))
    along = np.random.default_rng(2).normal(size=len(w))
    step = 1e-6
    slope = (more.values(w + step * along) - more.values(w - step * along)) / (2 * step)
    assert more.jacobian(w) @ along == pytest.approx(slope, rel=1e-5, abs=1e-5)


def test_a_row_at_many_places_is_one_block(nlp: rt.transcription.Nlp) -> None:
    """A block for each would be differentiated, compiled and called one by one."""
    path = tip_row(nlp)
    places = [(0, 0.2), (1, 0.7), (3, 0.4), (3, 0.9)]
    more = with_added_rows(nlp, [AddedRow(0, k, path, tau) for k, tau in places], nlp.guess)
    assert [block.count for block in more.blocks[len(nlp.blocks) :]] == [len(places)]

    w = more.guess + 0.1 * np.random.default_rng(1).normal(size=len(more.guess))
    states = w[len(nlp.variables) :].reshape(len(places), -1)
    rows = [i for i, m in enumerate(more.rows.meaning) if more.rows.entries[m].name == "tip" and i >= len(nlp.rows)]
    assert more.rows.fraction[rows] == pytest.approx([(k + tau) / 4 for k, tau in places])
    assert more.values(w)[rows] == pytest.approx(states[:, 0] ** 2 + states[:, 1])
    along = np.random.default_rng(2).normal(size=len(w))
    step = 1e-6
    slope = (more.values(w + step * along) - more.values(w - step * along)) / (2 * step)
    assert more.jacobian(w) @ along == pytest.approx(slope, rel=1e-5, abs=1e-5)


def violated(nlp: rt.transcription.Nlp, number: int, interval: int, tau: float = 0.3) -> IntervalViolation:
    return IntervalViolation(0, interval, nlp.problem.phases[0].rows.rows[number], tau, 0.0, 0.1, True, 1.0)


def test_a_row_is_added_at_its_worst_place_and_the_second_time_on_the_whole_interval(
    nlp: rt.transcription.Nlp,
) -> None:
    path, worst = tip_row(nlp), AddedRow(0, 1, tip_row(nlp), 0.3)
    assert rows_to_add(nlp, [violated(nlp, path, 1)], []) == [worst]
    again = rows_to_add(nlp, [violated(nlp, path, 1, 0.6), violated(nlp, path, 2)], [worst])
    spread = [AddedRow(0, 1, path, tau) for tau in (0.6, *SPREAD.tolist())]
    assert again == [*spread, AddedRow(0, 2, path, 0.3)]
    assert rows_to_add(nlp, [violated(nlp, path, 1)], [worst, *spread]) == []


def test_an_equality_between_the_points_is_added_once_only() -> None:
    turn = rt.PathConstraint(lambda point: point.v[0] - point.v[1], 0, 0, name="same speed")
    phase = rt.Phase(rt.load("cartpole"), 1.0, rt.State(q=0, v=0), objective=rt.Effort(), constraints=[turn])
    nlp = nlp_of(rt.Problem([phase]), rt.Mesh(4))
    (number,) = (row.number for row in phase.rows.rows if row.name == "same speed")
    added = [AddedRow(0, 1, number, 0.3)]
    assert rows_to_add(nlp, [violated(nlp, number, 1, 0.6)], added) == [AddedRow(0, 1, number, 0.6)]
    everywhere = [AddedRow(0, 1, number, tau) for tau in (0.3, *SPREAD.tolist())]
    assert exceeded_although_added(nlp, [violated(nlp, number, 1)], everywhere) == []


def test_only_path_rows_that_hold_on_the_whole_interval_are_exceeded_although_added(
    nlp: rt.transcription.Nlp,
) -> None:
    path = tip_row(nlp)
    (bound,) = (row.number for row in nlp.problem.phases[0].rows.of_state if row.variable == "q.slider")
    found = [violated(nlp, number, interval) for number in (path, bound) for interval in (1, 2)]
    added = [AddedRow(0, 1, number, tau) for number in (path, bound) for tau in (0.3, *SPREAD.tolist())]
    assert exceeded_although_added(nlp, found, added) == [found[0]]
    assert exceeded_although_added(nlp, found, added[: len(SPREAD)]) == []


def test_states_at_added_rows_of_a_contact_are_on_the_corrected_polynomial() -> None:
    """The corrections of the contact's position are part of the polynomial that extraction evaluates."""
    hopper = rt.load("hopper", root="planar")
    high = rt.PathConstraint(lambda point: point.q[1] ** 2, upper=5.0, name="tip")
    phase = rt.Phase(hopper, 0.5, contacts=[rt.PointContact("foot")], constraints=[high])
    nlp = nlp_of(rt.Problem([phase]), rt.Mesh(3))
    w = nlp.guess + 0.1 * np.random.default_rng(3).normal(size=len(nlp.guess))
    more = with_added_rows(nlp, [AddedRow(0, 1, tip_row(nlp), 0.3)], w)
    x = extract(nlp, w)[0].x
    there = x(x.breaks[1:2] + 0.3 * (x.breaks[2] - x.breaks[1]))[0]
    assert more.guess[len(nlp.variables) :] == pytest.approx(there)
    assert more.values(more.guess)[len(nlp.rows) :] == pytest.approx([*np.zeros(len(there)), there[1] ** 2], abs=1e-9)


def test_rows_against_swings_are_those_of_speeds_at_the_extrema_of_what_the_points_do_not_see() -> None:
    swing = np.poly1d([1.0, -1.5, 0.5, 0.0])
    assert np.abs(swing([0.0, 0.5, 1.0])).max() == 0.0
    assert np.sort(swing.deriv().roots) == pytest.approx(SWINGS)
    slow = rt.PathConstraint(lambda p: [p.v[0] ** 2 + p.v[1] ** 2], upper=9.0, name="slow")
    even = rt.PathConstraint(lambda p: [p.v[0] - p.v[1]], 0.0, 0.0, name="even")
    limits = [slow, rt.PathConstraint(tip, upper=5.0, name="tip")]
    phase = rt.Phase(rt.load("two_link_arm"), 2.0, rt.State(q=0, v=0), rt.State(q=1, v=0), rt.Effort(), limits)
    both = rt.transcription.transcribe(rt.Problem([phase]), rt.Mesh(3), rt.guess.StraightLine())
    (number,) = (row.number for row in phase.rows.of_state if row.name == "slow")
    assert rows_against_swings(both) == [AddedRow(0, k, number, tau) for k in range(3) for tau in SWINGS]
    kept = phase.with_(constraints=[even])
    assert not rows_against_swings(rt.transcription.transcribe(rt.Problem([kept]), rt.Mesh(3), rt.guess.StraightLine()))


def test_states_at_added_rows_follow_another_start(nlp: rt.transcription.Nlp) -> None:
    more = with_added_rows(nlp, [AddedRow(0, 1, tip_row(nlp), 0.7)], nlp.guess)
    w = more.guess.copy()
    w[: len(nlp.guess)] += 0.1 * np.random.default_rng(1).normal(size=len(nlp.guess))
    moved = with_added_states(more, w)
    assert moved[: len(nlp.guess)] == pytest.approx(w[: len(nlp.guess)])
    assert more.values(moved)[len(nlp.rows) :][:4] == pytest.approx(np.zeros(4), abs=1e-9)


def test_path_rows_at_one_place_share_its_states() -> None:
    """Limits of every joint's speed add the states of a place once; each alone would add them again."""
    second = rt.PathConstraint(lambda point: [point.v[0] ** 2], upper=9.0, name="speed")
    phase = rt.Phase(
        rt.load("cartpole"),
        duration=1.0,
        start=rt.State(q=[0, 0], v=0),
        end=rt.State(q=[1, np.pi], v=0),
        objective=rt.Effort(),
        constraints=[rt.PathConstraint(tip, upper=5.0, name="tip"), second],
    )
    nlp = rt.transcription.transcribe(rt.Problem([phase]), rt.Mesh(4), rt.guess.StraightLine(1.0))
    first, other = (row.number for row in phase.rows.of_state if row.kind is Kind.PATH)
    places = [AddedRow(0, k, row, 0.3) for k in range(4) for row in (first, other)]
    w = nlp.guess + 0.1 * np.random.default_rng(1).normal(size=len(nlp.guess))
    more = with_added_rows(nlp, places, w)
    assert len(more.variables) == len(nlp.variables) + 4 * 4
    assert len(more.rows) == len(nlp.rows) + 4 * (4 + 2)
    np.testing.assert_allclose(with_added_states(more, more.guess), more.guess)
    x = extract(nlp, w)[0].x
    at = [x(x.breaks[k] + 0.3 * (x.breaks[k + 1] - x.breaks[k])) for k in range(4)]
    imposed = more.values(more.guess)[len(nlp.rows) :].reshape(4, 6)
    assert imposed == pytest.approx(np.array([[0, 0, 0, 0, q0**2 + q1, v0**2] for q0, q1, v0, _ in at]), abs=1e-9)
