"""``robotraj demo``: plan a built-in problem, prove it, write its replay."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from robotraj.cli.demos.table import DEFAULT, DEMOS, demo_named
from robotraj.cli.options import HtmlOption, PlotOption, RowsOption, SaveOption
from robotraj.cli.terminal import say, say_rows, say_table


def _complete(incomplete: str) -> list[tuple[str, str]]:
    return [(entry.name, entry.shows) for entry in DEMOS.values() if entry.name.startswith(incomplete)]


def demo(
    name: Annotated[
        str | None,
        typer.Argument(metavar="[NAME]", autocompletion=_complete, help=f"One of {', '.join(DEMOS)}."),
    ] = None,
    only_list: Annotated[bool, typer.Option("--list", help="List the demos and plan none.")] = False,
    html: HtmlOption = None,
    save: SaveOption = None,
    plot: PlotOption = None,
    rows: RowsOption = False,
) -> None:
    """Plan a built-in demo, prove it and write its replay as HTML into the current directory.

    Without a name, plan the swing-up of the cart-pole.
    """
    entry = demo_named(DEFAULT if name is None else name)
    if only_list:
        heads = ("name", "what it shows", "example")
        known = [(each.name, each.shows, each.example[:2]) for each in DEMOS.values()]
        say_table(f"{len(known)} demos: robotraj demo NAME writes NAME.html", heads, known, "what it shows")
        return
    from robotraj._util.paths import output_path
    from robotraj.cli.conclude import Files, conclude

    target = html or output_path(Path(entry.page), (".html",), "the demo's page")
    say(f"{entry.name}: {entry.shows}\n")
    chosen = entry.make()
    say_rows(chosen.problem, rows)
    solution = chosen.plan()
    if chosen.analysis is not None:
        say(f"{chosen.analysis(solution)}\n")
    conclude(solution, Files(target, save, plot, {"periods": chosen.periods}))
    if name is None:
        say(f"open it in a browser; 'robotraj demo --list' names {len(DEMOS) - 1} more demos")
