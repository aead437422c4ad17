import numpy as np
import pytest

import robotraj as rt
from robotraj.solvers.compiled import origin_of
from robotraj.solvers.parametric import parametric


def solved(**options):
    cartpole = rt.load("cartpole")
    phase = rt.Phase(
        cartpole, 2.0, rt.State(q=[0.0, 0.0], v=0.0), rt.State(q=[1.0, np.pi], v=0.0), rt.Effort(), **options
    )
    solution = rt.plan(phase, mesh=rt.Mesh(12), solver=rt.InteriorPoint())
    return origin_of(solution.multipliers).formulation


@pytest.mark.parametrize("assembled", [False, True])
def test_affine_offsets_are_those_of_a_new_reduction(assembled):
    constraints = [rt.constraints.IntegralConstraint(lambda point: point.v[0] ** 2, upper=10.0)] if assembled else []
    formulation = solved(constraints=constraints)
    layout = formulation.nlp.layouts[0]
    columns = np.concatenate([layout.knots[0], layout.knots[-1]])
    program = parametric(formulation, columns)
    values = program.base + np.random.default_rng(3).normal(size=columns.size)
    affine, refreshed = program.at(values), formulation.refreshed(program.numbers.changed(formulation.nlp, values))
    np.testing.assert_allclose(affine.program.shift, refreshed.program.shift, atol=1e-12)
    for mine, other in zip(affine.program.blocks, refreshed.program.blocks, strict=True):
        np.testing.assert_allclose(mine.shift, other.shift, atol=1e-12)
    y = affine.start(affine.nlp.guess)
    np.testing.assert_allclose(affine.columns(y), refreshed.columns(y), atol=1e-11)
    np.testing.assert_allclose(affine.columns(y)[columns], values, atol=1e-12)


def test_columns_with_a_range_do_not_move():
    formulation = solved()
    with pytest.raises(rt.InputError, match="range"):
        parametric(formulation, formulation.nlp.layouts[0].knots[3])
