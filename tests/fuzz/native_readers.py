"""What the compiled module reads, made of bytes: functions, trees of spheres, planes, matrices, chains, programs.

`bash .ci/fuzz` compiles the module with libFuzzer's counters and the sanitizers, and lets Atheris search for bytes that
reach new code: `python tests/fuzz/native_readers.py CORPUS -max_total_time=3600`. An input is right if the module gives
an answer or raises an error of Python's. Matrices are compared with SciPy's, and every instruction of a tape with what
CasADi computes of the same operands. `test_native_readers.py` runs the corpus of what was found.
"""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable

import casadi as ca
import numpy as np
import scipy.sparse as sp
from draws import Draws

from robotraj.native.build import load_native
from robotraj.native.stage_tapes import plain

native = load_native()
REFUSED = (ValueError, RuntimeError, TypeError, IndexError, OverflowError, MemoryError)
"""Errors of Python's; anything else is a fault. CasADi's errors are RuntimeErrors."""
UNARY = (ca.sin, ca.cos, ca.tanh, ca.fabs, ca.sqrt, ca.exp, ca.log, ca.sign, ca.atan, ca.floor, lambda a: -a)
BINARY = (
    lambda a, b: a + b,
    lambda a, b: a - b,
    lambda a, b: a * b,
    lambda a, b: a / b,
    ca.fmin,
    ca.fmax,
    ca.atan2,
    ca.power,
    ca.if_else,
)
SAME = 1e-12
"""Largest difference of an instruction's result, relative to it; vectors of sines differ in the last bits."""


def function(draw: Draws) -> None:
    """Read a function that is made of random operations; its tapes compute what CasADi computes."""
    n, constants = 1 + draw.below(3), draw.below(3)
    v, c = ca.SX.sym("v", n), ca.SX.sym("c", constants)
    nodes, parts = [*ca.vertsplit(v), *(ca.vertsplit(c) if constants else [])], []
    for _ in range(1 + draw.below(12)):
        a, b = nodes[draw.below(len(nodes))], nodes[draw.below(len(nodes))]
        if draw.below(4) == 0:
            b = ca.SX(draw.number())
        which = draw.below(len(UNARY) + len(BINARY))
        if which < len(UNARY):
            made = (UNARY[which], a)
        elif which == len(UNARY) + len(BINARY) - 1:
            made = (ca.if_else, a > b, a, b)
        else:
            made = (BINARY[which - len(UNARY)], a, b)
        parts.append(made)
        nodes.append(made[0](*made[1:]))
    outputs = ca.vertcat(*nodes)
    text = ca.Function("stage", [v, c, ca.SX(0, 1)], [outputs, ca.SX(0, 1)]).serialize()
    graph = native.StageGraph(text)
    chosen = native.StageGraph(text).selected(draw.indices(2, 0, len(nodes)))
    chosen.split(), chosen.constant_slopes(), chosen.places(), chosen.chain()
    points = np.array([draw.number() for _ in range(3 * (n + constants))]).reshape(3, -1)
    own_v, own_c = points[:, :n], points[:, n:]
    slopes, convex = graph.slopes()[0], graph.curvature()[1]
    for processor in native.processors():
        block = native.TapeBlock(3, n, constants, plain(graph.values()), plain(slopes), processor=processor)
        found = block.values(own_v.ravel(), own_c.ravel()).reshape(3, -1)
        block.jacobian(own_v.ravel(), own_c.ravel())
        _compare(nodes, parts, n + constants, v, c, own_v, own_c, found)
    _ = convex


def _compare(nodes: list, parts: list, first: int, v: ca.SX, c: ca.SX, own_v, own_c, found) -> None:
    """Compute each node from the nodes that the tape gave, where all of them are finite numbers."""
    known = [ca.SX.sym(f"n{k}") for k in range(len(nodes))]
    places = {node.__hash__(): k for k, node in reversed(list(enumerate(nodes)))}
    again = [
        part[0](*(known[places[a.__hash__()]] if a.__hash__() in places else a for a in part[1:]))
        for part in parts
        if part[0] is not ca.if_else
    ]
    rows = [first + k for k, part in enumerate(parts) if part[0] is not ca.if_else]
    if not rows:
        return
    evaluate = ca.Function("again", [ca.vertcat(*known), v, c], [ca.vertcat(*again)])
    for at, numbers in enumerate(found):
        exact = np.array(evaluate(numbers, own_v[at], own_c[at])).ravel()
        if not np.isfinite(numbers).all() or not np.isfinite(exact).all():
            continue
        error = np.abs(numbers[rows] - exact)
        assert (error <= SAME * np.abs(exact) + 1e-300).all(), (numbers[rows], exact)


