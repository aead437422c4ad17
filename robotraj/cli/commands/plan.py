"""``robotraj plan``: from rest to rest between two configurations, or the problem of a file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from robotraj._util.errors import InputError
from robotraj.cli.minimise import Minimise
from robotraj.cli.options import (
    HtmlOption,
    JsonOption,
    MemoryLimitOption,
    PackageDirsOption,
    PlotOption,
    ProblemArgument,
    RowsOption,
    SaveOption,
    TimeLimitOption,
    TrustPathsOption,
)
from robotraj.cli.problem_file import is_problem_file, plan_problem_file, refuse_options
from robotraj.cli.terminal import say_rows

if TYPE_CHECKING:
    from robotraj.solution.solution import Solution


ROBOT_OPTIONS = (
    "to", "start", "duration", "objective", "intervals", "tolerance", "velocity", "effort", "limits", "collision_free",
    "obstacles", "srdf", "margin", "package_dirs", "trust_paths", "compiled"
)  # fmt: skip
"""Options of a motion of a robot; a problem file states them itself."""
ROBOT_TIME = 60.0
"""Default of ``--time-limit`` for a robot; a problem file has its own."""


def plan_motion(
    context: typer.Context,
    robot: ProblemArgument,
    to: Annotated[
        str | None,
        typer.Option(
            "--to",
            "--end",
            metavar="Q",
            help="Last configuration [rad, m]: '0,1.57,0' or 'elbow=1.57,wrist=0'.",
        ),
    ] = None,
    start: Annotated[
        str | None,
        typer.Option("--start", "--from", metavar="Q", help="First configuration; the neutral one if not given."),
    ] = None,
    duration: Annotated[
        str | None,
        typer.Option(metavar="T", help="Seconds, '2' or '0.5:3'; 2 by default, free when it is minimised."),
    ] = None,
    objective: Annotated[Minimise, typer.Option(help="What is minimised.")] = Minimise.effort,
    intervals: Annotated[
        int | None,
        typer.Option(help="Plan on this many Hermite-Simpson intervals, without refinement."),
    ] = None,
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
    collision_free: Annotated[
        bool, typer.Option("--collision-free", help="Keep the links off each other and off the obstacles, proved.")
    ] = False,
    obstacles: Annotated[
        Path | None, typer.Option(metavar="FILE.toml", help="Obstacles as tables [[obstacles]]; no link touches them.")
    ] = None,
    srdf: Annotated[
        Path | None, typer.Option(metavar="FILE", help="An SRDF: pairs of links that it disables are not kept apart.")
    ] = None,
    margin: Annotated[float | None, typer.Option(min=0.0, help="Least distance from obstacles and links [m].")] = None,
    package_dirs: PackageDirsOption = None,
    trust_paths: TrustPathsOption = False,
    compiled: Annotated[
        bool, typer.Option("--compiled", help="Evaluate by compiled C, from the cache or compiled first.")
    ] = False,
    time_limit: TimeLimitOption = None,
    memory_limit: MemoryLimitOption = None,
    html: HtmlOption = None,
    save: SaveOption = None,
    plot: PlotOption = None,
    as_json: JsonOption = False,
    rows: RowsOption = False,
    watch: Annotated[bool, typer.Option("--watch", help="Show iterates and residuals in a browser.")] = False,
) -> None:
    """Plan a motion from rest to rest between two configurations, or a problem file; prove it and write its files.

    Example: robotraj plan ur5 --to 1,-1,1,0,0,0 --duration 0.5:3 --objective duration --html ur5.html

    Example: robotraj plan ur5 --to 1,-1,1,0,0,0 --obstacles scene.toml

    Example: robotraj init ur5 && robotraj plan problem.toml

    A plan that is not solved is also written, so that its last iterate can be inspected.

    Problems with expressions of your own are Python scripts: use rt.Phase and rt.plan, and run them with python.
    """
    from robotraj.cli.arguments import clear_of, configuration_of, limits_of, rest_to_rest
    from robotraj.cli.conclude import Files, conclude, planned
    from robotraj.native.engines.compiled import Compiled
    from robotraj.planning.plan import plan
    from robotraj.robot.load import load
    from robotraj.transcription.schemes.control import LinearControl, PolynomialControl
    from robotraj.transcription.schemes.lobatto import HermiteSimpson
    from robotraj.transcription.schemes.mesh import Mesh

    if is_problem_file(robot):
        sources = {name: context.get_parameter_source(name) for name in ROBOT_OPTIONS}
        given = [name for name, source in sources.items() if source is not None and source.name != "DEFAULT"]
        refuse_options([f"--{name.replace('_', '-')}" for name in given], robot)
        outputs = {"html": html, "save": save, "plot": plot}
        plan_problem_file(robot, outputs, {"memory_limit": memory_limit, "watch": watch}, time_limit, as_json, rows)
        return
    mover = load(robot, package_dirs=package_dirs or (), trust_paths=trust_paths)
    if to is None:
        raise InputError(
            f"--to is missing: the last configuration of {robot!r}, as in --to 0,1.57,0. "
            f"'robotraj init {robot}' writes a problem file to start from."
        )
    phase = rest_to_rest(
        mover,
        objective,
        duration,
        configuration_of(mover, start, "--start"),
        configuration_of(mover, to, "--to"),
        limits_of(mover, limits, velocity, effort),
        clear_of(obstacles, srdf, margin) if collision_free or obstacles or srdf or margin is not None else (),
    )
    if not as_json:
        say_rows(phase, rows)
    mesh = None
    if intervals is not None:
        # Controls of least duration jump. Linear ones keep their limits between the points, parabolas would not.
        control = LinearControl() if objective is Minimise.duration else PolynomialControl()
        mesh = Mesh(intervals, HermiteSimpson(control=control))
    engine = Compiled() if compiled else None
    files = Files(html, save, plot)
    limit = ROBOT_TIME if time_limit is None else time_limit

    def solved() -> Solution:
        return plan(
            phase,
            mesh,
            tolerance=tolerance,
            engine=engine,
            time_limit=limit,
            memory_limit=memory_limit,
            watch=watch,
        )

    conclude(planned(solved, files, as_json), files, as_json=as_json)
