"""Combinations of a Hessian are stored once for equal intervals, with the same values as without."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp

import robotraj as rt
from robotraj.solvers.stagewise.reduction import reduce
from tests.programs import nlp_of
from tests.solvers.stagewise.problems import EVERY

EQUAL = rt.Mesh(24)
TWO_LENGTHS = rt.Mesh(np.append(np.arange(12) / 64, np.arange(3, 17) / 16))
ONE_APART = rt.Mesh(np.append(np.linspace(0, 0.5, 12), np.linspace(0.52, 1, 12)))
ALL_APART = rt.Mesh(np.linspace(0, 1, 25) ** 1.1)


def hessians(name: str, mesh: rt.Mesh) -> list[Any]:
    reduction = reduce(nlp_of(EVERY[name](), mesh))
    return [part.hessian for part in reduction.program.blocks if part.hessian.entries]


def chained(name: str, mesh: rt.Mesh) -> list[tuple[Any, Any]]:
    """Of every block, what is kept of its Hessian's combination, and the chain rule written out by SciPy."""
    reduction = reduce(nlp_of(EVERY[name](), mesh))
    rows, columns = (side.astype(np.int64) for side in reduction.program.hessian)
    width = reduction.program.linear.columns
    pairs = []
    for part in reduction.program.blocks:
        block = part.block
        if not part.hessian.entries:
            continue
        i, j = (np.asarray(side) for side in block.stage.hessian_pattern)
        per_place = block.stage.inputs * np.arange(block.count)[:, None]
        gather = sp.csr_array((block.gather.data, block.gather.indices, block.gather.indptr), block.gather.shape)
        a, b = (gather[(per_place + side).ravel()].tocsc() for side in (i, j))
        off = sp.diags_array(np.tile(i != j, block.count).astype(float))
        assert width == gather.shape[1]
        written = a[:, rows] * b[:, columns] + off @ (b[:, rows] * a[:, columns])
        pairs.append((part.hessian, written.T))
    return pairs


@pytest.mark.parametrize("mesh", [EQUAL, TWO_LENGTHS, ONE_APART, ALL_APART], ids=["equal", "two", "one", "all"])
@pytest.mark.parametrize("name", ["arm", "hurried arm", "acrobot", "pendulum"])
def test_kept_rows_are_the_chain_rule(name: str, mesh: rt.Mesh) -> None:
    rng = np.random.default_rng(0)
    pairs = chained(name, mesh)
    assert pairs
    for kept, written in pairs:
        x = rng.standard_normal(kept.columns)
        expected = written @ x
        np.testing.assert_allclose(kept @ x, expected, rtol=1e-10, atol=1e-10 * abs(expected).max())


def test_intervals_that_are_alike_are_kept_once() -> None:
    def share(mesh: rt.Mesh) -> float:
        (kept,) = hessians("arm", mesh)
        return float(kept.kept / kept.entries)

    assert share(EQUAL) < 0.2
    assert share(TWO_LENGTHS) < 0.4
    assert share(ALL_APART) == 1.0
