"""``robotraj plan``: from rest to rest between two configurations."""

from __future__ import annotations

from typing import Annotated

import typer

from robotraj.cli.minimise import Minimise
from robotraj.cli.options import (
    HtmlOption,
    JsonOption,
    MemoryLimitOption,
    PlotOption,
    RobotArgument,
    SaveOption,
    TimeLimitOption,
)
from robotraj.cli.terminal import say, say_json
from robotraj.solution.errors import NoSolutionFound


def plan_motion(
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
    compiled: Annotated[
        bool, typer.Option("--compiled", help="Evaluate by compiled C, from the cache or compiled first.")
    ] = False,
    time_limit: TimeLimitOption = 60.0,
    memory_limit: MemoryLimitOption = None,
    html: HtmlOption = None,
    save: SaveOption = None,
    plot: PlotOption = None,
    as_json: JsonOption = False,
) -> None:
    """Plan a motion from rest to rest between two configurations, prove it and write the requested files.

    Example: robotraj plan ur5 --to 1,-1,1,0,0,0 --duration 0.5:3 --objective duration --html ur5.html

    A plan that is not solved is also written, so that its last iterate can be inspected.

    Problems of your own are Python scripts: write one with rt.Phase and rt.plan, and run it with python.
    """
    from robotraj.cli.arguments import configuration_of, limits_of, rest_to_rest
    from robotraj.cli.conclude import Files, conclude, described
    from robotraj.native.engines.compiled import Compiled
    from robotraj.planning.plan import plan
    from robotraj.robot.load import load
    from robotraj.transcription.schemes.control import LinearControl, PolynomialControl
    from robotraj.transcription.schemes.lobatto import HermiteSimpson
    from robotraj.transcription.schemes.mesh import Mesh

    mover = load(robot)
    phase = rest_to_rest(
        mover,
        objective,
        duration,
        configuration_of(mover, start, "--start"),
        configuration_of(mover, to, "--to"),
        limits_of(mover, limits, velocity, effort),
    )
    if not as_json:
        say(f"{phase}\n")
    mesh = None
    if intervals is not None:
        # Controls of least duration jump. Linear ones keep their limits between the points, parabolas would not.
        control = LinearControl() if objective is Minimise.duration else PolynomialControl()
        mesh = Mesh(intervals, HermiteSimpson(control=control))
    engine = Compiled() if compiled else None
    files = Files(html, save, plot)
    try:
        solution = plan(
            phase, mesh, tolerance=tolerance, engine=engine, time_limit=time_limit, memory_limit=memory_limit
        )
    except NoSolutionFound as error:
        written = files.write(error.solution)
        if as_json:
            say_json(described(error.solution, None, written))
        else:
            for path in written:
                say(f"wrote {path}")
        raise
    conclude(solution, files, as_json=as_json)
