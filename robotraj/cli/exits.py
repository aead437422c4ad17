"""Errors at the shell: one line for an error, a note for a warning, and an exit code for each kind of failure."""

from __future__ import annotations

import warnings
from enum import IntEnum
from typing import Any

import typer
from typer.core import TyperGroup

from robotraj._util.errors import InputError, RobotrajError, ValidationFailed
from robotraj.cli.terminal import drop_output, new_notes, say_error, say_note
from robotraj.solution.errors import NoSolutionFound


class ExitCode(IntEnum):
    """Exit codes of every command; wrong options exit with 2 as well."""

    DONE = 0
    ERROR = 1
    BAD_INPUT = 2
    NOT_SOLVED = 3
    NOT_PROVED = 4
    INTERRUPTED = 130


EXIT_CODES = "Exit codes: 0 done, 1 other errors, 2 bad input, 3 not solved, 4 solved but not proved, 130 Ctrl-C."


def code_of(error: RobotrajError | OSError) -> ExitCode:
    """Return the exit code of an error."""
    if isinstance(error, NoSolutionFound):
        return ExitCode.NOT_SOLVED
    if isinstance(error, ValidationFailed):
        return ExitCode.NOT_PROVED
    return ExitCode.BAD_INPUT if isinstance(error, InputError | OSError) else ExitCode.ERROR


class Group(TyperGroup):
    """Prints an error in one line and exits with its code; warnings become notes."""

    def invoke(self, ctx: Any) -> object:
        """Run a command."""
        with warnings.catch_warnings(), new_notes():
            warnings.showwarning = lambda message, *_, **__: say_note(str(message))
            try:
                return super().invoke(ctx)
            except BrokenPipeError as error:
                drop_output()
                raise typer.Exit(ExitCode.DONE) from error
            except KeyboardInterrupt as error:
                say_error("interrupted")
                raise typer.Exit(ExitCode.INTERRUPTED) from error
            except (RobotrajError, OSError) as error:
                say_error(f"error: {error}")
                raise typer.Exit(code_of(error)) from error
