"""Printing at the shell: plain text, tables and JSON on standard output, notes and errors on standard error."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TYPE_CHECKING

import typer
from rich.console import Console
from rich.table import Table

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase
    from robotraj.problem.problem import Problem


_notes: ContextVar[list[str]] = ContextVar("notes", default=[])  # noqa: B039  # the list outside of a command


def say(text: object) -> None:
    """Print text without markup or wrapping.

    Where the reader has closed the pipe (``robotraj demo | head``), further output is dropped. The command continues:
    its files are written, and its exit code does not change.
    """
    try:
        typer.echo(str(text))
    except BrokenPipeError:
        drop_output()


def say_rows(problem: Phase | Problem, every: bool) -> None:
    """Print the rows of a problem, in groups of equal ones or each."""
    if every:
        say(f"{problem}\n")
    else:
        say(f"{problem.grouped}\n(--rows lists every row)\n")


def say_error(text: str) -> None:
    """Print a note or an error on standard error."""
    typer.echo(text, err=True)


def say_note(text: str) -> None:
    """Print a warning on standard error, and keep it for the output with ``--json``."""
    notes().append(text)
    say_error(f"note: {text}")


def notes() -> list[str]:
    """Return the warnings of the running command, in order."""
    return _notes.get()


@contextmanager
def new_notes() -> Iterator[None]:
    """Keep the warnings of one command."""
    token = _notes.set([])
    try:
        yield
    finally:
        _notes.reset(token)


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
