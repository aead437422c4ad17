"""Programs written by hand: CasADi expressions at points, gathered and scattered by small dense matrices."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import sparse

from robotraj._util.arrays import Array
from robotraj.native import CasadiBlock, Csr, Program, Term


def to_csr(matrix: Array) -> Csr:
    csr = sparse.csr_array(matrix)
    starts, indices = (np.asarray(each, dtype=np.int64) for each in (csr.indptr, csr.indices))
    return Csr(*csr.shape, starts, indices, csr.data)


@dataclass
class Points:
    """y(v, c) at E points: v = gather @ y + offset, rows += scatter @ vec(Y), cost += weights' Y[costed]."""

    v: Any
    c: Any
    y: Any
    gather: Array
    scatter: Array
    constants: Array
    offset: Array | None = None
    costed: int = -1
    weights: Array | None = None
    batch: int = 1

    @property
    def count(self) -> int:
        return self.gather.shape[0] // int(self.v.numel())

    def block(self) -> CasadiBlock:
        m = ca.SX.sym("m", self.y.numel())
        jacobian, hessian = self.jacobian(), ca.tril(ca.hessian(ca.dot(m, self.y), self.v)[0])
        results = {"values": ([self.v, self.c], self.y)}
        if jacobian.nnz():
            results["jacobian"] = ([self.v, self.c], jacobian.nz[:])
        if hessian.nnz():
            results["hessian"] = ([self.v, self.c, m], hessian.nz[:])
        if self.costed >= 0:
            results["cost"] = ([self.v, self.c], self.y[self.costed])
            results["gradient"] = ([self.v, self.c], ca.gradient(self.y[self.costed], self.v))
        functions = {name: (self.serialize(name, *given), self.batch) for name, given in results.items()}
        sizes = (int(x.numel()) for x in (self.v, self.c, self.y))
        return CasadiBlock(self.count, *sizes, functions, jacobian.nnz(), hessian.nnz(), self.costed)

    def jacobian(self) -> Any:
        return ca.jacobian(self.y, self.v)

    def hessian_pattern(self) -> Any:
        m = ca.SX.sym("m", self.y.numel())
        return ca.tril(ca.hessian(ca.dot(m, self.y), self.v)[0]).sparsity()

    def serialize(self, name: str, arguments: list[Any], result: Any) -> bytes:
        function = ca.Function(name, arguments, [ca.densify(result)])
        return str((function.map(self.batch) if self.batch > 1 else function).serialize()).encode("latin-1")


@dataclass
class Written:
    """A program and the expressions that it was built from, for independent checks."""

    stages: tuple[list[int], list[int], list[int], list[int]]
    linear: Array
    offset: Array
    cost: Array
    cost_offset: float = 0.0
    points: list[Points] = field(default_factory=list)
    threads: int = 1

    def build(self) -> Program:
        rows, columns = self.linear.shape
        jacobian = np.array(self.linear != 0, dtype=bool)
        hessian = np.zeros((columns, columns), dtype=bool)
        for p in self.points:
            jacobian |= np.abs(p.scatter) @ self.ones(p, p.jacobian().sparsity(), p.y.numel()) @ np.abs(p.gather) > 0
            inner = self.ones(p, p.hessian_pattern(), p.v.numel())
            hessian |= np.abs(p.gather).T @ (inner + inner.T) @ np.abs(p.gather) > 0
        self.jacobian_entries = np.nonzero(jacobian)
        self.hessian_entries = np.nonzero(np.tril(hessian))
        terms = [self.term(p, rows, columns) for p in self.points]
        i, j = self.jacobian_entries
        return Program(
            *(np.array(sizes) for sizes in self.stages),
            to_csr(self.linear),
            self.offset,
            self.cost,
            self.cost_offset,
            i,
            j,
            self.linear[i, j],
            *self.hessian_entries,
            terms,
            threads=self.threads,
        )

    def ones(self, p: Points, pattern: Any, height: int) -> Array:
        one = np.array(ca.DM(pattern, 1).full()) if pattern.nnz() else np.zeros((height, int(p.v.numel())))
        return np.kron(np.eye(p.count), one)

    def term(self, p: Points, rows: int, columns: int) -> Term:
        offset = np.zeros(p.gather.shape[0]) if p.offset is None else p.offset
        gradient = None
        if p.weights is not None:
            gradient = to_csr(p.gather.T * np.repeat(p.weights, int(p.v.numel())))
        return Term(
            p.block(),
            to_csr(p.gather),
            offset,
            p.constants.ravel(order="F"),
            to_csr(p.scatter),
            p.weights,
            gradient,
            self.jacobian_map(p),
            self.hessian_map(p),
        )

    def jacobian_map(self, p: Points) -> Csr | None:
        i, j = (np.array(each, dtype=int) for each in p.jacobian().sparsity().get_triplet())
        n_y, n_v = int(p.y.numel()), int(p.v.numel())
        row, column = self.jacobian_entries
        blocks = [p.scatter[row][:, e * n_y + i] * p.gather.T[column][:, e * n_v + j] for e in range(p.count)]
        return to_csr(np.hstack(blocks)) if i.size else None

    def hessian_map(self, p: Points) -> Csr | None:
        i, j = (np.array(each, dtype=int) for each in p.hessian_pattern().get_triplet())
        n_v = int(p.v.numel())
        row, column = self.hessian_entries
        g = p.gather.T
        blocks = []
        for e in range(p.count):
            a, b = e * n_v + i, e * n_v + j
            both = g[row][:, a] * g[column][:, b] + g[row][:, b] * g[column][:, a]
            blocks.append(both * np.where(i == j, 0.5, 1.0))
        return to_csr(np.hstack(blocks)) if i.size else None


