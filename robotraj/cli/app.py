"""The command line: demos, plans between two configurations, saved solutions, compiled functions, and robots."""

from __future__ import annotations

import warnings
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table
from typer.core import TyperGroup

from robotraj._util.errors import InputError, RobotrajError
from robotraj.cli import demos
from robotraj.cli.arguments import Minimise, configuration_of, limits_of, rest_to_rest
from robotraj.cli.engines import cache_command, compile_command, profile_command
from robotraj.native.engines.compiled import Compiled
from robotraj.planning.plan import plan
from robotraj.replay_page.write import html_path, replay
from robotraj.robot.known_robots.catalogue import catalogue
from robotraj.robot.load import load
from robotraj.solution.solution import Solution, load_solution
from robotraj.transcription.schemes.control import LinearControl, PolynomialControl
from robotraj.transcription.schemes.lobatto import HermiteSimpson
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.witness import validate


class _Group(TyperGroup):
    """Says what went wrong in one sentence and exits with 1; warnings become notes."""

    def invoke(self, ctx: Any) -> Any:
        with warnings.catch_warnings():
            warnings.showwarning = lambda message, *_, **__: _complain(f"note: {message}")
            try:
                return super().invoke(ctx)
            except (RobotrajError, OSError) as error:
                _complain(f"error: {error}")
                raise typer.Exit(1) from error


app = typer.Typer(
    cls=_Group,
    name="robotraj",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    help="Plan robot motions by direct collocation, prove them by simulation, watch them in a browser.",
)


def _say(text: Any) -> None:
    """Print as it is: no markup, no wrapping."""
    typer.echo(str(text))


def _complain(text: str) -> None:
    typer.echo(text, err=True)


def _show_version(wanted: bool) -> None:
    if wanted:
        try:
            _say(f"robotraj {version('robotraj')}")
        except PackageNotFoundError:
            _say("robotraj, from a checkout")
        raise typer.Exit


@app.callback()
def main(
    shown: Annotated[
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="Print the version and exit."),
    ] = False,
) -> None:
    """Plan robot motions by direct collocation, prove them by simulation, watch them in a browser.

    Start with: robotraj demo
    """


def _html(path: Path | None) -> Path | None:
    """Refuse where no replay can be written before anything is planned."""
    return None if path is None else html_path(path)


HtmlOption = Annotated[
    Path | None, typer.Option("--html", callback=_html, help="Where to write the replay.", dir_okay=False)
]
SaveOption = Annotated[Path | None, typer.Option("--save", help="Also save the solution, as .npz.")]
PlotOption = Annotated[Path | None, typer.Option("--plot", help="Also draw the curves, as .png, .svg or .pdf.")]
FileArgument = Annotated[Path, typer.Argument(metavar="FILE.npz", help="A file that solution.save wrote.")]
RobotArgument = Annotated[
    str, typer.Argument(metavar="ROBOT", help="A name that 'robotraj robots' lists, or a URDF file.")
]


@app.command(short_help="Plan a built-in demo, prove it, write its replay.")
def demo(
    name: Annotated[str, typer.Argument(metavar="[NAME]", help=f"One of {', '.join(demos.DEMOS)}.")] = demos.DEFAULT,
    html: HtmlOption = None,
    save: SaveOption = None,
    plot: PlotOption = None,
) -> None:
    """Plan a built-in demo, prove it and write its replay as HTML into the current directory."""
    make = demos.demo_named(name)
    _say(f"{name}: {demos.summary(name)}\n")
    chosen = make()
    _say(f"{chosen.phase}\n")
    known: Any = chosen.guess
    for mesh in chosen.meshes:
        known = plan(chosen.phase, mesh, known)
    _conclude(known, html or Path(f"{name}.html"), save, plot)


@app.command("plan", short_help="Plan from rest to rest between two configurations.")
def plan_command(
    robot: RobotArgument,
    to: Annotated[
        str,
        typer.Option(
            "--to",
            "--end",
            metavar="Q",
            help="Last configuration [rad, m]: '0,1.57,0' or 'elbow=1.57,wrist=0'.",
        ),
    ],
    start: Annotated[
        str | None,
        typer.Option("--start", "--from", metavar="Q", help="First configuration; the neutral one if not given."),
    ] = None,
    duration: Annotated[
        str | None,
        typer.Option(metavar="T", help="Seconds, '2' or '0.5:3'; 2 by default, free when it is minimised."),
    ] = None,
    objective: Annotated[Minimise, typer.Option(help="What is minimised.")] = Minimise.effort,
    intervals: Annotated[int | None, typer.Option(help="Hermite-Simpson intervals; 40 by default.")] = None,
    tolerance: Annotated[
        float | None, typer.Option(help="Refine the mesh until the error between knots is below this.")
    ] = None,
    velocity: Annotated[
        float | None, typer.Option(help="Largest speed of every joint [rad/s, m/s] in place of the URDF's.")
    ] = None,
    effort: Annotated[
        float | None, typer.Option(help="Largest torque of every joint [N m, N] in place of the URDF's.")
    ] = None,
    limits: Annotated[bool, typer.Option(help="Hold the robot's own joint limits.")] = True,
    compiled: Annotated[
        bool, typer.Option("--compiled", help="Evaluate by compiled C, from the cache or compiled first.")
    ] = False,
    html: HtmlOption = None,
    save: SaveOption = None,
    plot: PlotOption = None,
) -> None:
    """Plan a motion from rest to rest between two configurations, prove it and write what was asked for.

    Example: robotraj plan ur5 --to 1,-1,1,0,0,0 --duration 0.5:3 --objective duration --html ur5.html
    """
    mover = load(robot)
    phase = rest_to_rest(
        mover,
        objective,
        duration,
        configuration_of(mover, start, "--start"),
        configuration_of(mover, to, "--to"),
        limits_of(mover, limits, velocity, effort),
    )
    _say(f"{phase}\n")
    # Controls of least duration jump: lines keep their limits between the points, parabolas would not.
    control = LinearControl() if objective is Minimise.duration else PolynomialControl()
    mesh = None
    if intervals is not None or tolerance is None:
        mesh = Mesh(40 if intervals is None else intervals, HermiteSimpson(control=control))
    engine = Compiled() if compiled else None
    _conclude(plan(phase, mesh, tolerance=tolerance, engine=engine), html, save, plot)


