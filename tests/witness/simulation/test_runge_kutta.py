"""Steps of the explicit method: their error is of order 8, and their number follows from it."""

import numpy as np
import pytest

from robotraj.witness.simulation.runge_kutta import fewer_steps, more_steps


@pytest.mark.parametrize(
    ("error", "steps"),
    [
        (1.0, 125),  # a quarter more at least
        (2.0**8, 230),  # an error of 2^8 takes twice the steps, and 15 percent of margin
        (3.0**8, 345),
        (1e9, 400),  # four times as many at most
        (np.inf, 400),
        (np.nan, 400),
    ],
)
def test_an_error_above_the_tolerance_takes_its_eighth_root_of_more_steps(error, steps):
    assert more_steps(100, error) == pytest.approx(steps, abs=1)


@pytest.mark.parametrize(("error", "steps"), [(1.0, 100), (0.5**8, 58), (0.1**8, 12), (0.0, 1)])
def test_an_error_below_the_tolerance_needs_its_eighth_root_of_the_steps(error, steps):
    assert fewer_steps(100, error) == pytest.approx(steps, abs=1)
