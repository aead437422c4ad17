"""Loading a robot and writing its problem."""

from __future__ import annotations

import pytest
from pieces import PIECES, Piece
from pytest_benchmark.fixture import BenchmarkFixture


@pytest.mark.parametrize("piece", [piece for piece in PIECES if piece.group == "loading"], ids=lambda piece: piece.name)
def test_loading(benchmark: BenchmarkFixture, piece: Piece) -> None:
    benchmark(piece.make())
