import casadi as ca
import numpy as np
import pytest

from robotraj._util.errors import InputError
from robotraj.witness.numbers import as_numbers


@pytest.mark.parametrize(
    "values",
    [
        [1.0, 2.0, 3.0],
        (np.float64(1), ca.DM(2), ca.SX(3)),
        ca.DM([1, 2, 3]),
        np.array([[1.0], [2.0], [3.0]]),
        [ca.DM([1, 2]), 3],
        ca.vertcat(ca.SX(1), 2, 3),
    ],
)
def test_every_way_to_return_numbers_is_read(values):
    np.testing.assert_array_equal(as_numbers(values, "expression"), [1.0, 2.0, 3.0])


def test_a_scalar_is_one_number():
    np.testing.assert_array_equal(as_numbers(ca.sin(0.5), "expression"), [np.sin(0.5)])


@pytest.mark.parametrize("values", [ca.SX.sym("x"), None, "three", [1.0, ca.MX.sym("y")]])
def test_what_is_no_number_is_refused_by_name(values):
    with pytest.raises(InputError, match="expression of 'power' did not give numbers"):
        as_numbers(values, "expression of 'power'")
