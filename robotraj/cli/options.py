"""Options and arguments of several commands, with their shell completion."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from robotraj._util.errors import InputError
from robotraj._util.paths import output_path

PLOTS = (".png", ".svg", ".pdf")


def complete_robot(incomplete: str) -> list[str]:
    """List the robots whose names begin with the given text; the shell completes file names."""
    from robotraj.robot.known_robots.catalogue import catalogue

    return [entry.name for entry in catalogue() if entry.name.startswith(incomplete)]


def check_robot(given: str) -> str:
    """Refuse a Python script, and name the command that runs it."""
    if Path(given).suffix == ".py":
        raise InputError(
            f"{given!r} is a Python script, and this command takes a robot: a name that 'robotraj robots' lists, "
            f"or a URDF file. Run the script with: python {given}"
        )
    return given


def _html(path: Path | None) -> Path | None:
    return None if path is None else output_path(path, (".html", ".htm"), "--html")


def _save(path: Path | None) -> Path | None:
    if path is not None:
        output_path(path if path.name.endswith(".npz") else path.with_name(path.name + ".npz"), (".npz",), "--save")
    return path


def _plot(path: Path | None) -> Path | None:
    return None if path is None else output_path(path, PLOTS, "--plot")


HtmlOption = Annotated[Path | None, typer.Option("--html", callback=_html, help="Where to write the replay.")]
SaveOption = Annotated[Path | None, typer.Option("--save", callback=_save, help="Also save the solution, as .npz.")]
PlotOption = Annotated[
    Path | None, typer.Option("--plot", callback=_plot, help="Also draw the curves, as .png, .svg or .pdf.")
]
RowsOption = Annotated[bool, typer.Option("--rows", help="List every row of the problem, not groups of equal rows.")]
JsonOption = Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")]
TimeLimitOption = Annotated[
    float | None,
    typer.Option(
        "--time-limit",
        min=0.001,
        help="Processor seconds after which the plan stops; 60 for a robot, else that of the problem file.",
    ),
]
MemoryLimitOption = Annotated[
    float | None,
    typer.Option("--memory-limit", min=1.0, help="Resident memory [MB] of the process after which the plan stops."),
]
ProblemArgument = Annotated[
    str,
    typer.Argument(
        metavar="ROBOT|FILE.toml",
        callback=check_robot,
        autocompletion=complete_robot,
        help="A name that 'robotraj robots' lists, a URDF file, or a problem file.",
    ),
]
PackageDirsOption = Annotated[
    list[Path] | None,
    typer.Option("--package-dirs", help="A folder above the package of the meshes; may be given several times."),
]
TrustPathsOption = Annotated[bool, typer.Option("--trust-paths", help="Read meshes from any path that the URDF names.")]
FileArgument = Annotated[Path, typer.Argument(metavar="FILE.npz", help="A file that solution.save wrote.")]
RobotArgument = Annotated[
    str,
    typer.Argument(
        metavar="ROBOT",
        callback=check_robot,
        autocompletion=complete_robot,
        help="A name that 'robotraj robots' lists, or a URDF file.",
    ),
]
