"""Commands about speed: compile, cache, profile."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, cast

import typer

from robotraj._util.errors import InputError
from robotraj.cli.arguments import Minimise, rest_to_rest
from robotraj.native.engines.compiled import Compiled
from robotraj.planning.compilation import precompile
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.load import load
from robotraj.solution.solution import load_solution
from robotraj.transcription.schemes.control import LinearControl
from robotraj.transcription.schemes.lobatto import HermiteSimpson
from robotraj.transcription.schemes.mesh import Mesh

ROOTS = ("fixed", "planar", "floating")


def compile_command(
    what: Annotated[
        str, typer.Argument(metavar="FILE.npz|ROBOT", help="A saved solution, or a robot's name or URDF file.")
    ],
    root: Annotated[str, typer.Option(help=f"Of a robot: {', '.join(ROOTS)}.")] = "fixed",
) -> None:
    """Compile what plans evaluate into your cache, so that later plans with rt.engines.Compiled() do not wait.

    For a saved solution: the functions of its problem, on any mesh and between any ends. For a robot: those of motions
    from rest to rest, of least effort and of least duration, as 'robotraj plan ROBOT --compiled' plans them. What a
    robot's problem adds in Python (contacts, path constraints, other objectives) makes other functions: rt.precompile.
    """
    problems = _of_robot(what, root) if Path(what).suffix != ".npz" else {"its problem": _of_file(what)}
    for name, problem in problems.items():
        # Limits of least duration are held by lines, as 'robotraj plan' has them.
        typer.echo(f"{name}: {precompile(problem, Mesh(10, HermiteSimpson(control=LinearControl())))}")


def _of_file(path: str) -> Problem:
    problem = load_solution(path).problem
    if problem.missing:
        raise InputError(f"{path} holds no Python functions, and its problem needs some; compile it by rt.precompile.")
    return problem


def _of_robot(name: str, root: str) -> dict[str, Phase]:
    if root not in ROOTS:
        raise InputError(f"--root is one of {', '.join(ROOTS)}; got {root!r}.")
    robot = load(name, root=cast(Literal["fixed", "planar", "floating"], root))
    return {
        f"least {objective.value}": rest_to_rest(robot, objective, None, None, None, robot.limits)
        for objective in Minimise
    }


def cache_command(
    clear: Annotated[bool, typer.Option("--clear", help="Remove everything in it.")] = False,
) -> None:
    """Show where compiled functions are kept, how many and how large; or remove them."""
    cache = Compiled().open_cache()
    if clear:
        typer.echo(f"freed {cache.clear() / 1e6:.1f} MB in {cache.folder}")
    else:
        typer.echo(f"{len(cache.libraries())} functions, {cache.size() / 1e6:.1f} MB in {cache.folder}")


def profile_command(
    file: Annotated[Path, typer.Argument(metavar="FILE.npz", help="A file that solution.save wrote.")],
) -> None:
    """Show where the seconds of a saved solution went: build, compile, and the parts of the solve."""
    solution = load_solution(file)
    total = solution.seconds
    for name, seconds in sorted(solution.times.items()):
        label = f"  {name.partition(': ')[2]}" if ":" in name else name
        typer.echo(f"{label:<32}{seconds:10.4f} s {seconds / total if total else 0:8.1%}")
    typer.echo(f"{'total':<32}{total:10.4f} s, {solution.iterations} iterations")
