"""Time of an iteration against the arithmetic rate of one core: `python benchmarks/roofline.py` writes roofline.md.

Arithmetic of an iteration of `rt.InteriorPoint`, per stage with n_x states, n_u controls, n_g path equalities and
n_h inequalities, n = n_u + n_x (Vanroye et al., FATROP, IROS 2023; a multiplication and an addition count as two):

    inequalities n_h n^2,  P [B A] 2 n_x^2 n,  [B A]' P [B A] n_x n^2,  equalities 2 n_g n^2,
    Cholesky n_u^3 / 3,  its two products n_u^2 n_x + n_u n_x^2

and of the point functions: the operations of CasADi's graphs of inverse dynamics, its Jacobian and its Hessian, which
the native engine's formulas undercut. Both count dense matrices: the recursion skips zeros. The rate is that of
products of matrices of 256 rows by SciPy's BLAS, on one core. The last column uses 30 rows, the size of a small arm. An
iteration is in processor time, the least of several solves of a compiled program; inertia corrections, refinements and
the line search are included.

Gaits have no stages, and their Newton systems are factorised as sparse matrices. Their table has the unknowns and rows
of the last mesh of a default plan, and the part of an iteration that is linear algebra. Their limit counts one
factorisation, r^2 for each pivot of a front of r rows, and the point functions.
"""

from __future__ import annotations

import datetime
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

import numpy as np
from scipy import sparse
from scipy.linalg.blas import dgemm

import robotraj as rt
from robotraj.native.build import load_native
from robotraj.solvers.attempts import AHEAD, FACTOR
from robotraj.solvers.base import BARRIER, SMALL_BARRIER
from robotraj.solvers.objective_scale import of_program
from robotraj.solvers.stagewise.native import native_program
from robotraj.solvers.stagewise.program import StageProgram
from robotraj.solvers.stagewise.reduction import reduce

