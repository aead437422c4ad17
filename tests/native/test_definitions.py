"""Definitions that name each other are resolved, whatever their order."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from robotraj.native.build import load_native

NATIVE: Any = load_native()


def test_definitions_may_be_a_chain_of_any_length() -> None:
    """x_i = x_(i + 1), and the last one is variable 0."""
    n = 300_000
    starts = np.append(np.arange(n), n - 1)
    chain = NATIVE.Csr(n, n, starts, np.arange(1, n), np.ones(n - 1))
    variable = np.full(n, -1)
    variable[-1] = 0
    resolved = chain.resolved(variable, 1)
    assert resolved.entries == n


def test_definitions_that_go_round_are_refused() -> None:
    ring = NATIVE.Csr(3, 3, np.arange(4), np.array([1, 2, 0]), np.ones(3))
    with pytest.raises(ValueError, match="circle"):
        ring.resolved(np.full(3, -1), 1)
