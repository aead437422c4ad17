"""``robotraj compile``: compile the functions of plans before they are made."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from robotraj._util.errors import InputError
from robotraj.cli.minimise import Minimise
from robotraj.cli.options import PackageDirsOption, TrustPathsOption, check_robot
from robotraj.cli.terminal import say

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase
    from robotraj.problem.problem import Problem

ROOTS: tuple[Literal["fixed", "planar", "floating"], ...] = ("fixed", "planar", "floating")


def compile_functions(
    what: Annotated[
        str,
        typer.Argument(
            metavar="FILE.npz|ROBOT", callback=check_robot, help="A saved solution, or a robot's name or URDF file."
        ),
    ],
    root: Annotated[str, typer.Option(help=f"Of a robot: {', '.join(ROOTS)}.")] = "fixed",
    package_dirs: PackageDirsOption = None,
    trust_paths: TrustPathsOption = False,
) -> None:
    """Compile the functions of plans into your cache: later plans with rt.engines.Compiled() do not wait.

    For a saved solution: the functions of its problem, on any mesh and between any ends. For a robot: those of motions
    from rest to rest, of least effort and of least duration, as 'robotraj plan ROBOT --compiled' plans them. Problems
    with contacts, path constraints or other objectives have other functions; compile them by rt.planning.precompile.
    """
    from robotraj.planning.compilation import precompile
    from robotraj.transcription.schemes.control import LinearControl
    from robotraj.transcription.schemes.lobatto import HermiteSimpson
    from robotraj.transcription.schemes.mesh import Mesh

    if Path(what).suffix == ".npz":
        problems: dict[str, Phase] | dict[str, Problem] = {"its problem": _of_file(what)}
    else:
        problems = _of_robot(what, root, package_dirs or [], trust_paths)
    for name, problem in problems.items():
        # Motions of least duration have linear controls, as in 'robotraj plan'.
        say(f"{name}: {precompile(problem, Mesh(10, HermiteSimpson(control=LinearControl())))}")


def _of_file(path: str) -> Problem:
    from robotraj.solution.storage.load import load_solution

    problem = load_solution(path).problem
    if problem.missing:
        raise InputError(
            f"{path} holds no Python functions, and its problem needs some; compile it by rt.planning.precompile."
        )
    return problem


def _of_robot(name: str, root: str, package_dirs: list[Path], trust_paths: bool) -> dict[str, Phase]:
    from robotraj.cli.arguments import rest_to_rest
    from robotraj.robot.load import load

    chosen = next((known for known in ROOTS if known == root), None)
    if chosen is None:
        raise InputError(f"--root is one of {', '.join(ROOTS)}; got {root!r}.")
    robot = load(name, root=chosen, package_dirs=package_dirs, trust_paths=trust_paths)
    return {
        f"least {objective.value}": rest_to_rest(robot, objective, None, None, None, robot.limits)
        for objective in Minimise
    }
