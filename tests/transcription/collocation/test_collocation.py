"""Rows of collocation against what they stand for: integrals, ends, links and the clocks of moving knots."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.transcription.collocation.symbols import phase_scalars, point_symbols
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.transcribe import transcribe
from tests.programs import nlp_of

DRIFT = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]])


def driven(**more: Any) -> rt.Phase:
    given = {"duration": 2.0, "start": rt.State([0, 0]), "end": rt.State([1, 0]), "controls": {"u": rt.between(-9, 9)}}
    return rt.Phase(DRIFT, **(given | more))


def rows(nlp: Nlp, name: str) -> np.ndarray:
    numbers = [i for i, entry in enumerate(nlp.rows.entries) if entry.name == name or entry.label == name]
    return np.flatnonzero(np.isin(nlp.rows.meaning, numbers))


def somewhere(nlp: Nlp, seed: int = 0) -> np.ndarray:
    return nlp.guess + 0.1 * np.random.default_rng(seed).normal(size=len(nlp.guess))


@pytest.mark.parametrize("scheme", [rt.HermiteSimpson(), rt.schemes.RadauIIA(3)], ids=["Simpson", "Radau"])
def test_each_integral_has_its_own_row(scheme: Any) -> None:
    """The integrals of 1, t and t^2 over 2 s, each exact for these schemes, beside a path row and a cost."""
    powers = [rt.constraints.IntegralConstraint(lambda p, k=k: p.t**k, upper=9.0, name=f"power {k}") for k in range(3)]
    seen = rt.PathConstraint(lambda p: p.x["x"] * p.u["u"], upper=50.0, name="power")
    cost = rt.Lagrange(lambda p: 1.0 + 0.0 * p.u["u"] ** 2)
    nlp = nlp_of(rt.Problem([driven(constraints=[seen, *powers], objective=cost)]), rt.Mesh(3, scheme))
    w = somewhere(nlp)
    values = nlp.values(w)
    for k in range(3):
        np.testing.assert_allclose(values[rows(nlp, f"power {k}")], 2.0 ** (k + 1) / (k + 1))
    assert nlp.objective(w) == pytest.approx(2.0)


@pytest.mark.parametrize("weight", [0.5, 1.0, 2.0, 3.0])
def test_terms_of_the_objective_are_weighted_and_added(weight: float) -> None:
    """The integrals of t and t^2 over 2 s, and the duration."""
    terms = [rt.Lagrange(lambda p, k=k: p.t**k + 0.0 * p.u["u"]) for k in (1, 2)]
    cost = weight * terms[0] + 2.0 * terms[1] + weight * rt.Duration()
    nlp = nlp_of(rt.Problem([driven(objective=cost)]), rt.Mesh(3))
    assert nlp.objective(somewhere(nlp)) == pytest.approx(2.0 * weight + 2.0 * 8 / 3 + 2.0 * weight)


def test_corrections_move_the_state_of_their_own_point_only() -> None:
    """Of every node above 0, as many as invariants: x_j = x_0 + h sum a_jk f_k + C(x_j) c_j."""
    hopper = rt.load("hopper", root="planar")
    contact = [rt.PointContact("foot")]
    phase = rt.Phase(hopper, 0.5, contacts=contact, parameters={"foot.x": 0.0})
    nlp = nlp_of(rt.Problem([phase]), rt.Mesh(2))
    w, (layout,) = somewhere(nlp), nlp.layouts
    s, c = point_symbols(phase, phase_scalars(layout)), ca.SX.sym("c", len(phase.dae.invariants))
    point = phase.dae.point(s.t, s.x, s.z, s.u, s.p, phase.parameter_names)
    moved = ca.Function("moved", [s.x, c], [phase.dae.correction(point, c)], {"allow_free": True})
    assert not moved.has_free()
    defects = np.isin([nlp.rows.entries[m].name for m in nlp.rows.meaning], ["defect"])
    jacobian = nlp.jacobian(w).toarray()
    for interval in layout.intervals:
        nodes = interval.scheme.nodes
        for j in np.flatnonzero(nodes > 0.0):
            fraction = interval.start + interval.length * nodes[j]
            at = defects & np.isclose(nlp.rows.fraction, fraction)
            for i, column in enumerate(interval.corrections[j - 1]):
                wanted = np.zeros(len(nlp.rows))
                wanted[at] = -np.array(moved(w[interval.states[j]], np.eye(c.numel())[i])).ravel()
                np.testing.assert_allclose(jacobian[defects, column], wanted[defects], atol=1e-9)


def test_constraints_at_the_ends_read_the_time_and_state_of_their_end() -> None:
    late = rt.PathConstraint(lambda p: [p.t, p.x["x"] ** 2, p.u["u"]], upper=[9, 9, 9], name="seen")
    ends = [rt.constraints.AtStart(late), rt.constraints.AtEnd(late)]
    for duration in (2.0, (0.5, 4.0)):
        phase = driven(start=rt.State(), end=rt.State(), duration=duration, constraints=ends)
        nlp = transcribe(rt.Problem([phase]), rt.Mesh(3), rt.guess.StraightLine(2.0))
        w = somewhere(nlp)
        (layout,) = nlp.layouts
        seconds = layout.duration.of(w)
        first, last = layout.intervals[0], layout.intervals[-1]
        x = w[layout.knots[[0, -1], 0]]
        u = w[[first.controls[0, 0], last.controls[-1, 0]]]
        wanted = [0.0, x[0] ** 2, u[0], seconds, x[1] ** 2, u[1]]
        found = [i for i, m in enumerate(nlp.rows.meaning) if "seen" in str(nlp.rows.entries[m])]
        np.testing.assert_allclose(nlp.values(w)[found], wanted, atol=1e-12)
        assert nlp.rows.fraction[found].tolist() == [0.0] * 3 + [1.0] * 3


def test_a_mayer_term_reads_both_ends_in_the_order_given() -> None:
    cost = 3.0 * rt.Mayer(lambda start, end: 10 * start.x["x"] + end.x["v"] + 100 * (end.t - start.t)) + rt.Duration()
    nlp = nlp_of(rt.Problem([driven(start=rt.State(), end=rt.State(), objective=cost)]), rt.Mesh(3))
    w = somewhere(nlp)
    (first, *_), last = nlp.layouts[0].knots, nlp.layouts[0].knots[-1]
    assert nlp.objective(w) == pytest.approx(3.0 * (10 * w[first[0]] + w[last[1]] + 200.0) + 2.0)


def test_defects_are_those_of_the_rule_of_simpson() -> None:
    """x_1 - x_0 = h / 6 (f_0 + 4 f_m + f_1), and x_m = x_0 + h / 24 (5 f_0 + 8 f_m - f_1)."""
    nlp = nlp_of(rt.Problem([driven(start=rt.State(), end=rt.State())]), rt.Mesh([0, 0.25, 1]))
    w = somewhere(nlp)
    layout, values = nlp.layouts[0], nlp.values(w)
    defects, found = rows(nlp, "v"), {}
    for i in (i for i in defects if nlp.rows.entries[nlp.rows.meaning[i]].name == "defect"):
        found[round(float(nlp.rows.fraction[i]), 12)] = values[i]
    for k, (start, length) in enumerate(((0.0, 0.25), (0.25, 0.75))):
        interval, h = layout.intervals[k], 2.0 * length
        f = w[interval.controls[:, 0]]
        v = w[[interval.left[1], interval.states[1, 1], interval.right[1]]]
        middle = v[1] - v[0] - h / 24 * (5 * f[0] + 8 * f[1] - f[2])
        end = v[2] - v[0] - h / 6 * (f[0] + 4 * f[1] + f[2])
        assert found[round(start + length / 2, 12)] == pytest.approx(middle)
        assert found[round(start + length, 12)] == pytest.approx(end)


@pytest.mark.parametrize("duration", [2.0, (0.5, 4.0)], ids=["fixed", "free"])
def test_moving_intervals_follow_each_other_and_fill_the_phase(duration: Any) -> None:
    mesh = rt.schemes.MovingMesh([0, 0.25, 0.5, 1], least=0.5, most=2.0)
    problem = rt.Problem([driven(duration=duration, objective=rt.Duration())])
    nlp = transcribe(problem, mesh, rt.guess.StraightLine(2.0))
    (layout,) = nlp.layouts
    assert layout.own_clocks is not None
    names = (
        "start of the first interval",
        "intervals follow each other",
        "intervals fill the phase",
        "least length of interval",
        "greatest length of interval",
    )

    def excess(w: np.ndarray) -> dict[str, float]:
        """Largest violation of the rows of each name [s]."""
        values, found = nlp.values(w), {}
        for name in names:
            at = rows(nlp, name)
            over = np.maximum(nlp.rows.lower[at] - values[at], values[at] - nlp.rows.upper[at])
            found[name] = max(0.0, float(over.max()))
        return found

    for name in names[:3]:
        np.testing.assert_array_equal(nlp.rows.lower[rows(nlp, name)], nlp.rows.upper[rows(nlp, name)])
    starts, spans = layout.own_clocks.T
    assert max(excess(nlp.guess).values()) < 1e-12
    moved = nlp.guess.copy()
    # Lengths 0.3, 0.7, 1 of 2 s instead of 0.5, 0.5, 1.
    moved[spans], moved[starts] = [0.3, 0.7, 1.0], [0.0, 0.3, 1.0]
    assert max(excess(moved).values()) < 1e-12
    for change, wanted in (
        (([0.5, 0.5, 1.0], [0.1, 0.6, 1.1]), {"start of the first interval": 0.1}),
        (([0.5, 0.5, 1.0], [0.0, 0.6, 1.0]), {"intervals follow each other": 0.1}),
        (([0.5, 0.5, 0.9], [0.0, 0.5, 1.0]), {"intervals fill the phase": 0.1}),
        (([0.2, 0.8, 1.0], [0.0, 0.2, 1.0]), {"least length of interval": 0.05}),
        (([0.3, 1.2, 0.5], [0.0, 0.3, 1.5]), {"greatest length of interval": 0.2}),
    ):
        w = nlp.guess.copy()
        w[spans], w[starts] = change
        found = {name: by for name, by in excess(w).items() if by > 1e-9}
        assert found == {name: pytest.approx(by) for name, by in wanted.items()}


def test_links_join_the_end_of_one_phase_to_the_start_of_the_next() -> None:
    first, last = (driven(start=rt.State(), end=rt.State(), name=name) for name in ("first", "last"))
    nlp = nlp_of(rt.Problem([first, last], [rt.Continuity(0, 1)]), rt.Mesh(2))
    w = somewhere(nlp)
    before, after = nlp.layouts
    jump = np.append(after.t0.of(w) - 2.0, w[after.knots[0]] - w[before.knots[-1]])
    np.testing.assert_allclose(nlp.values(w)[rows(nlp, "continuity")], jump, atol=1e-12)
    np.testing.assert_array_equal(nlp.rows.lower[rows(nlp, "continuity")], 0.0)
    np.testing.assert_array_equal(nlp.rows.upper[rows(nlp, "continuity")], 0.0)
