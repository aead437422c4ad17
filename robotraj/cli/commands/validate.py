"""``robotraj validate``: prove a saved solution by simulation."""

from __future__ import annotations

from typing import Annotated

import typer

from robotraj.cli.exits import ExitCode
from robotraj.cli.options import FileArgument, JsonOption
from robotraj.cli.terminal import say, say_json


def validate_file(
    file: FileArgument,
    local: Annotated[float, typer.Option(help="Largest relative local error allowed.")] = 1e-3,
    limits: Annotated[float, typer.Option(help="Largest violation of a limit allowed, relative to its range.")] = 1e-3,
    as_json: JsonOption = False,
) -> None:
    """Simulate a saved solution with plain Pinocchio and print the proof."""
    from robotraj.cli.conclude import described
    from robotraj.solution.storage.load import load_solution
    from robotraj.witness.validation import validate

    solution = load_solution(file)
    if not as_json:
        say(solution)
    report = validate(solution, local=local, limits=limits)
    if as_json:
        say_json(described(solution, report, []))
    else:
        say(report)
    if not report.passed:
        raise typer.Exit(ExitCode.NOT_PROVED)
