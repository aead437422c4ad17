"""Gradient, Jacobian and Hessian are exact: against finite differences and against CasADi's own."""

from __future__ import annotations

from collections.abc import Callable
from threading import Lock

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj._util.arrays import Array
from robotraj.transcription.assembly.callbacks import NlpFunction
from tests.programs import nlp_of

STEP = 1e-5


def somewhere(nlp: rt.transcription.Nlp) -> tuple[Array, Array]:
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


def test_gradient_agrees_with_finite_differences(nlp: rt.transcription.Nlp) -> None:
    w, _ = somewhere(nlp)
    expected = differences(lambda v: np.array([nlp.objective(v)]), w, nlp.scale).ravel()
    assert_close(nlp.gradient(w), expected)
    assert np.any(expected)


def test_jacobian_agrees_with_finite_differences(nlp: rt.transcription.Nlp) -> None:
    w, _ = somewhere(nlp)
    assert_close(nlp.jacobian(w).toarray(), differences(nlp.values, w, nlp.scale))


def test_hessian_agrees_with_finite_differences(nlp: rt.transcription.Nlp) -> None:
    w, multipliers = somewhere(nlp)

    def lagrangian_gradient(v: Array) -> Array:
        return 0.7 * nlp.gradient(v) + nlp.jacobian(v).T @ multipliers

    found = nlp.hessian(w, multipliers, 0.7).toarray()
    np.testing.assert_array_equal(found, found.T)
    assert_close(found, differences(lagrangian_gradient, w, nlp.scale))


def graph(nlp: rt.transcription.Nlp) -> tuple[ca.MX, ca.MX, ca.MX]:
    """w, objective and rows as one graph of the blocks, which CasADi can differentiate."""
    w = ca.MX.sym("w", len(nlp.variables))
    f, g = ca.MX(0), ca.mtimes(ca.DM(nlp.linear.toarray()), w)
    for block in nlp.blocks:
        v = ca.reshape(ca.mtimes(ca.DM(block.gather.toarray()), w), block.stage.inputs, block.count)
        y = block.stage.function.map(block.count)(v, ca.DM(block.constants))
        g += ca.mtimes(ca.DM(block.scatter.toarray()), ca.vec(y))
        if block.costs:
            f += ca.mtimes(y[block.stage.costed, :], ca.DM(block.weights))
    return w, f, g


@pytest.mark.parametrize("name", ["ends", "two phases", "mixed schemes", "cartpole"])
def test_derivatives_are_those_of_the_whole_graph(name: str, problems: dict) -> None:
    nlp = nlp_of(*problems[name]())
    w, f, g = graph(nlp)
    lam = ca.MX.sym("lam", len(nlp.rows))
    hessian, _ = ca.hessian(0.7 * f + ca.dot(lam, g), w)
    whole = ca.Function("whole", [w, lam], [g, ca.gradient(f, w), ca.jacobian(g, w), hessian])
    at, multipliers = somewhere(nlp)
    expected = [part.full() for part in whole(at, multipliers)]
    scale, rows = nlp.scale, nlp.row_scale
    found = [
        nlp.functions.rows(at / scale, []).full() / rows[:, None],
        nlp.gradient(at)[:, None],
        nlp.jacobian(at).toarray(),
        nlp.hessian(at, multipliers, 0.7).toarray(),
    ]
    for ours, theirs in zip(found, expected, strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-12, atol=1e-12 * (1.0 + np.abs(theirs).max()))
    assert np.isclose(float(nlp.functions.objective(at / scale, [])), float(ca.Function("f", [w], [f])(at)), rtol=1e-13)


def test_only_requested_results_are_evaluated_and_a_failure_is_reported() -> None:
    """IPOPT shortens its step where a function cannot be evaluated."""
    asked = []

    def first(x: Array, _: Array) -> Array:
        asked.append("first")
        return 2.0 * x

    def second(x: Array, _: Array) -> Array:
        if x[0] < 0:
            raise RuntimeError("no such value")
        return x[:1] ** 2

    dense = ca.Sparsity.dense
    function = NlpFunction("f", {"x": 2, "p": 0}, {"a": (dense(2, 1), first), "b": (dense(1, 1), second)}, Lock())
    x = ca.MX.sym("x", 2)
    only = ca.Function("only", [x], [function(x, ca.MX(0, 1))[1]])
    assert float(only([3.0, 0.0])) == 9.0
    assert not asked
    np.testing.assert_array_equal(function([3.0, 1.0], [])[0].full().ravel(), [6.0, 2.0])
    with pytest.raises(RuntimeError):
        only([-1.0, 0.0])


def test_the_jacobian_has_no_entry_that_cannot_be_nonzero(problems: dict) -> None:
    """Rows depend on their interval, the duration and the parameters alone."""
    nlp = nlp_of(*problems["ode"]())
    w, _ = somewhere(nlp)
    jacobian = nlp.jacobian(w)
    dense = np.abs(jacobian.toarray()) > 0
    assert jacobian.nnz == np.count_nonzero(dense)
