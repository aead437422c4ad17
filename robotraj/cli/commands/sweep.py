"""``robotraj sweep``: plan a study, or one part of it in a job of an array."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Annotated

import typer

from robotraj._util.errors import InputError
from robotraj._util.system.regular_files import near_files
from robotraj.cli.terminal import say

StudyArgument = Annotated[Path, typer.Argument(help="Python file with make(case), cases and, if wanted, options.")]


def sweep_study(
    file: StudyArgument,
    store: Annotated[Path, typer.Option("--store", help="Folder of the study; the same call goes on in it.")],
    part: Annotated[str, typer.Option("--part", help="Part of how many, from 0, such as 3/200.")] = "0/1",
    keep: Annotated[str, typer.Option("--keep", help="'trajectory', or 'all' for whole solutions.")] = "trajectory",
    validate: Annotated[bool, typer.Option("--validate", help="Validate every plan by simulation.")] = False,
) -> None:
    """Plan the cases of a study that are missing.

    The file is run as Python. It has a function make(case), which returns a problem, a list or table cases, and may
    have a dict options of rt.plan, such as {"time_limit": 20}. Each job of an array takes its part, then what is left
    of others: robotraj sweep study.py --store reaches --part $SLURM_ARRAY_TASK_ID/200
    """
    from robotraj.applications.many.sweep import sweep

    if not file.is_file():
        raise InputError(
            f"There is no file {str(file)!r}; give a Python file with make(case) and cases.{near_files(file)}"
        )
    known = runpy.run_path(str(file))
    for name in ("make", "cases"):
        if name not in known:
            raise InputError(f"{str(file)!r} defines no {name!r}; a study needs make(case) and cases.")
    study = sweep(
        known["make"],
        known["cases"],
        store=store,
        keep=keep,
        validate=validate,
        part=_part(part),
        **dict(known.get("options", {})),
    )
    say(str(study))


def _part(given: str) -> tuple[int, int]:
    number, slash, count = given.partition("/")
    if not (slash and number.isdecimal() and count.isdecimal()):
        raise InputError(f"--part is {given!r}; give the number of a part, from 0, and that of all, such as 3/200.")
    return int(number), int(count)
