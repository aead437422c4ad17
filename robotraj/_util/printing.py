"""Values as text: as constructor calls, on one short line, and as tables."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from textwrap import wrap

import numpy as np

WIDTH = 80
"""Largest number of columns of printed text."""

ENTRIES = 3
"""Largest number of entries of a sequence or array that are printed one by one."""

TEXT = 32
"""Largest number of characters of a nested text."""


DIGITS = 30
"""Integers of more digits are not written out."""


class OneLine:
    """Base of classes whose ``repr`` is ``one_line``, unless they or a base class define another."""

    def __init_subclass__(cls, **arguments: object) -> None:
        super().__init_subclass__(**arguments)
        # The standard dataclass writes a ``__repr__`` into each class whose body has none.
        setattr(cls, "__repr__", cls.__repr__)  # noqa: B010

    def __repr__(self) -> str:
        return one_line(self)


def as_call(value: object) -> str:
    """Print a value with the fields that differ from their defaults: ``BernsteinBounds(controls=True)``.

    A dataclass that defines ``__str__`` prints by that. Values that are not dataclasses print by ``repr``.
    """
    if isinstance(value, tuple | list):
        return f"({', '.join(map(as_call, value))}{',' if len(value) == 1 else ''})"
    if not is_dataclass(value) or isinstance(value, type):
        return repr(value)
    if type(value).__str__ is not object.__str__:
        return str(value)
    return f"{type(value).__name__}({', '.join(f'{name}={as_call(given)}' for name, given in changed_fields(value))})"


def changed_fields(value: object) -> list[tuple[str, object]]:
    """List the printed fields of a dataclass whose values differ from the defaults."""
    found = []
    for entry in fields(value) if is_dataclass(value) else ():
        given = getattr(value, entry.name, None)
        default = entry.default if entry.default_factory is MISSING else entry.default_factory()
        if entry.repr and not _same(given, default):
            found.append((entry.name, given))
    return found


def one_line(value: object) -> str:
    """Print a dataclass on one line of at most 80 characters: its class and the fields that differ from the defaults.

    Large arrays print as their shapes, long sequences as their lengths. Fields that do not fit are replaced by ``...``.
    """
    name, given = type(value).__name__, changed_fields(value)
    full = {field: f"{field}={brief(entry)}" for field, entry in given}
    short = {field: f"{field}={_kind(entry)}" for field, entry in given}
    while len(_joined(name, full)) > WIDTH and any(len(full[field]) > len(short[field]) for field in full):
        longest = max(full, key=lambda field: len(full[field]) - len(short[field]))
        full[longest] = short[longest]
    if len(_joined(name, full)) <= WIDTH:
        return _joined(name, full)
    while len(_joined(name, full | {"": "..."})) > WIDTH:
        full.popitem()
    return _joined(name, full | {"": "..."})


def short(value: object) -> str:
    """Print a value by ``repr``; integers of thousands of digits are not written out."""
    if isinstance(value, int | np.integer) and abs(value) >= 10**DIGITS:
        return f"an integer of more than {DIGITS} digits"
    return repr(value)


def brief(value: object) -> str:
    """Print a value in a few words: numbers with six digits, arrays by shape, functions by name."""
    if isinstance(value, bool | np.bool_ | Enum | type | None):
        return value.__name__ if isinstance(value, type) else str(value)
    if isinstance(value, float | np.floating):
        text = repr(float(value))
        return text if len(text) <= 8 else f"{float(value):.6g}"
    if isinstance(value, int):
        return short(value)
    if isinstance(value, str):
        return repr(value if len(value) <= TEXT else value[: TEXT - 3] + "...")
    if isinstance(value, np.ndarray):
        few = value.ndim == 1 and value.size <= ENTRIES
        return f"[{', '.join(map(brief, value.tolist()))}]" if few else f"array{value.shape}".replace(",)", ")")
    if isinstance(value, tuple | list):
        return _sequence(value)
    if isinstance(value, Mapping) and type(value).__repr__ is dict.__repr__:
        entries = [f"{brief(key)}: {brief(entry)}" for key, entry in value.items()]
        return f"{{{', '.join(entries)}}}" if len(entries) <= ENTRIES else f"{{{len(entries)} entries}}"
    if callable(value) and hasattr(value, "__qualname__"):
        return re.sub(r".*<locals>\.", "", value.__qualname__)
    text = re.sub(r"<([\w.]+) object at 0x[0-9a-f]+>", r"\1", repr(value))
    return text if len(text) <= WIDTH and "\n" not in text else _kind(value)


NARROWEST = 8
"""Least width of a column that is wrapped."""


def plain(text: str) -> str:
    """Return a text in which letters that control a terminal, or the direction of others, are written as escapes.

    Words of more than 2,000 letters are cut.
    """
    text = re.sub(r"(\S{1000})\S{1000,}", r"\1...", text)
    if text.isprintable():
        return text
    return "".join(each if each.isprintable() or each in "\n\t" else repr(each)[1:-1] for each in text)


def _longest_word(text: str) -> int:
    return max(map(len, text.split()), default=0)


def table(rows: Iterable[Sequence[str]], width: int = WIDTH) -> list[str]:
    """Align the cells of rows in columns two blanks apart; the widest cells are wrapped where a line exceeds ``width``.

    Cells are wrapped at blanks where that suffices. Else long words are broken, those of the first row last.

    Returns
    -------
    list of str
        Lines of at most ``width`` characters, as long as ``width`` holds eight characters a column.
    """
    cells = [[str(cell) for cell in row] for row in rows]
    if not cells:
        return []
    columns = list(zip(*cells, strict=True))
    widths = [max(map(len, column)) for column in columns]
    words = [max(_longest_word(cell) for cell in column) for column in columns]
    headings = [max(NARROWEST, _longest_word(column[0])) for column in columns]
    for least in (words, headings, [NARROWEST] * len(columns)):
        while sum(widths) + 2 * (len(widths) - 1) > width:
            wide = [(size, -i) for i, size in enumerate(widths) if size > max(least[i], NARROWEST)]
            if not wide:
                break
            widths[-max(wide)[1]] -= 1
    lines = []
    for row in cells:
        wrapped = [wrap(cell, max(size, 1)) or [""] for cell, size in zip(row, widths, strict=True)]
        for i in range(max(map(len, wrapped))):
            parts = [cell[i] if i < len(cell) else "" for cell in wrapped]
            lines.append("  ".join(part.ljust(size) for part, size in zip(parts, widths, strict=True)).rstrip())
    return lines


def wrapped(text: str, indent: str = "") -> list[str]:
    """Wrap a paragraph at 80 columns; all lines but the first are indented by two more blanks."""
    return wrap(
        text,
        WIDTH,
        initial_indent=indent,
        subsequent_indent=indent + "  ",
        break_long_words=False,
        break_on_hyphens=False,
    ) or [indent]


def _joined(name: str, parts: Mapping[str, str]) -> str:
    return f"{name}({', '.join(parts.values())})"


def _same(given: object, default: object) -> bool:
    if given is default:
        return True
    if type(given) is not type(default) or isinstance(given, np.ndarray):
        return False
    try:
        return bool(given == default)
    except (TypeError, ValueError):
        # Mappings and sequences of arrays have no single truth value.
        return False


def _sequence(value: Sequence[object]) -> str:
    left, right = "[]" if isinstance(value, list) else "()"
    if len(value) > ENTRIES:
        return f"{left}{len(value)} entries{right}"
    return f"{left}{', '.join(map(brief, value))}{',' if len(value) == 1 and left == '(' else ''}{right}"


def _kind(value: object) -> str:
    """Print a dataclass or an unknown value by its class alone, others as ``brief`` does."""
    if isinstance(value, tuple | list) and len(value) > 1:
        return f"{'[' if isinstance(value, list) else '('}{len(value)} entries{']' if isinstance(value, list) else ')'}"
    if isinstance(value, tuple | list) and value:
        return f"[{_kind(value[0])}]" if isinstance(value, list) else f"({_kind(value[0])},)"
    if isinstance(value, Mapping):
        return f"{{{len(value)} entries}}"
    plain = isinstance(value, bool | int | float | str | Enum | type | np.generic | np.ndarray | None)
    if plain or (callable(value) and hasattr(value, "__qualname__")):
        return brief(value)
    name = getattr(value, "name", None)
    return f"{type(value).__name__}({name!r})" if isinstance(name, str) and len(name) <= TEXT else type(value).__name__
