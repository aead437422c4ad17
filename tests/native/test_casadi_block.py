"""CasADi functions at many points: the same numbers for every batch and number of threads."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import casadi as ca
import numpy as np
import pytest

from robotraj.native import CasadiBlock

COUNT = 11


@pytest.fixture
def functions() -> dict[str, ca.Function]:
    v, c, m = ca.SX.sym("v", 3), ca.SX.sym("c", 2), ca.SX.sym("m", 2)
    y = ca.vertcat(ca.sin(v[0]) * v[1] + c[0], ca.exp(c[1] * v[2]) * v[0])
    return {
        "values": ca.Function("values", [v, c], [y]),
        "jacobian": ca.Function("jacobian", [v, c], [ca.densify(ca.jacobian(y, v).nz[:])]),
        "cost": ca.Function("cost", [v, c], [y[1]]),
        "gradient": ca.Function("gradient", [v, c], [ca.densify(ca.gradient(y[1], v))]),
        "hessian": ca.Function("hessian", [v, c, m], [ca.densify(ca.tril(ca.hessian(ca.dot(m, y), v)[0]).nz[:])]),
    }


def made(functions: dict[str, ca.Function], batch: int) -> CasadiBlock:
    texts = {name: (function.map(batch).serialize().encode("latin-1"), batch) for name, function in functions.items()}
    sizes = (functions["jacobian"].nnz_out(0), functions["hessian"].nnz_out(0))
    return CasadiBlock(COUNT, 3, 2, 2, texts, *sizes, costed=1)


@pytest.mark.parametrize("batch", [1, 4, 8, 16])
@pytest.mark.parametrize("threads", [1, 2, 3])
def test_every_point_gets_its_own_answer(functions: dict[str, ca.Function], batch: int, threads: int) -> None:
    block = made(functions, batch)
    rng = np.random.default_rng(1)
    arguments = {n: rng.standard_normal((size, COUNT)) for n, size in {"v": 3, "c": 2, "m": 2}.items()}
    for name, function in functions.items():
        given = [arguments[each] for each in ("v", "c", "m")[: function.n_in()]]
        result = getattr(block, name)(*(each.ravel(order="F") for each in given), threads=threads)
        expected = np.array(function.map(COUNT)(*given))
        np.testing.assert_array_equal(result, expected.ravel(order="F"))


def test_a_block_serves_several_threads_one_after_another() -> None:
    """Plans in threads share the stages of a phase; their work memory must be separate."""
    v, c = ca.SX.sym("v", 6), ca.SX.sym("c", 0)
    y, count = ca.vertcat(*(ca.sin(v[i]) * ca.exp(-v[i - 1]) for i in range(6))), 500
    values = ca.Function("values", [v, c], [y])
    block = CasadiBlock(count, 6, 0, 6, {"values": (values.map(4).serialize().encode("latin-1"), 4)})
    rng = np.random.default_rng(0)
    given = [rng.standard_normal(6 * count) for _ in range(4)]
    alone = [block.values(each, np.zeros(0)) for each in given]

    def differing(k: int) -> int:
        return sum(not np.array_equal(block.values(given[k], np.zeros(0)), alone[k]) for _ in range(300))

    with ThreadPoolExecutor(4) as threads:
        assert list(threads.map(differing, range(4))) == [0, 0, 0, 0]


def test_a_block_takes_one_thread_at_least(functions: dict[str, ca.Function]) -> None:
    v, c = np.zeros(3 * COUNT), np.zeros(2 * COUNT)
    block = made(functions, 1)
    np.testing.assert_array_equal(block.values(v, c, threads=0), block.values(v, c))


def test_functions_of_the_wrong_shape_are_refused(functions: dict[str, ca.Function]) -> None:
    texts = {name: (function.serialize().encode("latin-1"), 1) for name, function in functions.items()}
    with pytest.raises(ValueError, match="hessian has 2 numbers in argument 2, expected 3"):
        CasadiBlock(COUNT, 3, 2, 3, texts, 4, 4, 1)
    with pytest.raises(ValueError, match="jacobian has 4 numbers in its result, expected 6"):
        CasadiBlock(COUNT, 3, 2, 2, texts, 6, 4, 1)
    del texts["hessian"]
    with pytest.raises(ValueError, match="the function 'hessian' is missing"):
        CasadiBlock(COUNT, 3, 2, 2, texts, 4, 4, 1)
    texts["hesian"] = texts["values"]
    with pytest.raises(ValueError, match="'hesian' is no evaluation of a block: values, jacobian"):
        CasadiBlock(COUNT, 3, 2, 2, texts, 4, 4, 1)
