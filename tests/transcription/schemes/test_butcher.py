"""Every scheme is its Butcher table: known tables, order conditions, exact quadrature."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj.transcription.schemes.collocation import Collocation

S3, S5, S6, S15 = np.sqrt([3.0, 5.0, 6.0, 15.0])

TABLES = {
    "trapezoid": (rt.schemes.Trapezoidal(), [0, 1], [[0, 0], [1 / 2, 1 / 2]], [1 / 2, 1 / 2]),
    "Hermite-Simpson": (
        rt.HermiteSimpson(),
        [0, 1 / 2, 1],
        [[0, 0, 0], [5 / 24, 1 / 3, -1 / 24], [1 / 6, 2 / 3, 1 / 6]],
        [1 / 6, 4 / 6, 1 / 6],
    ),
    "Lobatto IIIA, 4": (
        rt.schemes.LobattoIIIA(points=4),
        [0, (5 - S5) / 10, (5 + S5) / 10, 1],
        [
            [0, 0, 0, 0],
            [(11 + S5) / 120, (25 - S5) / 120, (25 - 13 * S5) / 120, (-1 + S5) / 120],
            [(11 - S5) / 120, (25 + 13 * S5) / 120, (25 + S5) / 120, (-1 - S5) / 120],
            [1 / 12, 5 / 12, 5 / 12, 1 / 12],
        ],
        [1 / 12, 5 / 12, 5 / 12, 1 / 12],
    ),
    "Radau IIA, 2": (rt.schemes.RadauIIA(points=2), [1 / 3, 1], [[5 / 12, -1 / 12], [3 / 4, 1 / 4]], [3 / 4, 1 / 4]),
    "Radau IIA, 3": (
        rt.schemes.RadauIIA(points=3),
        [(4 - S6) / 10, (4 + S6) / 10, 1],
        [
            [(88 - 7 * S6) / 360, (296 - 169 * S6) / 1800, (-2 + 3 * S6) / 225],
            [(296 + 169 * S6) / 1800, (88 + 7 * S6) / 360, (-2 - 3 * S6) / 225],
            [(16 - S6) / 36, (16 + S6) / 36, 1 / 9],
        ],
        [(16 - S6) / 36, (16 + S6) / 36, 1 / 9],
    ),
    "Gauss, 2": (
        rt.schemes.GaussLegendre(points=2),
        [1 / 2 - S3 / 6, 1 / 2 + S3 / 6],
        [[1 / 4, 1 / 4 - S3 / 6], [1 / 4 + S3 / 6, 1 / 4]],
        [1 / 2, 1 / 2],
    ),
    "Gauss, 3": (
        rt.schemes.GaussLegendre(points=3),
        [1 / 2 - S15 / 10, 1 / 2, 1 / 2 + S15 / 10],
        [
            [5 / 36, 2 / 9 - S15 / 15, 5 / 36 - S15 / 30],
            [5 / 36 + S15 / 24, 2 / 9, 5 / 36 - S15 / 24],
            [5 / 36 + S15 / 30, 2 / 9 + S15 / 15, 5 / 36],
        ],
        [5 / 18, 4 / 9, 5 / 18],
    ),
}

SCHEMES = [
    rt.schemes.Trapezoidal(),
    rt.HermiteSimpson(),
    rt.schemes.FifthDegree(),
    *(rt.schemes.LobattoIIIA(points=s) for s in (2, 3, 4, 5, 8, 12)),
    *(rt.schemes.RadauIIA(points=s) for s in (1, 2, 3, 4, 8, 12)),
    *(rt.schemes.GaussLegendre(points=s) for s in (1, 2, 3, 4, 8, 12)),
]


def label(scheme: Collocation) -> str:
    return f"{type(scheme).__name__}-{len(scheme.nodes)}"


@pytest.mark.parametrize("name", TABLES)
def test_table_is_the_published_one(name: str) -> None:
    scheme, nodes, matrix, weights = TABLES[name]
    np.testing.assert_allclose(scheme.nodes, nodes, atol=1e-15)
    np.testing.assert_allclose(scheme.matrix, matrix, atol=1e-15)
    np.testing.assert_allclose(scheme.weights, weights, atol=1e-15)


def test_fifth_degree_has_the_nodes_and_weights_of_herman_and_conway() -> None:
    inner = np.sqrt(3 / 7) / 2
    scheme = rt.schemes.FifthDegree()
    np.testing.assert_allclose(scheme.nodes, [0, 1 / 2 - inner, 1 / 2, 1 / 2 + inner, 1], atol=1e-15)
    np.testing.assert_allclose(scheme.weights, np.array([9, 49, 64, 49, 9]) / 180, atol=1e-15)


@pytest.mark.parametrize("scheme", SCHEMES, ids=label)
def test_matrix_integrates_every_polynomial_that_the_nodes_determine(scheme: Collocation) -> None:
    c = scheme.nodes
    for power in range(len(c)):
        np.testing.assert_allclose(scheme.matrix @ c**power, c ** (power + 1) / (power + 1), atol=1e-14)


@pytest.mark.parametrize("scheme", SCHEMES, ids=label)
def test_weights_are_exact_to_the_order_and_no_further(scheme: Collocation) -> None:
    def error(power: int) -> float:
        # Shifted Legendre polynomials measure the error without cancellation: their integral is 0.
        polynomial = np.polynomial.legendre.Legendre.basis(power)
        return float(abs(scheme.weights @ polynomial(2 * scheme.nodes - 1) - (power == 0)))

    assert all(error(power) < 1e-14 for power in range(scheme.order))
    assert error(scheme.order) > 1e-3


@pytest.mark.parametrize("scheme", SCHEMES, ids=label)
def test_symmetric_schemes_read_the_same_backwards(scheme: Collocation) -> None:
    if isinstance(scheme, rt.schemes.RadauIIA):
        assert scheme.nodes[-1] == 1.0 and scheme.nodes[0] > 0.0
    else:
        np.testing.assert_allclose(scheme.nodes, 1 - scheme.nodes[::-1], atol=1e-15)
        np.testing.assert_allclose(scheme.weights, scheme.weights[::-1], atol=1e-15)


def test_named_lobatto_schemes_are_members_of_the_family() -> None:
    for named, points in ((rt.schemes.Trapezoidal(), 2), (rt.HermiteSimpson(), 3), (rt.schemes.FifthDegree(), 5)):
        member = rt.schemes.LobattoIIIA(points=points)
        np.testing.assert_array_equal(named.matrix, member.matrix)
        assert named.order == member.order


def test_the_lectures_scheme_means_mid_control_and_trapezoidal_quadrature() -> None:
    scheme = rt.HermiteSimpson(control=rt.schemes.LinearControl(), quadrature=rt.schemes.TrapezoidalQuadrature())
    np.testing.assert_allclose(scheme.control_at_nodes, [[1, 0], [0.5, 0.5], [0, 1]], atol=1e-15)
    np.testing.assert_array_equal(scheme.objective_weights, [0.5, 0, 0.5])
    np.testing.assert_array_equal(scheme.matrix, rt.HermiteSimpson().matrix)


def test_a_constant_control_is_the_same_at_every_node() -> None:
    scheme = rt.schemes.RadauIIA(points=3, control=rt.schemes.ConstantControl())
    np.testing.assert_array_equal(scheme.control_at_nodes, np.ones((3, 1)))
