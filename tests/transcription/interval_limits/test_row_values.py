"""Rates of rows between the points: those of parabolas in closed form, also at the knots, where a slope jumps."""

import numpy as np

from robotraj.transcription.interval_limits.row_values import Columns, Rates


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