HERE = Path(__file__).resolve().parent
TABLE = HERE / "roofline.md"
NOTES = "## What the recursion does"
"""Heading in ``TABLE`` of what the script does not write."""
HEAD = """# An iteration beside the arithmetic limit of a core

Written on {date} by `python benchmarks/roofline.py`, whose docstring has the formulas; `rt.InteriorPoint(threads=1)`,
processor time on a shared machine. The limit is the speed of a BLAS's product of matrices of 256 rows. The last column
uses products of 30 rows. The larger a stage, the closer an iteration is to the limit, since the limit counts nothing
but dense matrices; the recursion skips zeros.
"""
FEW = 12
"""Entries of an inequality that is eliminated before the factorisation, as in ``sparse_system.cpp``."""
GAITS = ("solo12", "anymal", "bolt", "talos_legs", "g1")
RUNS = 9
INTERVALS = (25, 50, 100, 200, 400, 800, 1600)
MESH = 50
"""Intervals of every robot."""
SMALL = 30
"""Unknowns of a stage of the arm."""
ROBOTS: dict[str, dict[str, Any]] = {
    "ur5": {},
    "panda": {"locked": {"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0}},
    "solo12": {"root": "fixed"},
    "baxter": {},
    "allegro_right_hand": {},
    "alex": {},
    "g1": {"root": "fixed"},
    "talos": {"root": "fixed"},
}
"""From 6 to 32 joints, held at the root."""
START, GOAL = [-1.1, -1.8, 1.6, -1.2, -1.57, 0.0], [1.1, -0.8, 0.6, -0.6, -0.6, 1.2]


def rate(rows: int) -> float:
    """Floating-point operations of one core in a second, in products of square matrices."""
    a = np.asfortranarray(np.random.default_rng(0).standard_normal((rows, rows)))
    product = np.zeros_like(a)
    best = np.inf
    for _ in range(200):
        began = time.perf_counter()
        dgemm(1.0, a, a, 0.0, product, overwrite_c=1)
        best = min(best, time.perf_counter() - began)
    return 2 * rows**3 / best


def riccati(program: object) -> float:
    """Operations of one factorisation."""
    total = 0.0
    for nu, nx, ng, nh in zip(program.nu, program.nx, program.equalities, program.inequalities, strict=True):  # type: ignore[attr-defined]
        n = float(nu + nx)
        total += nh * n**2 + 2 * nx**2 * n + nx * n**2 + 2 * ng * n**2 + nu**3 / 3 + nu**2 * nx + nu * nx**2
    return total


def points(nlp: rt.transcription.Nlp) -> float:
    """Operations of values, Jacobians and Hessians at all points."""
    total = 0.0
    for block in nlp.blocks:
        for function in (block.stage.function, block.stage.jacobian, block.stage.hessian):
            total += function.n_instructions() * block.count
    return total


def factorisation(program: StageProgram) -> float:
    """Operations of one sparse factorisation, with inequalities of few entries eliminated."""
    rows, columns = program.jacobian
    n, equal = int(program.nu.sum()), int(program.equalities.sum())
    count = equal + int(program.inequalities.sum())
    entries = np.bincount(rows, minlength=count)
    kept = np.flatnonzero((np.arange(count) < equal) | (entries > FEW))
    number = np.full(count, -1)
    number[kept] = n + np.arange(kept.size)
    jacobian = sparse.csr_array((np.ones(rows.size), (rows, columns)), shape=(count, n))
    few = jacobian[np.flatnonzero(number < 0)]
    products = (few.T @ few).tocoo()
    diagonal = np.arange(n + kept.size)
    of_rows = number[rows] >= 0
    i = np.concatenate([diagonal, program.hessian[0], number[rows[of_rows]], products.row])
    j = np.concatenate([diagonal, program.hessian[1], columns[of_rows], products.col])
    size = (diagonal.size, diagonal.size)
    lower = sparse.csc_array((np.ones(i.size), (np.maximum(i, j), np.minimum(i, j))), shape=size)
    assert program.groups is not None
    groups = np.concatenate([np.concatenate([each[:n], each[n + kept]]) for each in program.groups])
    starts, entries = lower.indptr.astype(np.int64), lower.indices.astype(np.int64)
    return float(load_native().SymmetricFactors(starts, entries, groups=groups.tolist()).products)


def iterations(solver: rt.InteriorPoint, nlp: rt.transcription.Nlp, runs: int) -> Iterator[float]:
    """Processor time of an iteration [s], of several solves of one compiled program."""
    reduction = reduce(nlp)
    program = native_program(reduction.program, nlp.engine, threads=1)
    start, lower, upper = reduction.start(nlp.guess), reduction.program.lower, reduction.program.upper
    scale = of_program(program, start, reduction.program, BARRIER, nlp)
    options = solver._options(BARRIER, FACTOR, solver.max_iterations, reduction)
    for _ in range(runs):
        began = time.process_time()
        found = program.solve(start, lower, upper, options, objective_scale=scale)
        yield (time.process_time() - began) / found.iterations


def across(robot: rt.Robot) -> rt.Phase:
    """From two fifths of each joint's way (within 2 rad of zero) to three, in 1.5 s, at least effort."""
    lower, upper = np.maximum(robot.limits.position_lower, -2.0), np.minimum(robot.limits.position_upper, 2.0)
    ends = (rt.State(q=lower + share * (upper - lower), v=0) for share in (0.4, 0.6))
    return rt.Phase(robot, 1.5, *ends, objective=rt.Effort())


def row(phase: rt.Phase, intervals: int, peak: float, small: float) -> str:
    """One line of a table, after its first cell."""
    solver = rt.InteriorPoint(threads=1, fallback=None)
    nlp = rt.transcription.transcribe(
        rt.Problem(phase),
        rt.Mesh(intervals),
        rt.guess.StraightLine(),
        engine=rt.engines.Native(),
        interval_limits=rt.interval_limits.BernsteinBounds(),
    )
    solves, graphs = riccati(reduce(nlp).program), points(nlp)
    took = min(iterations(solver, nlp, RUNS))
    ratios = (took * rate / (solves + graphs) for rate in (peak, small))
    return (
        f"{solves / 1e6:.2f} | {graphs / 1e6:.2f} | {(solves + graphs) / peak * 1e3:.2f} | {took * 1e3:.2f} | "
        + " | ".join(f"{ratio:.1f}" for ratio in ratios)
        + " |"
    )


def gait_row(problem: rt.Problem, peak: float) -> str:
    """One line of the table of gaits, after its first cell."""
    solver = rt.InteriorPoint(tolerance=1e-6, threads=1, fallback=None)
    origin: Any = cast(rt.Solution, rt.plan(problem, solver=solver, progress=False)).multipliers.origin  # type: ignore[union-attr]
    program, nlp = origin.formulation.program, origin.nlp
    start = origin.formulation.start(nlp.guess)
    scale = of_program(origin.compiled.native, start, program, SMALL_BARRIER, nlp)
    options = solver._options(SMALL_BARRIER, AHEAD * FACTOR, solver.max_iterations, origin.formulation)
    given = {"options": options, "objective_scale": scale, "lam": np.zeros(program.form_rows.size)}
    took, shares = [], []
    for _ in range(RUNS):
        began = time.process_time()
        found = origin.compiled.native.solve(start, program.lower, program.upper, **given)
        took.append(time.process_time() - began)
        shares.append(found.times["linear algebra"] / found.times["total"])
    rows = int(program.equalities.sum() + program.inequalities.sum())
    solves, graphs, each = factorisation(program), points(nlp), min(took) / found.iterations
    return (
        f"{start.size} | {rows} | {found.iterations} | {solves / 1e6:.2f} | {graphs / 1e6:.2f} | "
        f"{(solves + graphs) / peak * 1e3:.2f} | {1e3 * each:.2f} | {each * peak / (solves + graphs):.1f} | "
        f"{100 * np.median(shares):.0f} |"
    )


def gaits() -> dict[str, rt.Problem]:
    """Return a step of each robot, of the size of ``proven/legs.py``."""
    sys.path.insert(0, str(HERE / "proven"))
    from legs import step

    return {name: step(name, 0.1) for name in GAITS}


def tables() -> Iterator[str]:
    """Write one line a mesh, then one a robot, then one a gait."""
    peak, small = rate(256), rate(SMALL)
    yield f"One core: {peak / 1e9:.1f} GFlop/s in products of 256 rows, {small / 1e9:.1f} of {SMALL}, a stage of ur5."
    titles = f"Riccati [MFlop] | points [MFlop] | limit [ms] | iteration [ms] | ratio | by {SMALL} rows |"
    yield f"\n| ur5, intervals | {titles}\n|{'---|' * 7}"
    arm = rt.load("ur5")
    for intervals in INTERVALS:
        phase = rt.Phase(arm, 1.0, rt.State(q=START, v=0), rt.State(q=GOAL, v=0), objective=rt.Effort())
        yield f"| {intervals} | {row(phase, intervals, peak, small)}"
    yield "\nEvery joint moves from two to three fifths of its range in 1.5 s, on a fixed root:\n"
    yield f"| {MESH} intervals | joints | {titles}\n|{'---|' * 8}"
    for name, settings in ROBOTS.items():
        robot = rt.load(name, **settings)
        yield f"| {name} | {robot.nv} | {row(across(robot), MESH, peak, small)}"
    yield "\nA step of a walk or trot, on the last mesh of its default plan, by a sparse factorisation:\n"
    titles = "factorisation [MFlop] | points [MFlop] | limit [ms] | iteration [ms] | ratio | linear algebra [%] |"
    yield f"| gait | unknowns | rows | iterations | {titles}\n|{'---|' * 10}"
    for name, problem in gaits().items():
        yield f"| {name} | {gait_row(problem, peak)}"


def main() -> None:
    """Print the tables, and write them before the notes of roofline.md."""
    lines = []
    for line in tables():
        print(line, flush=True)
        lines.append(line)
    notes = TABLE.read_text()
    notes = notes[notes.index(NOTES) :]
    TABLE.write_text("\n".join([HEAD.format(date=datetime.date.today()), *lines, "", notes]))


if __name__ == "__main__":
    main()
