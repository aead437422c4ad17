"""``robotraj compare``: two saved solutions side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

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
    """Print the differences of two saved solutions: objective, duration, error, limits, proof, motion and settings."""
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
