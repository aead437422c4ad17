"""``robotraj robots``: the robots that can be loaded by name."""

from __future__ import annotations

from typing import Annotated

import typer

from robotraj._util.errors import InputError
from robotraj.cli.terminal import say_table


def robots(
    search: Annotated[str, typer.Argument(help="Only robots whose name or description contains this.")] = "",
) -> None:
    """List the robots that can be loaded by name."""
    from robotraj.robot.known_robots.catalogue import catalogue

    wanted = search.lower()
    entries = [e for e in catalogue() if wanted in f"{e.name} {e.description}".lower()]
    if not entries:
        raise InputError(f"No robot's name or description contains {search!r}; 'robotraj robots' lists them all.")
    rows = [(entry.name, entry.description, entry.source) for entry in entries]
    say_table(f"{len(entries)} robots", ("name", "what it is", "source"), rows, "what it is")
