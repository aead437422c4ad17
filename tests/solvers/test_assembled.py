"""Problems assembled as a whole: rows, derivatives, multipliers and refreshed programs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robotraj as rt
from robotraj.solvers.assembled.program import Assembled, assemble
from robotraj.solvers.formulation import formulate
from robotraj.solvers.stagewise.native import native_program, refresh
from tests.programs import nlp_of
from tests.solvers.stagewise.problems import EVERY

MESH = rt.Mesh(6)


def whole(name: str) -> Assembled:
    return assemble(nlp_of(EVERY[name](), MESH))


@pytest.mark.parametrize("name", ["step", "arm", "two phases", "pendulum"])
def test_rows_and_derivatives_are_those_of_the_nlp(name: str) -> None:
    known = whole(name)
    nlp, program = known.nlp, known.program
    native = native_program(program, nlp.engine, 1)
    y = known.start(nlp.guess) + 0.01 * np.random.default_rng(1).standard_normal(known.free.size)
    w = known.columns(y)
    kept = program.form_rows >= 0
    rows, own = native.rows(y), program.form_rows[kept]
    equal = nlp.rows.lower == nlp.rows.upper
    target = np.where(equal, nlp.rows.lower, 0.0)
    np.testing.assert_allclose(rows[kept], (nlp.row_scale * (nlp.values(w) - target))[own], atol=1e-9)
    np.testing.assert_allclose(rows[~kept], (w / nlp.scale)[program.bound_columns[~kept]], atol=1e-12)
    assert native.objective(y) == pytest.approx(nlp.objective(w), rel=1e-12)
    gradient = (nlp.gradient(w) * nlp.scale)[known.free]
    np.testing.assert_allclose(native.gradient(y), gradient, atol=1e-9 * max(1.0, np.abs(gradient).max()))

    dense = np.zeros((rows.size, y.size))
    dense[program.jacobian] = native.jacobian(y)
    jacobian = np.diag(nlp.row_scale) @ nlp.jacobian(w).toarray() @ np.diag(nlp.scale)
    np.testing.assert_allclose(dense[kept], jacobian[own][:, known.free], atol=1e-8)
    lam = np.random.default_rng(2).standard_normal(rows.size)
    every, _ = known.spread(lam)
    hessian = np.diag(nlp.scale) @ nlp.hessian(w, every * nlp.row_scale).toarray() @ np.diag(nlp.scale)
    upper = np.zeros((y.size, y.size))
    upper[program.hessian] = native.hessian(y, lam)
    expected = np.triu(hessian[np.ix_(known.free, known.free)])
    np.testing.assert_allclose(upper, expected, atol=1e-8 * max(1.0, np.abs(expected).max()))


def test_a_start_lies_inside_its_bounds() -> None:
    known = whole("arm")
    nlp = known.nlp
    lower, upper = (bound[known.free] / nlp.scale[known.free] for bound in (nlp.variables.lower, nlp.variables.upper))
    y = known.start(np.where(np.isfinite(nlp.variables.upper), nlp.variables.upper, nlp.guess))
    assert np.all(y > lower) and np.all(y < upper)


def test_multipliers_are_stationary() -> None:
    solution = rt.plan(EVERY["step"](), MESH, solver=rt.InteriorPoint(fallback=None), check=False, progress=False)
    known = solution.multipliers
    assert solution.success and known is not None and known.origin is not None
    nlp, w = known.origin.nlp, known.origin.w
    left = nlp.scale * (nlp.gradient(w) + nlp.jacobian(w).T @ known.rows + known.bounds)
    size = max(1.0, np.abs(known.rows / nlp.row_scale).max())
    np.testing.assert_allclose(left, 0.0, atol=1e-6 * size)


def test_other_bounds_refresh_the_program() -> None:
    known = whole("step")
    nlp = known.nlp
    upper = np.where(np.isfinite(nlp.variables.upper) & (nlp.variables.lower < nlp.variables.upper), 1.1, 1.0)
    other = replace(nlp, variables=replace(nlp.variables, upper=nlp.variables.upper * upper))
    again, anew = known.refreshed(other), assemble(other)
    assert again is not None
    np.testing.assert_array_equal(again.program.upper, anew.program.upper)
    native = native_program(known.program, nlp.engine, 1)
    refresh(native, again.program)
    y = anew.start(nlp.guess)
    np.testing.assert_array_equal(native.rows(y), native_program(anew.program, nlp.engine, 1).rows(y))
    open_ = replace(nlp, variables=replace(nlp.variables, upper=np.full(len(upper), np.inf)))
    assert known.refreshed(open_) is None


def test_what_joins_distant_intervals_is_assembled() -> None:
    forms = {name: formulate(nlp_of(EVERY[name](), MESH)) for name in ("arm", "two phases", "step")}
    assert {name: isinstance(form, Assembled) for name, form in forms.items()} == {
        "arm": False,
        "two phases": False,
        "step": True,
    }
