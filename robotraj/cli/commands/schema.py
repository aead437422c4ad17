"""``robotraj schema``: what problem files may state."""

from __future__ import annotations

from typing import Annotated

import typer

from robotraj.cli.options import JsonOption
from robotraj.cli.terminal import say, say_json


def _complete(incomplete: str) -> list[tuple[str, str]]:
    from robotraj.applications.problem_files.schema import entries

    known = [entry for group in entries().values() for entry in group]
    return [(entry.name, entry.summary) for entry in known if entry.name.startswith(incomplete)]


def print_schema(
    name: Annotated[
        str | None,
        typer.Argument(metavar="[NAME]", autocompletion=_complete, help="A table or type, such as GroundClearance."),
    ] = None,
    as_markdown: Annotated[bool, typer.Option("--markdown", help="Print all of it as Markdown.")] = False,
    as_json: JsonOption = False,
) -> None:
    """Show the tables and types of problem files, or the keys of one of them.

    Example: robotraj schema GroundClearance
    """
    from robotraj._util.printing import table, wrapped
    from robotraj.applications.problem_files.schema import SchemaEntry, entries, entry_named, reference

    if as_markdown:
        say(reference())
        return
    groups = {"": [entry_named(name)]} if name is not None else entries()

    def plain(entry: SchemaEntry) -> dict[str, object]:
        keys = [{"key": key, "takes": takes, "default": default} for key, takes, default in entry.rows()]
        return {"name": entry.name, "summary": entry.summary, "keys": keys}

    if as_json:
        say_json({title or "entry": [plain(entry) for entry in group] for title, group in groups.items()})
        return
    if name is None:
        for title, group in groups.items():
            say("\n".join(wrapped(f"{title}: {', '.join(entry.name for entry in group)}")))
        say("\nrobotraj schema NAME prints the keys of one of these; docs/problem-files.md explains files")
        return
    entry = groups[""][0]
    say("\n".join(wrapped(f"{entry.name}: {entry.summary}")))
    say("\n".join(table([("key", "takes", "default"), *entry.rows()])))
