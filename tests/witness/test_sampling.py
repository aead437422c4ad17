import numpy as np
import pytest

from robotraj.witness.sampling import stretches, time_derivative


class Knots:
    knots = np.array([-1.0, 0.5, 0.5, 2.5])


def test_intervals_are_sampled_with_both_ends_and_empty_ones_left_out():
    found = list(stretches(Knots(), 9))
    assert [(s.interval, s.begin, s.end) for s in found] == [(0, -1.0, 0.5), (2, 0.5, 2.5)]
    for s in found:
        assert s.times[0] == s.begin and s.times[-1] == s.end and np.all(np.diff(s.times) > 0)
        assert s.times[4] == pytest.approx(0.5 * (s.begin + s.end), abs=1e-15)


@pytest.mark.parametrize("degree", [0, 1, 5, 12, 24])
def test_polynomials_below_the_number_of_samples_are_differentiated_exactly(degree):
    random = np.random.default_rng(degree)
    p = np.polynomial.Polynomial(random.normal(size=degree + 1), domain=[0.5, 2.5], window=[-1, 1])
    stretch = list(stretches(Knots(), 25))[1]
    slope = time_derivative(p(stretch.times)[:, None], stretch)[:, 0]
    np.testing.assert_allclose(slope, p.deriv()(stretch.times), rtol=1e-11, atol=1e-11)
