"""``robotraj compare``: two saved solutions, or two studies, side by side."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from robotraj.cli.exits import ExitCode
from robotraj.cli.options import FileArgument, JsonOption
from robotraj.cli.terminal import say, say_json

if TYPE_CHECKING:
    from robotraj.cli.comparison import Compared


def compare_files(
    first: FileArgument,
    second: FileArgument,
    everything: Annotated[bool, typer.Option("--all", help="Print equal rows as well.")] = False,
    as_json: JsonOption = False,
) -> None:
    """Print the differences of two saved solutions: objective, duration, error, limits, proof, motion and settings.

    Two folders of studies are compared case by case: plans that were lost, are unproved, longer, costlier or slower.
    The exit code is 4 where one was lost or is unproved, else 1 where one became worse.
    """
    if first.is_dir() and second.is_dir():
        _compare_studies(first, second, as_json)
        return
    from robotraj._util.printing import table
    from robotraj.cli.comparison import compared
    from robotraj.solution.storage.load import load_solution

    rows = compared(load_solution(first), load_solution(second))
    if as_json:
        say_json({"first": str(first), "second": str(second), "measures": [_described(row) for row in rows]})
        return
    shown = rows if everything else [row for row in rows if not row.equal]
    if not shown:
        say(f"{first} and {second} are equal in all {len(rows)} measures")
        return
    heads = ("", first.stem, second.stem, "difference")
    say("\n".join(table([heads, *(_cells(row) for row in shown)])))
    if len(shown) < len(rows):
        say(f"{len(rows) - len(shown)} measures are equal")


def _compare_studies(first: Path, second: Path, as_json: bool) -> None:
    from robotraj.applications.studies.study import Study

    found = Study(second).regressions(Study(first))
    if as_json:
        worse = [
            {"case": dict(each.case), "became": each.kind, "before": each.before, "after": each.after}
            for each in found.found
        ]
        say_json({"first": str(first), "second": str(second), "compared": found.compared, "regressions": worse})
    else:
        say(str(found))
    if found:
        raise typer.Exit(ExitCode.NOT_PROVED if found.unsafe else ExitCode.ERROR)


def _cells(row: Compared) -> tuple[str, str, str, str]:
    name = f"{row.name} [{row.unit}]" if row.unit else row.name
    change = "" if row.difference is None else f"{row.difference:+.3g}"
    if row.relative is not None:
        change += f" ({row.relative:+.2%})"
    return name, _written(row.first), _written(row.second), change


def _written(value: float | str | None) -> str:
    return "-" if value is None else value if isinstance(value, str) else f"{value:.8g}"


def _described(row: Compared) -> dict[str, object]:
    return {
        "name": row.name,
        "unit": row.unit,
        "first": row.first,
        "second": row.second,
        "difference": row.difference,
        "equal": row.equal,
    }
