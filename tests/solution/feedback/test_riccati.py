"""The recursion against textbook Riccati equations, and where those overflow."""

import numpy as np
import scipy

from robotraj.solution.feedback.riccati import backwards, transition


def test_the_gain_of_a_long_horizon_is_that_of_the_algebraic_riccati_equation():
    rng = np.random.default_rng(0)
    moves, push = np.eye(4) + 0.1 * rng.normal(size=(4, 4)), rng.normal(size=(4, 2))
    weights = np.array([1.0, 2.0, 0.5, 1.0]), np.diag([1.0, 3.0])
    root, gains = backwards(np.eye(4), [(moves, push)] * 300, [weights] * 300)
    cost, price = np.diag(weights[0] ** 2), weights[1] ** 2
    value = scipy.linalg.solve_discrete_are(moves, push, cost, price)
    np.testing.assert_allclose(root.T @ root, value, rtol=1e-9)
    expected = np.linalg.solve(price + push.T @ value @ push, push.T @ value @ moves)
    np.testing.assert_allclose(gains[0], expected, rtol=1e-9)
    np.testing.assert_allclose(np.abs(np.linalg.eigvals(moves - push @ gains[0])).max() < 1.0, True)


def test_the_transition_is_that_of_the_exponential_to_order_three():
    rng = np.random.default_rng(1)
    rate, push = rng.normal(size=(3, 3)), rng.normal(size=(3, 1))
    errors = []
    for duration in (0.1, 0.05):
        block = np.zeros((4, 4))
        block[:3] = duration * np.hstack([rate, push])
        exact = scipy.linalg.expm(block)[:3]
        errors.append(np.abs(np.hstack(transition(rate, push, duration)) - exact).max())
    assert np.log2(errors[0] / errors[1]) > 3.7


def test_fast_decay_is_no_reason_for_short_pieces():
    moves, push = transition(np.array([[-1e7]]), np.array([[1.0]]), 0.02)
    assert 0.0 <= abs(moves[0, 0]) < 1e-4 and abs(push[0, 0] - 1e-7) < 1e-10


def test_growth_that_no_motor_corrects_stays_finite_far_beyond_the_square_root_of_all_numbers():
    # A mode e^(600 t) that no torque reaches: its cost e^1200 would overflow, the root of it does not.
    moves, push = np.diag([np.exp(6.0), 1.0]), np.array([[0.0], [1.0]])
    root, gains = backwards(np.eye(2), [(moves, push)] * 100, [(np.ones(2), np.eye(1))] * 100)
    assert np.isfinite(root).all() and np.abs(root).max() > 1e200
    np.testing.assert_allclose(gains[0], [[0.0, 0.618034]], atol=1e-5)
