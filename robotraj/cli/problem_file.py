"""``robotraj plan problem.toml``: a problem from a file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, cast

from robotraj._util.errors import InputError
from robotraj._util.paths import output_path
from robotraj.cli.options import PLOTS
from robotraj.cli.terminal import say_rows

if TYPE_CHECKING:
    from robotraj.applications.many.options import PlanOptions

SUFFIXES: Mapping[str, Sequence[str]] = {"html": (".html", ".htm"), "save": (".npz",), "plot": PLOTS}


def is_problem_file(given: str) -> bool:
    """Whether an argument is a problem file, not a robot."""
    return Path(given).suffix.lower() == ".toml"


def plan_problem_file(
    path: str,
    given: Mapping[str, Path | None],
    options: PlanOptions,
    time_limit: float | None,
    as_json: bool,
    rows: bool,
) -> None:
    """Plan the problem of a file, prove it and write the files that the file or the shell names.

    Parameters
    ----------
    path : str
    given : mapping
        Paths of the options ``--html``, ``--save`` and ``--plot``, which precede those of the file.
    options : mapping
        Options of ``rt.plan`` that were given at the shell; None where they were not.
    time_limit : float or None
        Of the shell; else that of the file.
    as_json : bool
    rows : bool
        Whether every row is listed.
    """
    from robotraj.applications.problem_files.load import load_problem
    from robotraj.cli.conclude import Files, conclude, planned

    written = load_problem(path)
    outputs = {name: output_path(each, SUFFIXES[name], f"{name} of [output]") for name, each in written.output.items()}
    files = Files(**{**outputs, **{name: each for name, each in given.items() if each}}, replay=written.replay)
    given_here = cast("PlanOptions", {name: each for name, each in options.items() if each is not None})
    chosen: PlanOptions = {**written.options, **given_here}
    if time_limit is not None:
        chosen["time_limit"] = time_limit
    if not as_json:
        say_rows(written.problem, rows)
    solution = planned(lambda: written.plan(**chosen), files, as_json)
    conclude(solution, files, as_json=as_json, validation=written.validation)


def refuse_options(names: Sequence[str], path: str) -> None:
    """Raise an InputError where options of a robot are given beside a file."""
    if names:
        raise InputError(
            f"{', '.join(names)} {'is' if len(names) == 1 else 'are'} for a robot; {path} is a problem file, which "
            "states the motion itself: change it there."
        )
