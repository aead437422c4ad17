"""``robotraj replay``: write a saved solution as one HTML file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from robotraj.cli.options import FileArgument
from robotraj.cli.terminal import say


def replay_file(
    file: FileArgument,
    out: Annotated[
        Path | None, typer.Argument(metavar="[OUT.html]", help="Where to; beside the file if not given.")
    ] = None,
    speed: Annotated[float, typer.Option(help="Playback speed to begin with; 1 is real time.")] = 1.0,
    periods: Annotated[int, typer.Option(help="How often a gait that closes on itself is shown.")] = 1,
    beside: Annotated[
        list[Path] | None,
        typer.Option("--with", metavar="FILE", help="A further saved solution to compare; up to three."),
    ] = None,
    check: Annotated[
        bool, typer.Option("--validate", help="Simulate first; the page shows report and verdict.")
    ] = False,
) -> None:
    """Write a saved solution as one HTML file that opens anywhere, offline.

    Example: robotraj replay slow.npz both.html --with fast.npz
    """
    from robotraj.replay_page.write import replay
    from robotraj.solution.storage.load import load_solution
    from robotraj.witness.validation import validate

    files = [file, *(beside or ())]
    solutions = [load_solution(each) for each in files]
    labels = [each.stem for each in files] if beside else None
    target = out or file.with_suffix(".html")
    reports = [validate(each) for each in solutions] if check else None
    say(f"wrote {replay(solutions, target, speed=speed, periods=periods, labels=labels, report=reports)}")
