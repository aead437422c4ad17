"""Checks of a solution outside the solver."""

from __future__ import annotations

import pytest
from pieces import PIECES, Piece
from pytest_benchmark.fixture import BenchmarkFixture


@pytest.mark.parametrize("piece", [piece for piece in PIECES if piece.group == "checks"], ids=lambda piece: piece.name)
def test_checks(benchmark: BenchmarkFixture, piece: Piece) -> None:
    benchmark(piece.make())
