"""Newton's system of random stages by the Riccati recursion, against a dense solver, for every kind of processor."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from robotraj.native.build import load_native

Array = NDArray[np.float64]
NATIVE: Any = load_native()

# controls, states, equalities and inequalities of each stage; density of the rows
CASES = {
    "no constraints": ([3, 3, 3, 0], [4, 4, 4, 4], [0, 0, 0, 0], [0, 0, 0, 0], 0.4),
    "an arm's shape": ([18, 12, 12, 0], [0, 18, 18, 18], [0, 0, 0, 6], [30, 42, 42, 6], 0.3),
    "dense": ([9, 9, 9, 0], [17, 17, 17, 17], [0, 3, 2, 0], [20, 20, 20, 20], 1.0),
    "more equalities than controls": ([2, 2, 2, 2, 0], [6, 6, 6, 6, 6], [1, 1, 3, 1, 2], [2, 0, 1, 3, 0], 0.5),
    "the first state fixed": ([2, 2, 0], [5, 5, 5], [5, 0, 1], [1, 1, 1], 0.6),
    "an only stage": ([4], [3], [2], [5], 0.8),
    "sizes that change": ([1, 8, 0, 25, 0], [9, 3, 16, 8, 7], [0, 2, 0, 1, 0], [3, 40, 0, 17, 1], 0.25),
}


@dataclass
class Stages:
    """The system of a case, dense, and the same for the recursion."""

    sizes: tuple[Array, ...]
    jacobian: Array
    hessian: Array
    solver: Any

    @property
    def split(self) -> tuple[int, int]:
        """Where equalities and where inequalities begin."""
        dynamics = int(sum(self.sizes[1][1:]))
        return dynamics, dynamics + int(sum(self.sizes[2]))


def stages(name: str, processor: str, seed: int = 0) -> Stages:
    rng = np.random.default_rng(seed)
    *sizes, density = CASES[name]
    nu, nx, ng, nh = (np.asarray(each, dtype=np.int64) for each in sizes)
    columns = np.concatenate([[0], np.cumsum(nu + nx)])

    def rows(stage: int, count: int) -> Array:
        block = np.zeros((count, columns[-1]))
        given = rng.standard_normal((count, nu[stage] + nx[stage]))
        given[rng.random(given.shape) > density] = 0.0
        block[:, columns[stage] : columns[stage + 1]] = given
        return block

    blocks = []
    for k in range(len(nu) - 1):
        dynamics = rows(k, nx[k + 1])
        dynamics[:, columns[k + 1] + nu[k + 1] : columns[k + 2]] = -np.eye(nx[k + 1])
        blocks.append(dynamics)
    blocks += [rows(k, ng[k]) for k in range(len(nu))]
    for k, block in enumerate(blocks[len(nu) - 1 :]):
        # Independent rows, also where few entries are left.
        for i in range(len(block)):
            block[i, columns[k + 1] - 1 - i] += 3.0
    blocks += [rows(k, nh[k]) for k in range(len(nu))]
    jacobian = np.concatenate(blocks)
    hessian = np.zeros((columns[-1], columns[-1]))
    for k in range(len(nu)):
        n = nu[k] + nx[k]
        root = rng.standard_normal((n, n)) * (rng.random((n, n)) < density)
        hessian[columns[k] : columns[k + 1], columns[k] : columns[k + 1]] = root @ root.T + 0.1 * np.eye(n)
    places, upper = np.nonzero(jacobian), np.nonzero(np.triu(hessian))
    indices = (np.ascontiguousarray(each, dtype=np.int64) for each in (*places, *upper))
    solver = NATIVE.StageSystem(nu, nx, ng, nh, *indices, processor)
    solver.fill(jacobian[places], hessian[upper])
    return Stages((nu, nx, ng, nh), jacobian, hessian, solver)


def residual(
    case: Stages, damping: tuple[Array, Array | None, Array], f: Array, g: Array, z: Array, lam: Array
) -> float:
    """Largest residual of the whole system, beside its largest unknown."""
    (dx, de, ds), (first, second) = damping, case.split
    rows = np.zeros(len(g))
    rows[second:] = ds
    if de is not None:
        rows[first:second] = de
    gradient = case.hessian @ z + dx * z + case.jacobian.T @ lam + f
    left = np.concatenate([gradient, case.jacobian @ z - rows * lam + g])
    return float(np.abs(left).max() / max(1.0, np.abs(z).max(), np.abs(lam).max()))


@pytest.mark.parametrize("processor", NATIVE.processors())
@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("damped", [False, True])
def test_solutions_meet_the_system_and_so_do_those_of_further_right_hand_sides(
    name: str, processor: str, damped: bool
) -> None:
    case, rng = stages(name, processor), np.random.default_rng(1)
    first, second = case.split
    n, m = case.hessian.shape[0], case.jacobian.shape[0]
    dx, ds = rng.random(n), 10.0 ** rng.uniform(-3, 3, m - second)
    de = rng.uniform(0.1, 1.0, second - first) if damped else None
    for again in (False, True):
        f, g = rng.standard_normal(n), rng.standard_normal(m)
        pivots, z, lam = case.solver.solve(None if again else dx, de, ds, f, g)
        assert pivots == "good"
        assert residual(case, (dx, de, ds), f, g, z, lam) < 1e-10


@pytest.mark.parametrize("processor", NATIVE.processors())
@pytest.mark.parametrize("name", CASES)
def test_products(name: str, processor: str) -> None:
    case, rng = stages(name, processor), np.random.default_rng(2)
    x, lam = rng.standard_normal(case.hessian.shape[0]), rng.standard_normal(case.jacobian.shape[0])
    np.testing.assert_allclose(case.solver.jacobian_times(x), case.jacobian @ x, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(case.solver.transposed_times(lam), case.jacobian.T @ lam, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(case.solver.hessian_times(x), case.hessian @ x, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("processor", NATIVE.processors())
@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("damped", [False, True])
def test_what_a_solution_leaves(name: str, processor: str, damped: bool) -> None:
    case, rng = stages(name, processor), np.random.default_rng(3)
    first, second = case.split
    n, m = case.hessian.shape[0], case.jacobian.shape[0]
    dx, f, z = rng.random(n), rng.standard_normal(n), rng.standard_normal(n)
    g, lam = rng.standard_normal(m), rng.standard_normal(m)
    de = rng.uniform(0.1, 1.0, second - first) if damped else None
    gradient, rows, greatest = case.solver.residual(dx, de, f, g, z, lam)
    expected = case.jacobian @ z + g
    if de is not None:
        expected[first:second] -= de * lam[first:second]
    np.testing.assert_allclose(gradient, case.hessian @ z + dx * z + case.jacobian.T @ lam + f, rtol=1e-12, atol=1e-11)
    np.testing.assert_allclose(rows, expected, rtol=1e-12, atol=1e-11)
    assert greatest == np.abs(np.concatenate([gradient, rows[:second]])).max()


def test_an_indefinite_hessian_is_reported() -> None:
    case = stages("an arm's shape", "")
    n, m = case.hessian.shape[0], case.jacobian.shape[0]
    dx, ds = np.zeros(n), np.full(m - case.split[1], 1e8)
    assert case.solver.solve(dx, None, ds, np.ones(n), np.ones(m))[0] == "good"
    dx[20] = -100.0
    assert case.solver.solve(dx, None, ds, np.ones(n), np.ones(m))[0] == "indefinite"


def test_dependent_equalities_are_reported_unless_they_are_damped() -> None:
    nu, nx, ng, nh = (np.array(each, dtype=np.int64) for each in ([1, 0], [2, 2], [2, 0], [0, 0]))
    rows, columns = np.array([0, 0, 1, 1, 2, 3]), np.array([1, 3, 2, 4, 1, 1])
    diagonal = np.arange(5)
    solver = NATIVE.StageSystem(nu, nx, ng, nh, rows, columns, diagonal, diagonal, "")
    solver.fill(np.array([1.0, -1.0, 1.0, -1.0, 1.0, 2.0]), np.ones(5))
    dx, none, f, g = np.zeros(5), np.zeros(0), np.ones(5), np.ones(4)
    assert solver.solve(dx, None, none, f, g)[0] == "dependent"
    assert solver.solve(dx, np.full(2, 1e-3), none, f, g)[0] == "good"


def test_derivatives_out_of_order_are_refused() -> None:
    nu, nx, none = (np.array(each, dtype=np.int64) for each in ([1, 0], [1, 1], [0, 0]))
    rows, columns, diagonal = np.array([0, 0, 0]), np.array([0, 1, 2]), np.arange(3)
    for order in ([1, 0, 2], [0, 0, 2]):
        with pytest.raises(ValueError, match="come by rows"):
            NATIVE.StageSystem(nu, nx, none, none, rows, columns[order], diagonal, diagonal, "")
        with pytest.raises(ValueError, match="come by rows"):
            NATIVE.StageSystem(nu, nx, none, none, rows, columns, diagonal[order], diagonal[order], "")


CASADI = """
import casadi as ca
x, u, y = (ca.SX.sym(name) for name in "xuy")
nlp = {"x": ca.vertcat(x, u, y), "f": ca.exp(u) + y**4, "g": ca.vertcat(y - x - u, x - 1)}
for name, options in {
    "fatrop": {"structure_detection": "auto", "equality": [True, True], "fatrop": {"print_level": 0}},
    "ipopt": {"ipopt": {"print_level": 0}},
}.items():
    solve = ca.nlpsol("solve", name, nlp, {"expand": True, "print_time": False} | options)
    print("casadi", name, float(solve(lbg=0, ubg=0)["f"]).hex())
"""
PLAN = """
import robotraj as rt
ends = rt.State(q=[0, -1, 1, 0, 0, 0], v=0), rt.State(q=[1, -0.5, 0.5, 0, 0, 0], v=0)
phase = rt.Phase(rt.load("ur5"), 1.0, *ends, rt.Effort())
plan = rt.plan(phase, rt.Mesh(8), solver=rt.InteriorPoint(fallback=None), progress=False)
print("plan", plan.iterations, float(plan.objective).hex())
"""


def printed(script: str) -> set[str]:
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return {line for line in run.stdout.splitlines() if line.startswith(("plan", "casadi"))}


def test_neither_casadis_plugins_nor_plans_depend_on_which_ran_first() -> None:
    alone = printed(CASADI) | printed(PLAN)
    assert len(alone) == 3
    assert printed(PLAN + CASADI) == printed(CASADI + PLAN) == alone


def test_the_module_exports_its_entry_and_no_symbol_of_another_library() -> None:
    symbols = subprocess.run(
        ["nm", "-D", "--defined-only", NATIVE.__file__], capture_output=True, text=True, check=True
    ).stdout
    assert "PyInit__native" in symbols
    assert not [line for line in symbols.splitlines() if "fatrop" in line or "blasfeo" in line.lower()]
