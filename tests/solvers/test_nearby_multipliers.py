"""Multipliers of bounds are carried from mesh to mesh, times the lengths of the intervals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robotraj as rt
from robotraj.solvers.base import Multipliers
from robotraj.solvers.compiled import CompiledOrigin
from robotraj.solvers.nearby_multipliers import interpolated

COARSE, FINE = 10, 25


def origin(solution: rt.Solution) -> CompiledOrigin:
    assert solution.multipliers is not None
    found = solution.multipliers.origin
    assert isinstance(found, CompiledOrigin)
    return found


def limited() -> rt.Phase:
    """Return the least effort of a block whose speed limit is active for a third of the time."""
    block = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]])
    ends = rt.State([0, 0]), rt.State([1, 0])
    return rt.Phase(block, 1.0, *ends, rt.Effort(), states={"v": rt.between(-1.3, 1.3)})


def weak() -> rt.Phase:
    """Return the least effort of a block whose force, 6 (1 - 2 t) without a limit, has one that grows with time."""
    block = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]])
    limit = rt.PathConstraint(lambda p: p.u["u"] - p.t, upper=3.5, name="force")
    return rt.Phase(block, 1.0, rt.State([0, 0]), rt.State([1, 0]), rt.Effort(), constraints=[limit])


@pytest.mark.parametrize("scheme", [rt.HermiteSimpson(), rt.schemes.RadauIIA(3)], ids=["Hermite-Simpson", "Radau"])
@pytest.mark.parametrize("phase", [limited(), weak()], ids=["bound of a state", "path row"])
def test_sums_of_multipliers_are_those_of_the_finer_mesh(phase: rt.Phase, scheme: rt.schemes.Scheme) -> None:
    """The sum over an interval is the integral of a density, so that it does not depend on the mesh."""
    points = rt.interval_limits.ConstraintGeneration(rounds=0)
    coarse, fine = (rt.plan(phase, rt.Mesh(count, scheme), interval_limits=points) for count in (COARSE, FINE))
    known, new = origin(coarse), origin(fine)
    found = interpolated(known.formulation, known.lam, new.formulation)
    assert found is not None
    lam = new.lam[-found[0].size :]
    wanted = np.maximum(-lam, 0.0), np.maximum(lam, 0.0)
    assert max(part.sum() for part in wanted) > 1.0
    for own, of_fine in zip(found, wanted, strict=True):
        assert own.min() >= 0.0
        assert own.sum() == pytest.approx(of_fine.sum(), rel=0.1, abs=0.1)


def reach(further: float = 0.0) -> rt.Phase:
    end = [1.1 + further, -0.8, 0.6, -0.6, -0.6, 1.2]
    ends = rt.State(q=[-1.1, -1.8, 1.6, -1.2, -1.57, 0], v=0), rt.State(q=end, v=0)
    return rt.Phase(rt.load("ur5"), 1.0, *ends, rt.Effort())


def test_a_solve_from_another_end_on_the_same_mesh_starts_at_a_barrier_that_fits() -> None:
    solver, mesh = rt.InteriorPoint(tolerance=1e-6), rt.Mesh(30)
    known = rt.plan(reach(), mesh, solver=solver)
    plain, nearby = (rt.plan(reach(1e-3), mesh, known, own) for own in (solver, solver.from_nearby()))
    assert nearby.objective == pytest.approx(plain.objective, rel=2e-5)
    assert nearby.iterations < 0.7 * plain.iterations


def test_a_solve_from_another_mesh_takes_fewer_iterations_with_multipliers() -> None:
    solver = rt.InteriorPoint(tolerance=1e-6).from_nearby()
    coarse, mesh = rt.plan(reach(), rt.Mesh(16)), rt.Mesh(48)
    warm = rt.plan(coarse.problem, mesh, coarse, solver)
    assert coarse.multipliers is not None
    numbers = Multipliers(coarse.multipliers.rows, coarse.multipliers.bounds)
    cold = rt.plan(coarse.problem, mesh, replace(coarse, multipliers=numbers), solver)
    assert warm.objective == pytest.approx(cold.objective, rel=1e-5)
    assert warm.iterations < cold.iterations


def test_problems_without_any_limit_have_nothing_to_carry() -> None:
    free = rt.System(["x"], ["u"], lambda point: [point.u["u"]])
    arc = rt.Lagrange(lambda point: (1 + point.u["u"] ** 2) ** 0.5)
    solution = rt.plan(rt.Phase(free, 1.0, rt.State([0.0]), rt.State([1.0]), arc))
    assert len(solution.refinement) > 1 and solution.objective == pytest.approx(2**0.5, rel=1e-6)
