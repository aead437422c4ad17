"""Makes ``pieces.py`` importable, and measures processor time, on which other processes have little effect."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))


def pytest_configure(config: pytest.Config) -> None:
    config.option.benchmark_timer = "time.process_time"