@app.command("validate", short_help="Prove a saved solution by simulation.")
def validate_command(
    file: FileArgument,
    local: Annotated[float, typer.Option(help="Largest relative local error allowed.")] = 1e-3,
    limits: Annotated[float, typer.Option(help="Largest violation of a limit allowed, relative to its range.")] = 1e-3,
) -> None:
    """Simulate a saved solution with plain Pinocchio and print the proof; exit with 1 if it fails."""
    solution = load_solution(file)
    _say(solution)
    report = validate(solution, local=local, limits=limits)
    _say(report)
    if not report.passed:
        raise typer.Exit(1)


@app.command("replay", short_help="Write a saved solution as one HTML file.")
def replay_command(
    file: FileArgument,
    out: Annotated[
        Path | None, typer.Argument(metavar="[OUT.html]", help="Where to; beside the file if not given.")
    ] = None,
    speed: Annotated[float, typer.Option(help="Playback speed to begin with; 1 is real time.")] = 1.0,
    periods: Annotated[int, typer.Option(help="How often a gait that closes on itself is shown.")] = 1,
) -> None:
    """Write a saved solution as one HTML file that opens anywhere, offline."""
    solution = load_solution(file)
    _say(f"wrote {replay(solution, out or file.with_suffix('.html'), speed=speed, periods=periods)}")


app.command("compile", short_help="Compile what plans evaluate, before they are made.")(compile_command)
app.command("cache", short_help="Show or clear what was compiled.")(cache_command)
app.command("profile", short_help="Show where a saved solution's time went.")(profile_command)


@app.command()
def robots(
    search: Annotated[str, typer.Argument(help="Only robots whose name or description contains this.")] = "",
) -> None:
    """List the robots that can be loaded by name."""
    wanted = search.lower()
    entries = [e for e in catalogue() if wanted in f"{e.name} {e.description}".lower()]
    if not entries:
        raise InputError(f"No robot's name or description contains {search!r}; 'robotraj robots' lists them all.")
    table = Table(title=f"{len(entries)} robots", title_justify="left", header_style="bold")
    table.add_column("name", no_wrap=True)
    table.add_column("what it is")
    table.add_column("source", no_wrap=True)
    for entry in entries:
        table.add_row(entry.name, entry.description, entry.source)
    Console(markup=False, highlight=False).print(table)


@app.command()
def show(robot: RobotArgument) -> None:
    """Print a robot's joints, limits and frames."""
    known = {entry.name: entry for entry in catalogue()}
    mover = load(robot)
    if robot in known:
        entry = known[robot]
        _say(f"{entry.description}\nlicence: {entry.licence}\nprovenance: {entry.provenance}\n")
    _say(mover)
    for complaint in mover.limits.complaints(mover.actuated):
        _say(f"! {complaint}")
    kinds: dict[str, list[str]] = {}
    for frame in mover.model.frames:
        kinds.setdefault(str(frame.type).lower().replace("_", " "), []).append(frame.name)
    _say("\nframes")
    for kind, names in kinds.items():
        _say(f"  {kind}: {', '.join(names)}")


def _conclude(solution: Solution, html: Path | None, save: Path | None, plot: Path | None) -> None:
    """Print the solution and its proof, write the files, and exit with 1 if the proof failed."""
    _say(f"{solution}\n")
    report = validate(solution)
    _say(report)
    written = []
    if save is not None:
        written.append(solution.save(save))
    if plot is not None:
        target = plot.expanduser().absolute()
        try:
            solution.plot().savefig(target)
        except ValueError as error:
            raise InputError(f"Cannot draw {str(plot)!r}: {error}") from error
        written.append(target)
    if html is not None:
        written.append(replay(solution, html))
    for path in written:
        _say(f"wrote {path}")
    if not report.passed:
        raise typer.Exit(1)
