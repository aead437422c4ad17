"""``robotraj init``: a first problem file of a robot."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from robotraj._util.errors import InputError
from robotraj._util.paths import input_path, output_path
from robotraj._util.system.whole_files import WholeFile
from robotraj.cli.options import JsonOption, PackageDirsOption, RobotArgument, TrustPathsOption
from robotraj.cli.terminal import say, say_json


def write_problem(
    robot: RobotArgument,
    out: Annotated[Path, typer.Argument(metavar="[OUT.toml]", help="Where to.")] = Path("problem.toml"),
    root: Annotated[
        str | None,
        typer.Option(
            help="fixed: a motion from rest to rest; planar or floating: a gait, or a jump on one foot. By default "
            "fixed, or floating where the file's first joint is free."
        ),
    ] = None,
    package_dirs: PackageDirsOption = None,
    trust_paths: TrustPathsOption = False,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
    as_json: JsonOption = False,
) -> None:
    """Write a commented problem file of a robot that plans as it stands.

    Example: robotraj init ur5 && robotraj plan problem.toml
    """
    from robotraj.applications.problem_files.starter import starter
    from robotraj.robot.load import load

    target = output_path(out, (".toml",), "the problem file")
    if target.exists() and not force:
        raise InputError(f"{str(out)!r} exists; name another file, or replace it with --force.")
    path = input_path(robot, "The robot")
    source = os.path.relpath(path, target.parent) if os.path.isfile(path) else robot
    folders = [str(input_path(folder, "package_dirs=").resolve()) for folder in package_dirs or ()]
    mover = load(robot, root=root, package_dirs=folders, trust_paths=trust_paths)
    text = starter(mover, source, out.name, folders, trust_paths)
    with WholeFile(target) as partial:
        partial.write_text(text, encoding="utf-8")
    if as_json:
        say_json({"written": [str(target)]})
    else:
        say(f"wrote {target}\nplan it with: robotraj plan {out}")
