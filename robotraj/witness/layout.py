"""Tables of a report, and which rows they show."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

from rich import box
from rich.table import Table

T = TypeVar("T")

WIDTH = 80

MOST_ROWS = 16
"""Rows of a table; of more, the worst are shown."""


def worst_of(rows: Sequence[T], size: Callable[[T], float]) -> tuple[Sequence[T], str]:
    """Keep the worst rows in their order where there are too many, and say how many are left out."""
    if len(rows) <= MOST_ROWS:
        return rows, ""
    kept = sorted(sorted(range(len(rows)), key=lambda i: -size(rows[i]))[:MOST_ROWS])
    return [rows[i] for i in kept], f" (the worst {MOST_ROWS} of {len(rows)})"


def columns_of(*headers: str) -> Table:
    """Start a table whose first column is text."""
    table = Table(box=box.SIMPLE_HEAD, header_style="none", show_edge=False, pad_edge=True)
    for i, header in enumerate(headers):
        table.add_column(header, justify="left" if i == 0 else "right", no_wrap=True)
    return table
