"""Printing at the shell: plain text, tables and JSON on standard output, notes and errors on standard error."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping, Sequence

import typer
from rich.console import Console
from rich.table import Table


def say(text: object) -> None:
    """Print text without markup or wrapping.

    Where the reader has closed the pipe (``robotraj demo | head``), further output is dropped. The command continues:
    its files are written, and its exit code does not change.
    """
    try:
        typer.echo(str(text))
    except BrokenPipeError:
        drop_output()


def say_error(text: str) -> None:
    """Print a note or an error on standard error."""
    typer.echo(text, err=True)


def say_json(content: Mapping[str, object]) -> None:
    """Print one JSON object, the whole output of a command with ``--json``."""
    say(json.dumps(content, indent=1, allow_nan=False))


def say_table(title: str, heads: Sequence[str], rows: Sequence[Sequence[str]], wrapped: str) -> None:
    """Print a table as wide as the terminal; only the column named ``wrapped`` breaks its lines."""
    table = Table(title=title, title_justify="left", header_style="bold")
    for head in heads:
        table.add_column(head, no_wrap=head != wrapped)
    for row in rows:
        table.add_row(*row)
    console = Console(markup=False, highlight=False)
    with console.capture() as capture:
        console.print(table)
    say(capture.get().rstrip("\n"))


def drop_output() -> None:
    """Redirect standard output to the null device, so that its last flush at exit does not fail either."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)
