"""From CasADi's scalar graphs to tapes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import casadi as ca

from robotraj.native.build import load_native

if TYPE_CHECKING:
    from robotraj.native._native import Tape


def tape_of(function: ca.Function) -> Tape:
    """Read the instructions of a function of SX with one dense result.

    They are read where they stand: ``this`` tells where CasADi's object in C++ is, and both modules call the same
    library (``build.check_versions``). Writing and reading the function as text would take ten times as long.

    Raises
    ------
    NotATape
        The function is no scalar graph, or calls others.
    """
    tape: Tape = load_native().Tape(int(function.this))
    return tape


def tape(inputs: list[ca.SX], result: ca.SX) -> Tape:
    """Make the tape of one dense result."""
    return tape_of(ca.Function("tape", inputs, [result]))


def nonzeros(matrix: ca.SX) -> ca.SX:
    """Nonzeros of a matrix as a dense column."""
    found = matrix.nz[:]
    # Those of a row are a row.
    return found if found.is_column() else found.T
