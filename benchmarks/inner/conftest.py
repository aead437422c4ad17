"""Benchmarks find ``pieces.py`` beside them, and count processor time: other work on the machine matters little."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))


def pytest_configure(config: pytest.Config) -> None:
    config.option.benchmark_timer = "time.process_time"
