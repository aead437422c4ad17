"""TOML files: their text and data, and errors that name file, line and key."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from robotraj._util.errors import InputError
from robotraj._util.paths import input_path
from robotraj._util.system.regular_files import contents
from robotraj._util.values import dataclass
from robotraj.applications.problem_files.bounds import MOST_BYTES, check_bounds, check_keys
from robotraj.applications.problem_files.lines import Data, Misplaced, line_of, lines_of, named

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

_PLACE = re.compile(r" \(at line (\d+), column \d+\)")
_REPEATED = "A key is stated twice"
_WIDEST = 80
"""Characters of a line that a message shows."""


@dataclass(frozen=True, eq=False)
class TomlFile:
    """A TOML file that was read.

    Attributes
    ----------
    source : Path
    text : str
    data : dict
    """

    source: Path
    text: str
    data: dict[str, Data]

    @contextmanager
    def placed(self) -> Iterator[None]:
        """Turn a ``Misplaced`` of the block into an InputError that names file, line and key."""
        try:
            yield
        except Misplaced as error:
            line = line_of(error.place, lines_of(self.text))
            where = [self.source.name, f"line {line}" if line else "", named(error.place)]
            raise InputError(f"{', '.join(part for part in where if part)}: {error}") from error


def read_toml(path: str | os.PathLike[str], what: str) -> TomlFile:
    """Read a file that ``what`` names in messages.

    Raises
    ------
    InputError
        There is no such file, it is too large, no UTF-8 text or no TOML.
    """
    source = input_path(path, what).absolute()
    content = contents(source, MOST_BYTES, what)
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        number = 1 + content[: error.start].count(b"\n")
        raise InputError(f"{source.name}, line {number}: this is no UTF-8 text; save the file as UTF-8.") from error
    text = text.replace("\r\n", "\n")
    check_keys(text, source.name)
    try:
        data = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # numbers of thousands of digits are ValueErrors
        found = _PLACE.search(str(error))
        at, line = (f", line {found[1]}", text.splitlines()[int(found[1]) - 1 :][:1]) if found else ("", [])
        shown = f" in {line[0].strip()[:_WIDEST]!r}" if line else ""
        reason = _REPEATED if "overwrite" in str(error) else _PLACE.sub("", str(error))
        raise InputError(f"{source.name}{at}: this is no TOML: {reason}{shown}.{_advice(line)}") from error
    check_bounds(data, source.name)
    return TomlFile(source, text, data)


def _advice(line: list[str]) -> str:
    """Return what TOML does not allow and other languages do, for the line of an error."""
    text = line[0] if line else ""
    if re.search(r"\b(True|False|None)\b", text):
        return ' TOML writes true and false in small letters; None is "none" in a problem file.'
    if text.count("{") > text.count("}"):
        return " A table in braces stands in one line."
    return ""
