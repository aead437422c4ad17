"""Reduction of an NLP to stages."""

from __future__ import annotations

import pytest
from pieces import PIECES, Piece
from pytest_benchmark.fixture import BenchmarkFixture


@pytest.mark.parametrize(
    "piece", [piece for piece in PIECES if piece.group == "reduction"], ids=lambda piece: piece.name
)
def test_reduction(benchmark: BenchmarkFixture, piece: Piece) -> None:
    benchmark(piece.make())