@pytest.fixture
def points() -> type[Points]:
    return Points


@pytest.fixture
def written() -> type[Written]:
    return Written


@dataclass
class Shooting:
    """min sum_k cost(x_k, u_k), x_{k+1} = step(x_k, u_k), x_0 = start, x_K = end, bounds on inequality(x_k, u_k)."""

    step: Any
    states: int
    controls: int
    stages: int
    cost: Any
    start: Sequence[float]
    end: Sequence[float] | None = None
    inequality: Any = None
    batch: int = 1
    threads: int = 1

    def columns(self, k: int) -> NDArray[np.int_]:
        """Columns of (u_k, x_k), of x_k alone at the last stage."""
        first = k * (self.states + self.controls)
        return np.arange(first, first + self.states + (self.controls if k < self.stages - 1 else 0))

    def write(self) -> Written:
        nx, nu, K = self.states, self.controls, self.stages
        x, u = ca.SX.sym("x", nx), ca.SX.sym("u", nu)
        v = ca.vertcat(u, x)
        inequality = ca.SX(0, 1) if self.inequality is None else self.inequality(x, u)
        n_c, n_end = int(inequality.numel()), 0 if self.end is None else nx
        y = ca.vertcat(self.step(x, u), inequality, self.cost(x, u))
        width = int(y.numel())
        columns, dynamics = K * nx + (K - 1) * nu, (K - 1) * nx
        rows = dynamics + nx + n_end + (K - 1) * n_c
        linear, scatter = np.zeros((rows, columns)), np.zeros((rows, (K - 1) * width))
        gather = np.zeros(((K - 1) * (nx + nu), columns))
        offset = np.zeros(rows)
        for k in range(K - 1):
            at = slice(k * nx, (k + 1) * nx)
            linear[at, self.columns(k + 1)[-nx:]] = -np.eye(nx)
            scatter[at, k * width : k * width + nx] = np.eye(nx)
            path = slice(dynamics + nx + n_end + k * n_c, dynamics + nx + n_end + (k + 1) * n_c)
            scatter[path, k * width + nx : k * width + nx + n_c] = np.eye(n_c)
            gather[k * (nx + nu) : (k + 1) * (nx + nu), self.columns(k)] = np.eye(nx + nu)
        linear[dynamics : dynamics + nx, self.columns(0)[-nx:]] = np.eye(nx)
        offset[dynamics : dynamics + nx] = -np.asarray(self.start)
        if self.end is not None:
            linear[dynamics + nx : dynamics + 2 * nx, self.columns(K - 1)[-nx:]] = np.eye(nx)
            offset[dynamics + nx : dynamics + 2 * nx] = -np.asarray(self.end)
        stage = Points(
            v, ca.SX(0, 1), y, gather, scatter, np.zeros((0, K - 1)), None, width - 1, np.ones(K - 1), self.batch
        )
        sizes = ([nu] * (K - 1) + [0], [nx] * K, [nx] + [0] * (K - 2) + [n_end], [n_c] * (K - 1) + [0])
        return Written(sizes, linear, offset, np.zeros(columns), 0.0, [stage], self.threads)


@pytest.fixture
def shooting() -> type[Shooting]:
    return Shooting


@pytest.fixture
def pendulum(shooting: Any) -> Any:
    """Swing-up in 3 s with |u| <= 5, explicit Euler of 60 steps, the integral of u^2."""
    return shooting(
        lambda x, u: ca.vertcat(x[0] + 0.05 * x[1], x[1] + 0.05 * (-9.81 * ca.sin(x[0]) + u)),
        2,
        1,
        61,
        lambda x, u: 0.05 * u.T @ u,
        [0.0, 0.0],
        [np.pi, 0.0],
        inequality=lambda x, u: u,
    )
