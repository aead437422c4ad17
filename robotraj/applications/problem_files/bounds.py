"""Bounds of a problem file: of its keys before it is read, of the rest before a value is made from it."""

from __future__ import annotations

import re
from collections.abc import Mapping

from robotraj._util.errors import InputError
from robotraj._util.printing import brief
from robotraj.applications.problem_files.lines import Data

MOST_BYTES = 2 * 10**6
MOST_DEPTH = 32
MOST_VALUES = 100_000
MOST_LETTERS = 4_000
"""Largest length of a text or key."""
GREATEST = 10**18
"""Largest whole number."""
MOST_PHASES = 200
MOST_ROBOTS = 50
MOST_INTERVALS = 5_000
"""Largest number of intervals of a phase."""
MOST_USES = 10_000
"""Largest number of times that values of ``[define]`` are used."""


_QUOTED = re.compile(r'"[^"\n]*"|\'[^\'\n]*\'')


def check_keys(text: str, name: str) -> None:
    """Refuse ``a.b.c...`` of too many parts: Python's reader of TOML keeps every beginning of such a key.

    Raises
    ------
    InputError
        Names the line.
    """
    for number, line in enumerate(text.split("\n"), start=1):
        if line.count(".") > MOST_DEPTH:
            keys = re.split(r"[^\w.\- \t]+", _QUOTED.sub("k", line))
            if max(key.count(".") for key in keys) > MOST_DEPTH:
                raise InputError(f"{name}, line {number}: a key has more than {MOST_DEPTH} parts.")


def check_bounds(data: Mapping[str, Data], name: str) -> None:
    """Refuse a file of too many, too deep, too long or impossible values.

    Raises
    ------
    InputError
        Names the first of them.
    """
    waiting: list[tuple[str, object, int]] = [("", data, 0)]
    count = 0
    while waiting:
        place, value, depth = waiting.pop()
        count += 1
        if count > MOST_VALUES:
            raise InputError(f"{name} has more than {MOST_VALUES} values; a problem has fewer.")
        if depth > MOST_DEPTH:
            raise InputError(f"{name}, {brief(place)}: tables and lists are nested more than {MOST_DEPTH} deep.")
        if isinstance(value, Mapping):
            for key in value:
                _check_text(str(key), name, place)
            waiting += [(f"{place}.{key}".lstrip("."), entry, depth + 1) for key, entry in value.items()]
        elif isinstance(value, list):
            waiting += [(place, entry, depth + 1) for entry in value]
        elif isinstance(value, str):
            _check_text(value, name, place)
        elif isinstance(value, int) and abs(value) > GREATEST:
            raise InputError(f"{name}, {place}: a whole number is above {GREATEST:.0e}.")


def _check_text(text: str, name: str, place: str) -> None:
    if len(text) > MOST_LETTERS:
        raise InputError(f"{name}, {place[:100]}: a text has {len(text)} letters, above {MOST_LETTERS}.")
    if not text.isprintable() and any(ord(letter) < 32 and letter not in "\t\n" for letter in text):
        raise InputError(f"{name}, {place[:100]}: a text has control characters.")
