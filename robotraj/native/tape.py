"""Tapes: the instructions of CasADi's scalar graphs, read for the compiled module."""

from __future__ import annotations

from typing import TYPE_CHECKING

import casadi as ca

from robotraj.native.build import load_native

if TYPE_CHECKING:
    from robotraj.native._native import Tape


def tape_of(function: ca.Function) -> Tape:
    """Read the instructions of a function of SX with one dense result.

    The compiled module reads them in CasADi's C++ object, whose address is ``this``; both modules call the same library
    (``build.check_versions``). Serialising the function as text would take ten times as long.

    Raises
    ------
    NotATape
        The function is no scalar graph, or calls other functions.
    """
    tape: Tape = load_native().Tape(int(function.this))
    return tape


def tape(inputs: list[ca.SX], result: ca.SX) -> Tape:
    """Return the tape of one dense result."""
    return tape_of(ca.Function("tape", inputs, [result]))


def nonzeros(matrix: ca.SX) -> ca.SX:
    """Return the nonzeros of a matrix as a dense column."""
    found = matrix.nz[:]
    # CasADi returns the nonzeros of a row vector as a row.
    return found if found.is_column() else found.T
