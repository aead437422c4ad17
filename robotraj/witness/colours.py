"""Colours of a verdict on a terminal."""

from __future__ import annotations

import os
import sys

COLOURS = {"PASSED": "\x1b[32m", "FAILED": "\x1b[31m"}


def coloured(verdict: str) -> str:
    """Colour a verdict where standard output is a terminal and the variable NO_COLOR is not set."""
    if not sys.stdout.isatty() or os.environ.get("NO_COLOR"):
        return verdict
    return f"{COLOURS[verdict]}{verdict}\x1b[0m"