def spheres(draw: Draws) -> None:
    """Read a tree of spheres among shapes, then compute distances, proofs of motions and a path."""
    n, groups, count, shapes = draw.below(4), draw.below(4), draw.below(7), draw.below(4)
    parents = np.array([draw.index(-1, i) for i in range(draw.length(n))], dtype=np.int64)
    joints = draw.numbers(15 * n)
    if draw.below(2) and joints.size == 15 * n:
        for i in range(n):
            joints[15 * i : 15 * i + 12] = [0, 0, 1, *np.eye(3).ravel()]
    triangles = draw.indices(shapes, 0, 3)
    tree = native.SphereTree(
        parents,
        draw.indices(n, 0, 2),
        joints,
        draw.indices(groups, -1, n),
        draw.ascending(count, max(1, groups)),
        draw.numbers(4 * count),
        draw.indices(2 * draw.below(3), 0, max(1, groups)),
        draw.indices(shapes, 0, 6),
        draw.numbers(16 * shapes),
        triangles,
        draw.numbers(9 * int(np.clip(triangles, 0, 3).sum())),
    )
    q = draw.numbers(2 * n)
    pairs = draw.below(4)
    for call in (
        lambda: tree.clearances(q),
        lambda: tree.distances(
            q, draw.indices(pairs, 0, max(1, count)), draw.indices(pairs, 0, max(1, count)), draw.index(0, pairs + 1)
        ),
        lambda: tree.centres(q, draw.indices(2, 0, max(1, count))),
        lambda: tree.shortfalls(draw.numbers(3 * n), draw.indices(1, 3, 4), draw.number()),
        lambda: tree.motion_free(q[:n], q[n:], draw.number(), draw.number()),
        lambda: tree.connect(
            q[:n],
            q[n:],
            np.full(n, -3.0),
            np.full(n, 3.0),
            draw.numbers(n),
            draw.number(),
            draw.below(9),
            20,
            0.05,
            5,
            0.0,
            0.02,
        ),
    ):
        with contextlib.suppress(*REFUSED):
            call()


def planes(draw: Draws) -> None:
    """Read pairs of spheres and shapes, and compute the planes between them."""
    count, shapes, pairs, groups, joints = (1 + draw.below(3) for _ in range(5))
    triangles = draw.indices(shapes, 0, 3)
    ends = np.column_stack(
        [
            draw.ascending(groups, pairs + 1),
            draw.indices(groups, 1, 3),
            draw.indices(groups, 0, 2),
            draw.indices(groups, 0, joints),
        ]
    )
    ends[-1, 0] = pairs
    found = native.NearestPlanes(
        draw.indices(count, 0, joints),
        draw.numbers(4 * count),
        draw.indices(shapes, 0, 6),
        draw.numbers(16 * shapes),
        triangles,
        draw.numbers(9 * int(np.clip(triangles, 0, 3).sum())),
        draw.indices(pairs, 0, count),
        draw.indices(pairs, 0, min(count, shapes)),
        ends.ravel(),
        draw.numbers(9 * groups),
    )
    many = draw.index(0, 3)
    found.find(draw.numbers(12 * joints * max(0, min(many, 3))), draw.numbers(12 * shapes * max(0, min(many, 3))), many)


def matrix(draw: Draws, rows: int, columns: int) -> object:
    """Return a sparse matrix that may be wrong."""
    entries = draw.below(6)
    if draw.below(2):
        return native.Csr.summed(
            rows, columns, draw.indices(entries, 0, rows), draw.indices(entries, 0, columns), draw.numbers(entries)
        )
    starts = draw.ascending(rows + 1, entries + 1, np.int32)
    if starts.size and not draw.rare():
        starts[0], starts[-1] = 0, entries
    return native.Csr(rows, columns, starts, draw.indices(entries, 0, columns, np.int32), draw.numbers(entries))


def matrices(draw: Draws) -> None:
    """Multiply, transpose, stack and resolve matrices, as SciPy does."""
    rows, columns = 1 + draw.below(5), 1 + draw.below(5)
    a, b = matrix(draw, rows, columns), matrix(draw, columns, rows)
    dense = [sp.csr_array((m.data, m.indices, m.starts), shape=(m.rows, m.columns)).toarray() for m in (a, b)]
    x = draw.numbers(columns)
    product, stacked = a @ x, native.Stacked(a) @ x
    transposed, pruned, square = a.transposed(), a.pruned(), a @ b
    if np.isfinite(dense[0]).all() and np.isfinite(dense[1]).all() and np.isfinite(x).all():
        with np.errstate(all="ignore"):
            wanted, limit = dense[0] @ x, 1e-12 * (np.abs(dense[0]) @ np.abs(x)) + 1e-300
        if np.isfinite(limit).all():
            assert (np.abs(product - wanted) <= limit).all() and (np.abs(stacked - wanted) <= limit).all()
        assert transposed.rows == columns and pruned.entries <= a.entries
    square.resolved(draw.indices(rows, -1, rows), rows)


