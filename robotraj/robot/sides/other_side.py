"""Pairs of left and right joints and frames, by their names."""

from __future__ import annotations

from collections.abc import Iterable

from robotraj._util.names.near_words import WORDS

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
"""Words of the two sides, in lower case; they are also recognised in upper case and capitalised."""


def other_side(name: str, names: Iterable[str]) -> str:
    """Return the name among ``names`` that is ``name`` with left and right swapped; ``name`` itself if there is none.

    Examples: ``left_hip`` and ``right_hip``, ``l_knee`` and ``r_knee``, ``FL_HAA`` and ``FR_HAA``.
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
    """Return pairs of ``first`` and ``second`` in the spellings in which ``first`` begins a word."""
    forms = [(f(first), f(second)) for f in (str.lower, str.upper, str.capitalize)]
    whole = [(a, b) for a, b in forms if word == a]
    # In LThigh, the side is one letter before a capital: WORDS finds "LT" or "LThigh".
    prefix = [(a, b) for a, b in forms if len(a) < 3 and a.isupper() and word.startswith(a)]
    return whole or prefix
