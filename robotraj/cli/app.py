"""The command line: joins the commands and prints the version."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version
from typing import Annotated

import typer

from robotraj.cli.commands.cache import cache
from robotraj.cli.commands.compare import compare_files
from robotraj.cli.commands.compile import compile_functions
from robotraj.cli.commands.demo import demo
from robotraj.cli.commands.export import export_file
from robotraj.cli.commands.init import write_problem
from robotraj.cli.commands.plan import plan_motion
from robotraj.cli.commands.profile import profile
from robotraj.cli.commands.replay import replay_file
from robotraj.cli.commands.robots import robots
from robotraj.cli.commands.schema import print_schema
from robotraj.cli.commands.show import show
from robotraj.cli.commands.sweep import sweep_study
from robotraj.cli.commands.validate import validate_file
from robotraj.cli.doctor import doctor
from robotraj.cli.exits import EXIT_CODES, Group
from robotraj.cli.terminal import say

app = typer.Typer(
    cls=Group,
    name="robotraj",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    epilog=EXIT_CODES,
)


def _show_version(wanted: bool) -> None:
    if wanted:
        try:
            say(f"robotraj {version('robotraj')}")
        except PackageNotFoundError:
            say("robotraj, not installed: it runs from its source folder")
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


app.command("demo", short_help="Plan a built-in demo, prove it, write its replay.")(demo)
app.command("init", short_help="Write a problem file of a robot, to plan and to change.")(write_problem)
app.command("plan", short_help="Plan from rest to rest, or the problem of a file.", epilog=EXIT_CODES)(plan_motion)
app.command("sweep", short_help="Plan a study of many cases, or a part of it.")(sweep_study)
app.command("validate", short_help="Prove a saved solution by simulation.", epilog=EXIT_CODES)(validate_file)
app.command("replay", short_help="Write a saved solution as one HTML file.")(replay_file)
app.command("export", short_help="Write a saved solution for other programs and controllers.")(export_file)
app.command("compare", short_help="Show the differences of two saved solutions.")(compare_files)
app.command("schema", short_help="Show what problem files may state.")(print_schema)
app.command("compile", short_help="Compile the functions of plans before they are made.")(compile_functions)
app.command("cache", short_help="Show or clear the compiled functions.")(cache)
app.command("profile", short_help="Show where a saved solution's time went.")(profile)
app.command("doctor", short_help="Show versions, compiler and cache, and what is missing.")(doctor)
app.command("robots")(robots)
app.command("show")(show)