def chains(draw: Draws) -> None:
    """Read the places of a block, and combine their derivatives."""
    count, inputs, outputs, rows, columns, stages = (1 + draw.below(3) for _ in range(6))
    entries = draw.below(4)
    chain = native.Chain(
        count,
        inputs,
        outputs,
        draw.indices(entries, 0, outputs, np.int32),
        draw.indices(entries, 0, inputs, np.int32),
        draw.indices(entries, 0, inputs, np.int32),
        draw.indices(entries, 0, inputs, np.int32),
        matrix(draw, rows, outputs * count),
        matrix(draw, inputs * count, columns),
        matrix(draw, inputs * count, columns),
        draw.indices(count, 0, stages),
    )
    starts = draw.ascending(stages + 1, columns + 1)
    if starts.size and not draw.rare():
        starts[0], starts[-1] = 0, columns
    with contextlib.suppress(*REFUSED):
        native.hessian_chain([chain], starts)
    slots = columns * stages
    native.jacobian_chain(
        matrix(draw, rows, columns),
        [chain],
        matrix(draw, slots, columns),
        draw.indices(columns, 0, slots),
        starts,
        draw.indices(rows, 0, stages),
    )


def factors(draw: Draws) -> None:
    """Factorise a symmetric matrix."""
    n, entries = 1 + draw.below(5), draw.below(9)
    starts = draw.ascending(n + 1, entries + 1)
    if starts.size and not draw.rare():
        starts[0], starts[-1] = 0, entries
    groups = [draw.index(0, 3) for _ in range(draw.below(3) * n)]
    found = native.SymmetricFactors(starts, draw.indices(entries, 0, n), "", groups)
    found.factorise(draw.numbers(entries), abs(draw.number()), abs(draw.number()))
    found.solve(draw.numbers(n))


def trees(draw: Draws) -> None:
    """Read a tree of bodies and the recipes of a block with its torques, and evaluate them."""
    n, flies = 1 + draw.below(3), bool(draw.below(2))
    parents = np.array([draw.index(-1, i) for i in range(draw.length(n))], dtype=np.int64)
    numbers = draw.numbers(28 * n)
    robot = native.RigidTree(parents, draw.indices(n, 0, 2), numbers, draw.numbers(n), draw.numbers(3), flies)
    robot.jacobian_pattern(), robot.hessian_pattern()
    size, rates = robot.positions + 2 * robot.rates, robot.rates
    v, c, r, m = (ca.SX.sym(name, k) for name, k in (("v", size), ("c", 0), ("r", rates), ("m", rates)))
    graph = native.StageGraph(ca.Function("stage", [v, c, r], [r, v]).serialize())
    torques = native.Torques(robot, draw.indices(size, -1, size))
    products = draw.below(4)
    made = draw.index(0, 4)
    recipe = native.Recipe(
        graph.values(),
        bool(draw.below(2)),
        False,
        max(0, min(made, 10**6)),
        abs(draw.index(0, 3)),
        rates,
        *(draw.indices(products, 0, 4) for _ in range(3)),
    )
    block = native.TapeBlock(2, size, 0, recipe, torques=torques)
    block.values(draw.numbers(2 * size), np.zeros(0), threads=1)
    _ = m


def programs(draw: Draws) -> None:
    """Read a program of stages with linear rows, and solve it for some iterations."""
    stages = 1 + draw.below(3)
    controls, states = draw.indices(stages, 0, 3), draw.indices(stages, 0, 3)
    equalities, inequalities = draw.indices(stages, 0, 2), draw.indices(stages, 0, 2)
    columns = int(np.clip(controls, 0, 9).sum() + np.clip(states, 0, 9).sum())
    rows = int(np.clip(states[1:], 0, 9).sum() + np.clip(equalities, 0, 9).sum() + np.clip(inequalities, 0, 9).sum())
    entries, curved = draw.below(5), draw.below(5)
    program = native.Program(
        controls,
        states,
        equalities,
        inequalities,
        matrix(draw, rows, max(1, columns)) if rows else native.Csr(0, columns, *_no_entries()),
        draw.numbers(rows),
        draw.numbers(columns),
        0.0,
        draw.indices(entries, 0, max(1, rows), np.int32),
        draw.indices(entries, 0, max(1, columns), np.int32),
        draw.numbers(entries),
        draw.indices(curved, 0, max(1, columns), np.int32),
        draw.indices(curved, 0, max(1, columns), np.int32),
        [],
    )
    slacks = int(np.clip(inequalities, 0, 9).sum())
    y = draw.numbers(columns)
    program.rows(y), program.gradient(y), program.jacobian(y)
    program.solve(y, draw.numbers(slacks), draw.numbers(slacks), native.Options(max_iterations=5))


def _no_entries() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return np.zeros(1, dtype=np.int32), np.zeros(0, dtype=np.int32), np.zeros(0)


READERS: tuple[Callable[[Draws], None], ...] = (
    function,
    spheres,
    planes,
    matrices,
    chains,
    factors,
    trees,
    programs,
)


def attempt(data: bytes) -> None:
    """Let one reader have the bytes after the first, which chooses it."""
    draw = Draws(data)
    reader = READERS[draw.below(len(READERS))]
    with contextlib.suppress(*REFUSED), np.errstate(all="ignore"):
        reader(draw)


def main() -> None:
    """Search for bytes that end the process, with libFuzzer's options."""
    import atheris

    atheris.Setup(sys.argv, attempt)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
