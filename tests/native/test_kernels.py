"""The inner products that take the place of BLASFEO's, against NumPy and against BLASFEO's own."""

from __future__ import annotations

import ctypes
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.typing import NDArray

from robotraj.native.build import load_native

KERNELS = ctypes.CDLL(str(Path(str(load_native().__file__)).with_name("_kernels.so")))
BLASFEO = ctypes.CDLL(str(Path(ca.__file__).with_name("libblasfeo.so")))
SIZES = [*range(13), 18, 31, 64]


def at(array: NDArray[np.float64], offset: int = 0) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data + 8 * offset)


def number(value: float) -> ctypes.c_void_p:
    return ctypes.cast(ctypes.pointer(ctypes.c_double(value)), ctypes.c_void_p)


@pytest.mark.parametrize("library", [KERNELS, BLASFEO], ids=["ours", "blasfeo"])
@pytest.mark.parametrize("k", SIZES)
@pytest.mark.parametrize(("alpha", "beta"), [(1.0, 0.0), (-1.0, 1.0), (0.7, -2.5)])
def test_products_of_panels(library: ctypes.CDLL, k: int, alpha: float, beta: float) -> None:
    rng = np.random.default_rng(k)
    a, b, c, d = (rng.standard_normal((n, 4)) for n in (k, k, 4, 4))
    expected = beta * c + alpha * b.T @ a
    library.kernel_dgemm_nt_4x4_lib4(k, number(alpha), at(a), at(b), number(beta), at(c), at(d))
    np.testing.assert_allclose(d, expected, rtol=1e-13, atol=1e-13)
    library.kernel_dgemm_nt_4x4_lib4(k, number(alpha), at(a), at(b), number(beta), at(c), at(c))
    np.testing.assert_allclose(c, expected, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("library", [KERNELS, BLASFEO], ids=["ours", "blasfeo"])
@pytest.mark.parametrize("k", SIZES)
@pytest.mark.parametrize(("alpha", "beta"), [(1.0, 0.0), (-1.0, 1.0), (0.7, -2.5)])
def test_products_with_vectors(library: ctypes.CDLL, k: int, alpha: float, beta: float) -> None:
    rng = np.random.default_rng(k)
    a, x, y, z = (rng.standard_normal(shape) for shape in ((k, 4), k, 4, 4))
    if beta == 0.0:
        y[:] = np.nan  # is not read
    expected = alpha * a.T @ x + (beta * y if beta else 0.0)
    library.kernel_dgemv_n_4_lib4(k, number(alpha), at(a), at(x), number(beta), at(y), at(z))
    np.testing.assert_allclose(z, expected, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("library", [KERNELS, BLASFEO], ids=["ours", "blasfeo"])
@pytest.mark.parametrize("k", SIZES)
@pytest.mark.parametrize("offset", [0, 1, 2, 3])
@pytest.mark.parametrize(("alpha", "beta"), [(1.0, 0.0), (0.7, -2.5)])
def test_transposed_products_with_vectors(library: ctypes.CDLL, k: int, offset: int, alpha: float, beta: float) -> None:
    rng = np.random.default_rng(k)
    columns = 7
    panels = rng.standard_normal((k // 4 + 2, columns, 4))
    matrix = panels.transpose(0, 2, 1).reshape(-1, columns)[offset : offset + k, :4]
    x, y, z = (rng.standard_normal(n) for n in (k, 4, 4))
    expected = alpha * matrix.T @ x + beta * y
    library.kernel_dgemv_t_4_lib4(
        k, number(alpha), offset, at(panels, offset), columns, at(x), number(beta), at(y), at(z)
    )
    np.testing.assert_allclose(z, expected, rtol=1e-13, atol=1e-13)
