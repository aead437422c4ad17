"""Gradient, Jacobian and Hessian are exact: against finite differences and against CasADi's own."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest
from numpy.typing import NDArray

import robotraj as rt

Array = NDArray[np.float64]
STEP = 1e-5


def somewhere(nlp: rt.Nlp) -> tuple[Array, Array]:
    """A point near the guess and multipliers, seeded."""
    random = np.random.default_rng(7)
    w = nlp.guess + nlp.scale * random.uniform(-0.1, 0.1, len(nlp.guess))
    return w, random.normal(size=len(nlp.rows))


def differences(function: Callable[[Array], Array], w: Array, scale: Array) -> Array:
    """Central differences with one step of Richardson's extrapolation, column by column."""

    def column(i: int, step: float) -> Array:
        e = np.zeros_like(w)
        e[i] = step
        return (function(w + e) - function(w - e)) / (2 * step)

    steps = STEP * scale * 10
    return np.column_stack([(4 * column(i, h) - column(i, 2 * h)) / 3 for i, h in enumerate(steps)])


def assert_close(found: Array, expected: Array) -> None:
    assert np.max(np.abs(found - expected)) <= 1e-6 * max(1.0, float(np.max(np.abs(expected))))


def test_gradient_agrees_with_finite_differences(nlp: rt.Nlp) -> None:
    w, _ = somewhere(nlp)
    expected = differences(lambda v: np.array([nlp.objective(v)]), w, nlp.scale).ravel()
    assert_close(nlp.gradient(w), expected)
    assert np.any(expected)


def test_jacobian_agrees_with_finite_differences(nlp: rt.Nlp) -> None:
    w, _ = somewhere(nlp)
    assert_close(nlp.jacobian(w).toarray(), differences(nlp.values, w, nlp.scale))


def test_hessian_agrees_with_finite_differences(nlp: rt.Nlp) -> None:
    w, multipliers = somewhere(nlp)

    def lagrangian_gradient(v: Array) -> Array:
        return 0.7 * nlp.gradient(v) + nlp.jacobian(v).T @ multipliers

    found = nlp.hessian(w, multipliers, 0.7).toarray()
    np.testing.assert_array_equal(found, found.T)
    assert_close(found, differences(lagrangian_gradient, w, nlp.scale))


@pytest.mark.parametrize("name", ["ends", "two phases", "mixed schemes", "cartpole"])
def test_derivatives_are_those_of_the_whole_graph(name: str, problems: dict) -> None:
    nlp = rt.transcribe(*problems[name]())
    functions = nlp.functions
    w, lam, p = ca.MX.sym("w", len(nlp.variables)), ca.MX.sym("lam", len(nlp.rows)), ca.MX.sym("p", 0)
    f, g = functions.objective(w, p), functions.rows(w, p)
    hessian, gradient = ca.hessian(0.7 * f + ca.dot(lam, g), w)
    whole = ca.Function("whole", [w, lam], [ca.gradient(f, w), ca.jacobian(g, w), hessian])
    at, multipliers = somewhere(nlp)
    at = at / nlp.scale
    expected = [part.full() for part in whole(at, multipliers)]
    upper = functions.hessian(at, [], 0.7, multipliers).full()
    found = [
        functions.gradient(at, [])[1].full(),
        functions.jacobian(at, [])[1].full(),
        upper + np.triu(upper, 1).T,
    ]
    for ours, theirs in zip(found, expected, strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-12, atol=1e-12)


def test_the_jacobian_has_no_entry_that_cannot_be_nonzero(problems: dict) -> None:
    """No row reads more than its own interval, the duration and the parameters."""
    nlp = rt.transcribe(*problems["ode"]())
    w, _ = somewhere(nlp)
    jacobian = nlp.jacobian(w)
    dense = np.abs(jacobian.toarray()) > 0
    assert jacobian.nnz == np.count_nonzero(dense)
