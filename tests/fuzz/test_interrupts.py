"""Ctrl-C at any instant ends any call within a second, and loses nothing that was finished."""

from __future__ import annotations

from pathlib import Path

import pytest
from interrupts import faults


@pytest.mark.slow
def test_ctrl_c_at_random_instants_ends_every_call_and_loses_nothing(tmp_path: Path) -> None:
    assert not faults(tmp_path, 18, 0)
