"""``robotraj export``: a saved solution as a file of another program."""

from __future__ import annotations

from enum import Enum
from pathlib import Path
from typing import Annotated

import typer

from robotraj._util.errors import InputError
from robotraj.cli.options import FileArgument, JsonOption
from robotraj.cli.terminal import say, say_json


class Format(str, Enum):
    """What ``robotraj export`` writes."""

    csv = "csv"
    json = "json"
    ros_yaml = "ros-yaml"
    ros_json = "ros-json"
    controller_csv = "controller-csv"
    servo = "servo"
    mcap = "mcap"


SUFFIXES = {
    Format.csv: ".csv",
    Format.json: ".json",
    Format.ros_yaml: ".yaml",
    Format.ros_json: ".json",
    Format.controller_csv: ".csv",
    Format.servo: ".servo",
    Format.mcap: ".mcap",
}
TABLES = (Format.csv, Format.json)
"""Every variable of the plan; the other formats hold set points of the motors."""
CONTROLLER_RATE = 1000.0


def export_file(
    file: FileArgument,
    out: Annotated[Path | None, typer.Argument(metavar="[OUT]", help="Where to; beside the file if not given.")] = None,
    form: Annotated[
        Format, typer.Option("--format", help="csv and json: every variable; the others: set points of the motors.")
    ] = Format.csv,
    rate: Annotated[
        float | None,
        typer.Option(help="Samples per second; 201 in all for csv and json if not given, else 1000 a second."),
    ] = None,
    gains: Annotated[bool, typer.Option("--gains", help="Add the feedback gains, to csv and json.")] = False,
    as_json: JsonOption = False,
) -> None:
    """Write a saved solution for a spreadsheet, another program or the controller of a robot.

    Example: robotraj export swing.npz --format ros-yaml --rate 250

    ros-yaml and ros-json are messages trajectory_msgs/JointTrajectory; servo has one row a period without header.
    """
    from robotraj.solution.export.controllers import to_controller
    from robotraj.solution.export.tables import to_csv, to_json
    from robotraj.solution.storage.load import load_solution

    target = out or file.with_suffix(SUFFIXES[form])
    if target.suffix.lower() != SUFFIXES[form]:
        raise InputError(f"--format {form.value} writes {SUFFIXES[form]} files; got {str(target)!r}.")
    if gains and form not in TABLES:
        raise InputError(f"--gains are for --format csv and json; {form.value} holds set points.")
    solution = load_solution(file)
    if form in TABLES:
        write = to_csv if form is Format.csv else to_json
        written = write(solution, target, gains=gains, rate=rate)
    else:
        written = to_controller(solution, target, CONTROLLER_RATE if rate is None else rate)
    if as_json:
        say_json({"format": form.value, "written": [str(written)]})
    else:
        say(f"wrote {written}")
