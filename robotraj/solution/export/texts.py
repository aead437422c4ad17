"""Names of joints, frames and variables in files of other programs, whatever letters they have."""

from __future__ import annotations

FORMULAS = ("=", "+", "-", "@", "\t", "\r")
"""First letters at which a spreadsheet takes a cell for a formula, which may start programs."""


def cell(text: str) -> str:
    """Return the text of a cell of a CSV file; an apostrophe keeps a spreadsheet from computing it."""
    safe = text.encode("utf-8", "backslashreplace").decode("utf-8")
    return f"'{safe}" if safe.lstrip(" ").startswith(FORMULAS) else safe


def yaml_text(text: str) -> str:
    """Return a double-quoted text of YAML that reads back as the same text.

    JSON's own escapes write letters beyond U+FFFF as two, which YAML does not join.
    """
    letters = (
        f"\\{letter}" if letter in '"\\' else letter if letter.isprintable() else f"\\U{ord(letter):08x}"
        for letter in text
    )
    return f'"{"".join(letters)}"'
