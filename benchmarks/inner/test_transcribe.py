"""Transcription of a problem on a mesh, its functions, and added rows."""

from __future__ import annotations

import pytest
from pieces import PIECES, Piece
from pytest_benchmark.fixture import BenchmarkFixture


@pytest.mark.parametrize(
    "piece", [piece for piece in PIECES if piece.group == "transcription"], ids=lambda piece: piece.name
)
def test_transcription(benchmark: BenchmarkFixture, piece: Piece) -> None:
    benchmark(piece.make())
