import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

from robotraj._util.errors import UnknownName
from robotraj.witness import NumericPoint


@pytest.fixture
def state():
    random = np.random.default_rng(4)
    return [random.uniform(-1, 1, 2) for _ in range(4)]


@pytest.fixture
def point(two_link, state):
    return NumericPoint(two_link, 0.3, *state, parameters={"mass": 2.0})


def test_names_read_as_in_the_nlp(point, state):
    q, v, a, tau = state
    assert (point.x["q.elbow"], point.x["v.shoulder"]) == (q[1], v[0])
    assert (point.z["a.elbow"], point.u["tau.shoulder"], point.p["mass"], point.t) == (a[1], tau[0], 2.0, 0.3)
    with pytest.raises(UnknownName, match="elbow"):
        point.x["q.elbo"]


def test_a_planar_frame_has_its_closed_form(point, state):
    (q0, q1), (v0, v1), (a0, a1), _ = state
    tip = point.frame("tip")
    lower, turn, spin = q0 + q1, v0 + v1, a0 + a1
    np.testing.assert_allclose(tip.position, [-np.sin(q0) - np.sin(lower), 0, -np.cos(q0) - np.cos(lower)], atol=1e-14)
    np.testing.assert_allclose(tip.rotation, pin.utils.rotate("y", lower), atol=1e-14)
    velocity = [
        -np.cos(q0) * v0 - np.cos(lower) * turn,
        0,
        np.sin(q0) * v0 + np.sin(lower) * turn,
        0,
        turn,
        0,
    ]
    np.testing.assert_allclose(tip.velocity, velocity, atol=1e-14)
    classical = [
        -np.cos(q0) * a0 + np.sin(q0) * v0**2 - np.cos(lower) * spin + np.sin(lower) * turn**2,
        0,
        np.sin(q0) * a0 + np.cos(q0) * v0**2 + np.sin(lower) * spin + np.cos(lower) * turn**2,
        0,
        spin,
        0,
    ]
    np.testing.assert_allclose(tip.acceleration, classical, atol=1e-14)


def test_momentum_is_mass_times_velocity_of_the_centre_of_mass(two_link, point, state):
    q, v, a, tau = state
    h = 1e-6
    ahead, behind = (NumericPoint(two_link, 0.0, q + s * h * v, v, a, tau).com for s in (1, -1))
    np.testing.assert_allclose(point.momentum[:3], 2.0 * (ahead - behind) / (2 * h), atol=1e-9)


def test_an_unknown_frame_is_refused_with_the_valid_ones(point):
    with pytest.raises(UnknownName, match="tip"):
        point.frame("tipp")


def test_points_keep_their_values_when_others_are_made(two_link, point, state):
    before = np.array(point.frame("tip").position)
    other = NumericPoint(two_link, 0.0, state[0] + 1, *state[1:])
    assert np.abs(other.frame("tip").position - before).max() > 0.1
    np.testing.assert_array_equal(point.frame("tip").position, before)


def test_columns_make_casadi_expressions_mean_the_same_on_numbers(two_link, state):
    point = NumericPoint(two_link, 0.0, *state, columns=True)
    assert float(ca.mtimes(point.q.T, point.q)) == pytest.approx(state[0] @ state[0])
    assert point.frame("tip").rotation.shape == (3, 3)
    assert float(ca.sin(point.v[1])) == pytest.approx(np.sin(state[1][1]))


def test_contact_forces_are_read_by_contact_and_by_component(two_link, state):
    named = {"force.foot.x": 3.0, "force.foot.z": 40.0}
    point = NumericPoint(two_link, 0.0, *state, forces={"foot": [3.0, 0.0, 40.0]}, algebraic=named)
    np.testing.assert_array_equal(point.forces["foot"], [3, 0, 40])
    assert (point.z["force.foot.z"], point.z["a.elbow"]) == (40.0, state[2][1])
    with pytest.raises(UnknownName, match="foot"):
        point.forces["food"]
