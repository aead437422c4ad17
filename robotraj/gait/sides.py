"""Left and right by name: which joint or frame is the other side's."""

from __future__ import annotations

import re
from collections.abc import Iterable

PAIRS = (
    ("left", "right"),
    ("l", "r"),
    ("lf", "rf"),
    ("lh", "rh"),
    ("lb", "rb"),
    ("fl", "fr"),
    ("hl", "hr"),
    ("rl", "rr"),
    ("bl", "br"),
)
"""Words that change into each other, in lower case; ``l`` and the two-letter ones also in upper case."""

WORDS = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[0-9]+")
"""Words of a name such as ``leg_left_1_joint``, ``FL_HAA``, ``LThighPitch`` or ``RFAnkle``."""


def other_side(name: str, names: Iterable[str]) -> str:
    """Name among ``names`` that differs from ``name`` by one left or right; ``name`` itself where there is none.

    ``left_hip`` and ``right_hip``, ``l_knee`` and ``r_knee``, ``FL_HAA`` and ``FR_HAA``, ``leg_left_1_joint`` ...
    """
    known = set(names)
    for match in WORDS.finditer(name):
        word = match.group()
        for first, second in (*PAIRS, *((b, a) for a, b in PAIRS)):
            for found, swapped in _variants(word, first, second):
                other = name[: match.start()] + swapped + name[match.start() + len(found) :]
                if other in known and other != name:
                    return other
    return name


def _variants(word: str, first: str, second: str) -> list[tuple[str, str]]:
    """Beginnings of a word that are ``first`` in some spelling, with ``second`` in the same."""
    forms = [(f(first), f(second)) for f in (str.lower, str.upper, str.capitalize)]
    whole = [(a, b) for a, b in forms if word == a]
    # LThigh is one letter before a capital: WORDS gives "LT" or "LThigh" there.
    prefix = [(a, b) for a, b in forms if len(a) < 3 and a.isupper() and word.startswith(a)]
    return whole or prefix
