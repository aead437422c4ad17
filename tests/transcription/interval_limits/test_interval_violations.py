"""Violations between collocation points: found where the polynomials have them, with their amounts."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.interval_limits.interval_violations import (
    SHARE,
    IntervalViolation,
    input_violations,
    state_violations,
    variable_violations,
)

BREAKS = np.array([0.0, 1.0, 3.0])
SITES = np.array([0.0, 0.5, 1.0])


def block(**options: Any) -> rt.Phase:
    system = rt.System(["x"], ["u"], lambda point: [point.u["u"]])
    return rt.Phase(system, 3.0, **options)


def parabolas(x: list[list[float]], u: list[list[float]]) -> PhaseTrajectory:
    """One parabola for each interval through values at its ends and its middle."""
    states, controls, none = (
        PiecewisePolynomial(BREAKS, [SITES] * 2, [np.array(values)[:, None][:, :size] for values in each])
        for each, size in ((x, 1), (u, 1), (x, 0))
    )
    return PhaseTrajectory(0.0, 3.0, states, none, controls, BREAKS, {})


FLAT = [[0.0, 0.0, 0.0]] * 2


def test_the_peak_of_a_parabola_is_found_between_the_places() -> None:
    """x = 4 tau (1 - tau) + 0.1 tau peaks at tau = 0.5125, with 1.050625."""
    phase = block(states={"x": rt.between(-9, 1)})
    (found,) = state_violations(phase, 4, parabolas([[0, 0.5, 0.1], [0, 1.05, 0.1]], FLAT), 0.01)
    assert (found.phase, found.interval, found.row.name, found.upper, found.limit) == (4, 1, "state bound", True, 1)
    assert found.tau == pytest.approx(0.5125, abs=1e-9)
    assert found.time == pytest.approx(1 + 2 * 0.5125, abs=1e-9)
    assert found.amount == pytest.approx(0.050625, abs=1e-12)


@pytest.mark.parametrize("tilt", [-0.3, -0.1, -0.03, 0.03, 0.1, 0.3])
def test_peaks_on_either_side_of_a_place_are_found(tilt: float) -> None:
    """x = 4 tau (1 - tau) + c tau peaks at 1/2 + c / 8 with (4 + c)^2 / 16; -x is below a lower bound alike."""
    peak = (4 + tilt) ** 2 / 16
    values = [0, 1 + tilt / 2, tilt]
    for sign, bounds in ((1, rt.between(-9, peak - 0.01)), (-1, rt.between(0.01 - peak, 9))):
        motion = parabolas([[sign * value for value in values], [0, 0, 0]], FLAT)
        (found,) = state_violations(block(states={"x": bounds}), 0, motion, 1e-3)
        assert found.tau == pytest.approx(0.5 + tilt / 8, abs=1e-9)
        assert found.amount == pytest.approx(0.01, abs=1e-12)
        assert found.upper is (sign > 0)


def test_a_bound_and_the_same_path_row_have_the_same_violations() -> None:
    motion = parabolas([[0, -0.5, 0.1], [0, -1.05, 0.1]], FLAT)
    same = rt.PathConstraint(lambda point: point.x["x"], lower=-1)
    bound, row = (
        state_violations(phase, 0, motion, 0.01)
        for phase in (block(states={"x": rt.between(-1, 9)}), block(constraints=[same]))
    )
    assert [(each.interval, each.upper) for each in bound] == [(1, False)]
    assert [(each.interval, each.tau, each.amount) for each in row] == [
        (each.interval, pytest.approx(each.tau), pytest.approx(each.amount)) for each in bound
    ]


def test_violations_within_what_is_allowed_are_not_listed() -> None:
    phase = block(states={"x": rt.between(-9, 1)})
    motion = parabolas([[0, 0.5, 0.1], [0, 1.05, 0.1]], FLAT)
    assert state_violations(phase, 0, motion, 0.0506) and not state_violations(phase, 0, motion, 0.0507)


@pytest.mark.parametrize("bounds", [rt.between(-0.04, 0.04), rt.between(0.96, 1.04)])
def test_what_is_allowed_is_relative_to_half_of_a_small_range(bounds: Any) -> None:
    """x peaks 1e-4 above its greatest value, which is 2.5e-3 of half of the range; the witness judges by that, too."""
    middle, top = 0.5 * (bounds.lower + bounds.upper), bounds.upper + 1e-4
    motion = parabolas([[middle, top, middle]] * 2, FLAT)
    row = rt.PathConstraint(lambda point: point.x["x"], lower=bounds.lower, upper=bounds.upper)
    for phase in (block(states={"x": bounds}), block(constraints=[row])):
        assert len(state_violations(phase, 0, motion, 2.4e-3)) == 2
        assert not state_violations(phase, 0, motion, 2.6e-3)


@pytest.mark.parametrize(("height", "listed"), [(2.0 * (1 + 1.01 * SHARE), True), (2.0 * (1 + 0.99 * SHARE), False)])
def test_controls_may_exceed_their_limit_by_a_share(height: float, listed: bool) -> None:
    phase = block(controls={"u": rt.between(-2, 2)})
    assert bool(variable_violations(phase, 0, parabolas(FLAT, [[0, height, 0], [0, 0, 0]]))) is listed


def test_controls_that_jump_over_both_limits_at_a_knot_are_listed() -> None:
    """Both ends of every interval are worst alike; each was once left to the interval on its right."""
    phase = block(controls={"u": rt.between(-1, 1)})
    teeth = variable_violations(phase, 0, parabolas(FLAT, [[-2, 0, 2.001], [-2, 0, 2.001]]))
    assert [(each.interval, each.tau) for each in teeth] == [(0, 1.0), (1, 1.0)]
    alone = variable_violations(phase, 0, parabolas(FLAT, [[0, 1, 2], [0, 0, 0]]))
    assert [(each.interval, each.tau) for each in alone] == [(0, 1.0)]
    shared = variable_violations(phase, 0, parabolas(FLAT, [[0, 1, 2], [2, 1, 0]]))
    assert [(each.interval, each.tau) for each in shared] == [(1, 0.0)]


def test_rows_of_controls_are_read_along_all_polynomials() -> None:
    """x u = (1 - 4 (tau - 1/2)^2)^2 peaks with 1 at the middle of the second interval."""
    phase = block(constraints=[rt.PathConstraint(lambda point: point.x["x"] * point.u["u"], upper=0.75, name="power")])
    motion = parabolas([[0, 0, 0], [0, 1, 0]], [[0, 0, 0], [0, 1, 0]])
    found: list[IntervalViolation] = input_violations(phase, 0, motion)
    assert [(each.interval, each.row.name) for each in found] == [(1, "power")]
    assert found[0].time == pytest.approx(2.0, abs=1e-9)
    assert found[0].amount == pytest.approx(0.25, abs=1e-9)
    assert not state_violations(phase, 0, motion, 0.0)


@pytest.mark.parametrize(("excess", "listed"), [(2e-3, True), (0.5e-3, False)])
def test_path_rows_of_controls_may_exceed_their_limit_by_a_thousandth(excess: float, listed: bool) -> None:
    """x u peaks with 1 at the middle of the second interval."""
    limit = 1.0 / (1.0 + excess)
    power = rt.PathConstraint(lambda point: point.x["x"] * point.u["u"], upper=limit, name="power")
    motion = parabolas([[0, 0, 0], [0, 1, 0]], [[0, 0, 0], [0, 1, 0]])
    found = variable_violations(block(constraints=[power]), 0, motion)
    assert [(each.interval, each.row.name) for each in found] == ([(1, "power")] if listed else [])
    assert len(input_violations(block(constraints=[power]), 0, motion)) == 1


def test_path_rows_of_controls_are_read_next_to_the_knots_where_they_jump() -> None:
    """u = 1.01 - 2.01 tau exceeds 1 in the first two hundredths of an interval alone."""
    limited = block(constraints=[rt.PathConstraint(lambda point: point.u["u"], upper=1.0, name="force")])
    found = variable_violations(limited, 0, parabolas(FLAT, [[0, 0, 0], [1.01, 0.005, -1.0]]))
    assert [(each.interval, each.row.name) for each in found] == [(1, "force")]
    assert found[0].amount == pytest.approx(0.01, abs=3e-3)


def test_equalities_that_read_controls_are_listed_with_rows_not_with_limits() -> None:
    """Between the points u - x = 0 holds to the order of the scheme only; limits of torques are another matter."""
    same = rt.PathConstraint(lambda point: point.u["u"] - point.x["x"], 0, 0, name="same")
    motion = parabolas([[0, 0.5, 0], [0, 0, 0]], FLAT)
    assert variable_violations(block(constraints=[same]), 0, motion) == []
    assert [each.row.name for each in input_violations(block(constraints=[same]), 0, motion)] == ["same"]


def test_cones_of_contacts_are_rows_and_no_limits() -> None:
    """They are measured against the weight; a foot that pushes sideways alone breaks its cone everywhere."""
    hopper = rt.load("hopper", root="planar")
    phase = rt.Phase(hopper, 3.0, contacts=[rt.PointContact("foot", friction=0.5)])
    sizes = len(phase.dae.states), len(phase.dae.algebraic), len(phase.dae.controls)
    x, z, u = (PiecewisePolynomial(BREAKS, [SITES] * 2, [np.zeros((3, size)) for _ in range(2)]) for size in sizes)
    forces = [force.name for contact in phase.bound_contacts for force in contact.forces]
    pushed = np.array([[100.0 * (variable.name == forces[0]) for variable in phase.dae.algebraic]] * 3)
    z = PiecewisePolynomial(BREAKS, [SITES] * 2, [pushed] * 2)
    parameters = dict.fromkeys(phase.parameter_names, 0.0)
    motion = PhaseTrajectory(0.0, 3.0, x, z, u, BREAKS, parameters)
    listed = {each.row.name for each in input_violations(phase, 0, motion)}
    assert any("friction" in name for name in listed), listed
    assert not any("friction" in each.row.name for each in variable_violations(phase, 0, motion))


def test_peaks_of_bends_sharper_than_the_places_are_found() -> None:
    """x = 1.05 tanh(tau / w) - 3 tau, w a tenth of the distance of two places, peaks between the first two."""
    sharp = 0.1 / 48

    class Bend:
        breaks = np.array([0.0, 1.0])

        def __call__(self, t: Any, interval: Any = None) -> Any:
            return (1.05 * np.tanh(np.asarray(t) / sharp) - 3.0 * np.asarray(t))[:, None]

        def inside(self, tau: Any) -> Any:
            return self(tau)[None]

    phase = block(states={"x": rt.between(-9, 1)})
    none, still = (PiecewisePolynomial(Bend.breaks, [SITES], [np.zeros((3, size))]) for size in (0, 1))
    motion = PhaseTrajectory(0.0, 1.0, Bend(), none, still, Bend.breaks, {})  # type: ignore[arg-type]
    (found,) = state_violations(phase, 0, motion, 0.01)
    peak = sharp * np.arctanh(np.sqrt(1 - 3.0 * sharp / 1.05))
    assert found.tau == pytest.approx(peak, abs=0.1 / 48)
    assert found.amount == pytest.approx(1.05 * np.tanh(peak / sharp) - 3.0 * peak - 1, rel=2e-2)
