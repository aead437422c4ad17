import numpy as np
import pytest

from robotraj.witness.sampling import interval_samples, time_derivative


class Knots:
    knots = np.array([-1.0, 0.5, 0.5, 2.5])


def test_intervals_are_sampled_with_both_ends_and_empty_ones_left_out():
    (found,) = interval_samples(Knots(), 9)
    assert list(found.intervals) == [0, 2] and list(found.interval) == [0] * 9 + [2] * 9
    assert list(found.begins) == [-1.0, 0.5] and list(found.ends) == [0.5, 2.5]
    for times, begin, end in zip(found.times.reshape(2, 9), found.begins, found.ends, strict=True):
        assert times[0] == begin and times[-1] == end and np.all(np.diff(times) > 0)
        assert times[4] == pytest.approx(0.5 * (begin + end), abs=1e-15)


@pytest.mark.parametrize("degree", [0, 1, 5, 12, 24])
def test_polynomials_below_the_number_of_samples_are_differentiated_exactly(degree):
    random = np.random.default_rng(degree)
    p = np.polynomial.Polynomial(random.normal(size=degree + 1), domain=[0.5, 2.5], window=[-1, 1])
    (part,) = interval_samples(Knots(), 25, only={2})
    slope = time_derivative(p(part.times)[:, None], part)[:, 0]
    np.testing.assert_allclose(slope, p.deriv()(part.times), rtol=1e-11, atol=1e-11)
