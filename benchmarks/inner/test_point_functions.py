"""Functions of a point and their derivatives, at all places of a mesh."""

from __future__ import annotations

import pytest
from pieces import PIECES, Piece
from pytest_benchmark.fixture import BenchmarkFixture


@pytest.mark.parametrize(
    "piece", [piece for piece in PIECES if piece.group == "point functions"], ids=lambda piece: piece.name
)
def test_point_functions(benchmark: BenchmarkFixture, piece: Piece) -> None:
    benchmark(piece.make())
