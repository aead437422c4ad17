"""Tables of a report: 80 columns wide, one line a row, no number cut."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Sequence
from typing import TypeVar

T = TypeVar("T")

WIDTH = 80
"""Columns of a report."""

MOST_ROWS = 16
"""Largest number of rows of a table; only the worst are shown."""

GAP = 2
"""Blanks between columns."""

SHORTEST = 6
"""Columns that a shortened text keeps."""


def worst_of(rows: Sequence[T], size: Callable[[T], float]) -> tuple[Sequence[T], str]:
    """Return the worst rows in their order where there are too many, and a note on the others."""
    if len(rows) <= MOST_ROWS:
        return rows, ""
    kept = sorted(sorted(range(len(rows)), key=lambda i: -size(rows[i]))[:MOST_ROWS])
    return [rows[i] for i in kept], f" (the worst {MOST_ROWS} of {len(rows)})"


def table(headers: Sequence[str], rows: Sequence[Sequence[str]], texts: Sequence[int] = (0,)) -> list[str]:
    """Lay out a table as lines.

    Parameters
    ----------
    headers : sequence of str
    rows : sequence of sequence of str
        One cell for each header.
    texts : sequence of int
        Columns that hold text: aligned left, and shortened where the table is too wide. All others are aligned right.
    """
    cells = [list(headers), *(list(row) for row in rows)]
    widths = [max(len(row[i]) for row in cells) for i in range(len(headers))]
    excess = sum(widths) + GAP * (len(widths) - 1) + 1 - WIDTH
    while excess > 0:
        longest = max(texts, key=lambda i: widths[i])
        if widths[longest] <= SHORTEST:
            break
        widths[longest] -= 1
        excess -= 1
    lines = []
    for row in cells:
        parts = [
            shortened(cell, width).ljust(width) if i in texts else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        lines.append((" " + (" " * GAP).join(parts)).rstrip())
    rule = " " + "─" * (sum(widths) + GAP * (len(widths) - 1))
    return [lines[0], rule, *lines[1:]]


def shortened(text: str, width: int) -> str:
    """Cut the middle out of a text that is too long, since similar names differ at their ends."""
    if len(text) <= width:
        return text
    head = (width - 1) // 2
    return f"{text[:head]}…{text[len(text) - (width - 1 - head) :]}"


def wrapped(text: str, indent: str = "  ", more: str = "    ") -> list[str]:
    """Wrap a sentence at the width of a report."""
    return textwrap.wrap(text, WIDTH, initial_indent=indent, subsequent_indent=more) or [""]
