"""Orders of elimination in time: what they separate, and that fronts stay small on fine meshes."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

import robotraj as rt
from robotraj.native.build import load_native
from robotraj.solvers.assembled.program import Assembled, assemble
from tests.programs import nlp_of

PUSH = rt.Phase(
    rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]]),
    (0.1, 5.0),
    rt.State([0, 0]),
    rt.State([1, 0]),
    rt.Duration(),
    controls={"u": rt.between(-1, 1)},
    constraints=[rt.constraints.IntegralConstraint(lambda p: p.u["u"] ** 2, upper=0.5)],
)


@cache
def walk(intervals: int) -> Assembled:
    """One step of a planar biped, joined to the next one."""
    robot = rt.load("five_link", root="planar")
    feet = ("left_foot", "right_foot")
    problem = rt.gait.walk(robot, feet=feet, step_length=0.3, duration=0.6)
    return assemble(nlp_of(problem, rt.Mesh(intervals)))


def budget(intervals: int) -> Assembled:
    """A block that moves in least time with a budget of effort."""
    return assemble(nlp_of(rt.Problem([PUSH]), rt.Mesh(intervals)))


def newton_system(made: Assembled) -> tuple[Any, np.ndarray]:
    """Lower triangle of a saddle-point matrix with the patterns of a program, and its groups by each order."""
    program = made.program
    n, m = made.free.size, program.shift.size
    rng = np.random.default_rng(0)
    row, column = program.jacobian
    jacobian = sp.coo_array((rng.standard_normal(row.size), (row, column)), (m, n)).tocsr()
    row, column = program.hessian
    hessian = sp.coo_array((rng.standard_normal(row.size), (row, column)), (n, n)).tocsr()
    whole = sp.block_array([[hessian + hessian.T + 50 * sp.eye_array(n), jacobian.T], [jacobian, -sp.eye_array(m)]])
    lower = sp.csc_array(sp.tril(whole))
    lower.sort_indices()
    assert program.groups is not None
    return lower, program.groups


@pytest.mark.parametrize("intervals", [4, 7])
def test_without_its_last_group_a_phase_falls_apart(intervals: int) -> None:
    lower, groups = newton_system(budget(intervals))
    groups = groups[1]
    rest = np.flatnonzero(groups < groups.max())
    whole = lower + lower.T
    parts, of = connected_components(whole[rest][:, rest])
    sizes = np.sort(np.bincount(of))[::-1]
    assert connected_components(whole)[0] == 1
    assert parts >= 2 and sizes[0] < 0.7 * rest.size and sizes[1] > 0.2 * rest.size


def test_against_time_a_group_reaches_to_the_next_one_alone() -> None:
    lower, groups = newton_system(budget(7))
    groups = groups[0]
    entries = lower.tocoo()
    one, other = groups[entries.row], groups[entries.col]
    inner = np.maximum(one, other) < groups.max()
    assert np.abs(one - other)[inner].max() == 1


def test_the_last_fronts_do_not_grow_with_the_mesh() -> None:
    fronts = []
    for intervals in (8, 32):
        lower, groups = newton_system(walk(intervals))
        starts, rows = lower.indptr.astype(np.int64), lower.indices.astype(np.int64)
        solutions, largest = [], []
        for chosen in (groups[0].tolist(), groups[1].tolist(), groups.ravel().tolist(), []):
            factors = load_native().SymmetricFactors(starts, rows, groups=chosen)
            negative, zero, _ = factors.factorise(lower.data)
            assert (negative, zero) == (walk(intervals).program.shift.size, 0)
            solutions.append(factors.solve(np.ones(lower.shape[0])))
            largest.append(factors.largest_front)
        for solution in solutions[1:]:
            np.testing.assert_allclose(solution, solutions[0], rtol=1e-6, atol=1e-8)
        assert largest[2] in largest[:2]
        fronts.append(largest[:2])
    assert np.all(np.array(fronts[1]) < 1.5 * np.array(fronts[0]))


def test_groups_have_a_number_for_each_row() -> None:
    with pytest.raises(ValueError, match="groups must have a number for each row"):
        load_native().SymmetricFactors(np.array([0, 1, 2]), np.array([0, 1]), groups=[0])


def test_what_holds_in_every_stage_is_eliminated_last() -> None:
    made = budget(16)
    groups = made.program.groups
    assert groups is not None
    duration = np.flatnonzero(made.free == made.nlp.layouts[0].duration.column)
    np.testing.assert_array_equal(groups[:, duration].ravel(), groups.max(axis=1))
    assert rt.plan(PUSH, mesh=rt.Mesh(16)).success
