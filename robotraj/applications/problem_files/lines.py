"""Lines of the keys of a TOML text, which the standard library's reader does not return."""

from __future__ import annotations

import re
from typing import Any, TypeAlias

from robotraj._util.errors import InputError

Data: TypeAlias = Any
"""A value as ``tomllib`` reads it; its readers check it."""

KeyPath = tuple[str | int, ...]
"""Keys and indices that lead to a value: ``("phases", 0, "end", "q")``."""

_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_STRING = re.compile(
    r'"""(?:\\.|[^\\])*?"""(?:"{0,2})|\'\'\'.*?\'\'\'(?:\'{0,2})|"(?:\\.|[^"\\\n])*"|\'[^\'\n]*\'', re.DOTALL
)
_KEY = re.compile(r"[ \t]*(?:\"((?:\\.|[^\"\\\n])*)\"|'([^'\n]*)'|([A-Za-z0-9_-]+))[ \t]*")
_PLAIN = re.compile(r"[^,\]}#\n]*")


def lines_of(text: str) -> dict[KeyPath, int]:
    """Return the line of every key and of every entry of a list.

    Parameters
    ----------
    text : str
        Text that ``tomllib`` reads without an error; others have lines up to the error.
    """
    return _Scanner(text).lines


def named(place: KeyPath) -> str:
    """Return a place as it is written in messages, ``phases[0].end.q``."""
    text = ""
    for part in place:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def line_of(place: KeyPath, lines: dict[KeyPath, int]) -> int | None:
    """Return the line of a place, or of the nearest value around it; None for the whole text."""
    for length in range(len(place), 0, -1):
        if place[:length] in lines:
            return lines[place[:length]]
    return None


class Misplaced(InputError):
    """An invalid value of a file.

    Attributes
    ----------
    place : KeyPath
    """

    def __init__(self, place: KeyPath, message: str) -> None:
        super().__init__(message)
        self.place = place


class _Scanner:
    """Walks through a text once; the grammar is that of TOML 1.0, without its checks."""

    def __init__(self, text: str) -> None:
        self.text, self.at = text, 0
        self.lines: dict[KeyPath, int] = {}
        self._counts: dict[KeyPath, int] = {}
        self._counted_to, self._line = 0, 1
        table: KeyPath = ()
        while self._skip():
            if self._take("[["):
                table = self._header(several=True)
            elif self._take("["):
                table = self._header(several=False)
            elif not self._pair(table):
                return

    def _skip(self) -> bool:
        """Pass blanks and comments; whether text is left."""
        found = _BLANK.match(self.text, self.at)
        self.at = found.end() if found else self.at
        return self.at < len(self.text)

    def _take(self, mark: str) -> bool:
        if not self.text.startswith(mark, self.at):
            return False
        self.at += len(mark)
        return True

    def _note(self, place: KeyPath) -> None:
        self._line += self.text.count("\n", self._counted_to, self.at)
        self._counted_to = self.at
        self.lines.setdefault(place, self._line)

    def _keys(self) -> list[str]:
        """Read a dotted key."""
        keys: list[str] = []
        while found := _KEY.match(self.text, self.at):
            keys.append(next(part for part in found.groups() if part is not None))
            self.at = found.end()
            if not self._take("."):
                break
        return keys

    def _header(self, several: bool) -> KeyPath:
        place: KeyPath = ()
        keys = self._keys()
        for number, key in enumerate(keys):
            place = (*place, key)
            self._note(place)
            if several and number == len(keys) - 1:
                self._counts[place] = self._counts.get(place, 0) + 1
            if place in self._counts:
                place = (*place, self._counts[place] - 1)
                self._note(place)
        self._take("]]" if several else "]")
        return place

    def _pair(self, table: KeyPath) -> bool:
        keys = self._keys()
        for length in range(1, len(keys) + 1):
            self._note((*table, *keys[:length]))
        if not keys or not self._take("="):
            return False
        self._value((*table, *keys))
        return True

    def _value(self, place: KeyPath) -> None:
        self._skip()
        if found := _STRING.match(self.text, self.at):
            self.at = found.end()
        elif self._take("["):
            for number in range(len(self.text)):
                if not self._skip() or self._take("]"):
                    return
                self._note((*place, number))
                self._value((*place, number))
                self._skip()
                self._take(",")
        elif self._take("{"):
            while self._skip() and not self._take("}"):
                if not self._pair(place):
                    return
                self._skip()
                self._take(",")
        elif found := _PLAIN.match(self.text, self.at):
            self.at = found.end()
