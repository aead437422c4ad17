"""Public calls that take an argument which another call was given."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from inspect import Parameter, isroutine, signature
from types import ModuleType

from robotraj._util.names.near_words import same_meaning

MOST = 4
"""Calls that a message names."""


def elsewhere(argument: str) -> str:
    """Return a sentence that names the public calls with an argument of that name, those of the top level first.

    Arguments of the same meaning are named where none has the name. Empty where there are none of these, too.
    """
    package = sys.modules[__name__.partition(".")[0]]
    # First of all: a public function is called by the name under which it is first read.
    top = list(_calls("rt", package))
    rooms = [(f"rt.{name}", vars(package).get(name)) for name in package.__all__ if name.islower()]
    further = [pair for name, room in rooms if isinstance(room, ModuleType) for pair in _calls(name, room)]
    # A function that the top level offers is no argument that the user looks for.
    meant = same_meaning(argument) - set(package.__all__)
    for words in ({argument}, meant):
        for calls in (top, further):
            found: dict[str, list[str]] = {}
            for name, names in calls:
                for word in words.intersection(names):
                    found.setdefault(word, []).append(name)
            if found:
                return " ".join(
                    f"{' and '.join(who[:MOST])} take{'s' * (len(who) == 1)} {word}=."
                    for word, who in sorted(found.items())
                )
    return ""


def _calls(prefix: str, package: ModuleType) -> Iterator[tuple[str, list[str]]]:
    """Return the public functions and classes of a package with the names of their arguments."""
    for name in getattr(package, "__all__", ()):
        call = getattr(package, name)
        if not (isinstance(call, type) or isroutine(call)) or (isinstance(call, type) and issubclass(call, Exception)):
            continue
        named = (Parameter.KEYWORD_ONLY, Parameter.POSITIONAL_OR_KEYWORD, Parameter.VAR_POSITIONAL)
        yield f"{prefix}.{name}", [each.name for each in signature(call).parameters.values() if each.kind in named]
