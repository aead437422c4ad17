"""Rates of rows between the points: those of parabolas in closed form, also at the knots, where a slope jumps."""

import numpy as np
import pytest

import robotraj as rt
from robotraj.transcription.driven_motion import PlannedInputs
from robotraj.transcription.interval_limits.row_values import Columns, Expressions, Rates


class Parabolas:
    """y = (a_k t^2, t), with another a_k on each interval."""

    breaks = np.array([0.0, 0.5, 2.0])
    factors = np.array([3.0, -2.0])

    def __call__(self, t, interval=None):
        if interval is None:
            interval = np.searchsorted(self.breaks[1:-1], t, side="right")
        return np.column_stack([self.factors[interval] * t**2, t])

    def inside(self, tau):
        times = self.breaks[:-1, None] + np.diff(self.breaks)[:, None] * tau
        return np.stack([self(t, np.full(len(tau), k)) for k, t in enumerate(times)])


def test_central_differences_of_a_parabola_are_its_slope_inside_each_interval():
    rates = Rates(Parabolas(), [0])
    tau = np.array([0.25, 0.5, 0.75])
    times = rates.breaks[:-1, None] + np.diff(rates.breaks)[:, None] * tau
    np.testing.assert_allclose(rates.grid(tau)[..., 0], 2.0 * Parabolas.factors[:, None] * times, rtol=1e-9)


def test_rates_at_a_knot_are_those_of_the_interval_that_is_asked():
    knot, intervals = np.array([0.5, 0.5]), np.array([0, 1])
    rates = Rates(Parabolas(), [1, 0]).at(knot, intervals)
    np.testing.assert_allclose(rates[:, 0], 1.0, rtol=1e-9)
    # Differences stay inside the interval: the slope of a place a thousandth of it away.
    np.testing.assert_allclose(rates[:, 1], 2.0 * Parabolas.factors * [0.4995, 0.5015], rtol=1e-9)


def test_columns_on_a_grid_and_at_times_agree():
    columns, tau = Columns(Parabolas(), [0]), np.array([0.0, 0.5, 1.0])
    times = columns.breaks[:-1, None] + np.diff(columns.breaks)[:, None] * tau
    at = columns.at(times.ravel(), np.repeat([0, 1], 3)).reshape(2, 3, 1)
    assert np.array_equal(columns.grid(tau), at)


@pytest.mark.parametrize("of_inputs", [False, True])
def test_expressions_on_a_grid_and_at_times_are_those_of_the_motion(of_inputs):
    block = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.p["gain"] * p.u["u"]])
    rows = [
        rt.PathConstraint(lambda p: p.x["x"] * p.x["v"] + p.t + p.p["gain"], upper=9, name="of the state"),
        rt.PathConstraint(lambda p: p.u["u"] * p.x["v"] - p.t, upper=9, name="of the control"),
    ]
    phase = rt.Phase(
        block, 2.0, rt.State([0, 0]), rt.State([1, 0]), rt.Lagrange(lambda p: p.u["u"] ** 2),
        constraints=rows, parameters={"gain": 2.0},
    )  # fmt: skip
    (part,) = rt.plan(phase, rt.Mesh(3), progress=False).phases
    motion = part.trajectory
    of_each = {row.name: row for row in phase.rows.path}
    chosen = [of_each["of the control" if of_inputs else "of the state"]]
    values = Expressions(phase.rows, chosen, motion, PlannedInputs(motion) if of_inputs else None)
    tau = np.array([0.0, 0.3, 0.5, 1.0])
    times = values.breaks[:-1, None] + np.diff(values.breaks)[:, None] * tau
    intervals = np.repeat(np.arange(3), len(tau))
    x, u = motion.x(times.ravel(), intervals), motion.u(times.ravel(), intervals)[:, 0]
    wanted = u * x[:, 1] - times.ravel() if of_inputs else x[:, 0] * x[:, 1] + times.ravel() + 2.0
    np.testing.assert_allclose(values.grid(tau)[..., 0], wanted.reshape(times.shape), atol=1e-12)
    np.testing.assert_allclose(values.at(times.ravel(), intervals)[:, 0], wanted, atol=1e-12)
