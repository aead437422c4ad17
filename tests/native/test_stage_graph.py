"""Graphs of the compiled module: affine outputs, constant slopes and selections, against CasADi's expressions."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from robotraj.native._native import NotATape, StageGraph, Tape
from robotraj.native.build import load_native
from robotraj.native.stage_tapes import plain

RNG = np.random.default_rng(0)
NONE = ca.SX(0, 1)


def graph_of(v: ca.SX, c: ca.SX, y: list[ca.SX], r: ca.SX = NONE, x: ca.SX = NONE) -> StageGraph:
    made: StageGraph = load_native().StageGraph(ca.Function("stage", [v, c, r], [ca.vertcat(*y), x]).serialize())
    return made


def evaluated(linear: Tape, points: np.ndarray) -> np.ndarray:
    """What the tape of a linear part gives at each of some constants, (E, n_c) -> (E, m)."""
    block = load_native().TapeBlock(len(points), 0, points.shape[1], plain(linear))
    return block.values(np.zeros(0), points.ravel()).reshape(len(points), -1)


def test_affine_outputs_are_found_and_evaluated() -> None:
    v, c = ca.SX.sym("v", 3), ca.SX.sym("c", 2)
    affine = [
        c[0] * v[0] - ca.sin(c[1]) * v[2] + c[0] ** 2,
        ca.SX(3.5),
        2 * (v[1] - 0.5) / c[1] - v[1],
        v[0] * v[1] - v[0] * v[1] + v[2],
        ca.if_else(c[0] > 0, v[0], v[1]),
    ]
    bent = [v[0] * v[1], ca.sin(v[2]), ca.fabs(v[0]), ca.if_else(v[0] > 0, v[1], v[2])]
    y = [bent[0], *affine[:3], bent[1], bent[2], *affine[3:], bent[3]]
    curved, linear, (rows, columns) = graph_of(v, c, y).split()
    assert curved.tolist() == [0, 4, 5, 8]

    exact = ca.Function("affine", [v, c], [ca.vertcat(*affine)])
    slopes = ca.Function("slopes", [v, c], [ca.jacobian(ca.vertcat(*affine), v)])
    points = RNG.uniform(-1, 1, (11, 2))
    for point, numbers in zip(points, evaluated(linear, points), strict=True):
        matrix = np.zeros((len(affine), 3))
        matrix[rows, columns] = numbers[: len(rows)]
        at = RNG.uniform(-1, 1, 3)
        np.testing.assert_allclose(matrix, np.array(slopes(at, point)), rtol=1e-15, atol=1e-15)
        wanted = np.array(exact(at, point)).ravel()
        np.testing.assert_allclose(matrix @ at + numbers[len(rows) :], wanted, rtol=1e-13, atol=1e-13)


def test_constant_slopes_are_numbers_and_others_nan() -> None:
    v, c = ca.SX.sym("v", 3), ca.SX.sym("c", 1)
    slopes = graph_of(v, c, [2 * v[0] - v[2], c * v[1], v[0] * v[1]]).constant_slopes().reshape(3, 3).T
    unknown = np.nan
    np.testing.assert_array_equal(slopes, [[2, 0, -1], [0, unknown, 0], [unknown, unknown, 0]])


def test_torques_are_functions_of_the_unknowns_in_their_arguments() -> None:
    v, c, r = ca.SX.sym("v", 3), ca.SX.sym("c", 1), ca.SX.sym("r", 1)
    graph = graph_of(v, c, [r - v[2], v[0] + v[2]], r, ca.vertcat(v[0], v[1], 0))
    assert graph.split()[0].tolist() == [0]
    np.testing.assert_array_equal(graph.constant_slopes().reshape(3, 2).T, [[np.nan, np.nan, -1], [1, 0, 1]])
    places = graph.places()
    assert places is not None
    assert places.tolist() == [0, 1, -1]


def test_results_of_called_functions_are_not_affine() -> None:
    table = ca.interpolant("table", "bspline", [np.linspace(-4, 4, 12)], np.linspace(-1, 1, 12) ** 2)
    v, c = ca.SX.sym("v", 2), ca.SX.sym("c", 1)
    graph = graph_of(v, c, [v[1] + table(v[0]), 3 * v[0] + c])
    curved, linear, _ = graph.split()
    assert curved.tolist() == [0]
    assert evaluated(linear, np.array([[0.5]])).tolist() == [[3, 0.5]]
    np.testing.assert_array_equal(graph.constant_slopes().reshape(2, 2).T, [[np.nan, np.nan], [3, 0]])
    with pytest.raises(NotATape, match="calls another function"):
        graph.values()


def test_a_selection_has_the_derivatives_of_its_outputs() -> None:
    v, c = ca.SX.sym("v", 2), ca.SX.sym("c", 1)
    y = [v[0] * v[1], c * v[0], ca.sin(v[1])]
    chosen, alone = graph_of(v, c, y).selected(np.array([2, 0])), graph_of(v, c, [y[2], y[0]])
    assert chosen.outputs == 2
    for found, wanted in zip(chosen.slopes()[1], alone.slopes()[1], strict=True):
        assert found.tolist() == wanted.tolist()
    assert chosen.curvature()[2][0].tolist() == alone.curvature()[2][0].tolist()
    assert chosen.split()[0].tolist() == [0, 1]
