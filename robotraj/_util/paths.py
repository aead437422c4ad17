"""Paths of files to be written, checked before the work whose result they take."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from robotraj._util.errors import InputError


def output_path(path: str | os.PathLike[str], suffixes: Sequence[str], who: str) -> Path:
    """Give the absolute path of a file that can be written.

    Parameters
    ----------
    path : path
        An older file may stand there.
    suffixes : sequence of str
        Those that are allowed, in lower case; ``()`` allows all.
    who : str
        The function or option that the path was given to, for messages.

    Raises
    ------
    InputError
        Another suffix, no such directory, one that cannot be written to, or a directory of that name.
    """
    target = Path(path).expanduser().absolute()
    if suffixes and target.suffix.lower() not in suffixes:
        raise InputError(f"{who} is {str(path)!r}; let it end in {' or '.join(suffixes)}.")
    if not target.parent.is_dir():
        raise InputError(f"{who} is {str(path)!r}, but the directory {str(target.parent)!r} does not exist; create it.")
    if target.is_dir():
        raise InputError(f"{who} is {str(path)!r}, which is a directory; name a file.")
    if not os.access(target if target.exists() else target.parent, os.W_OK):
        raise InputError(f"{who} is {str(path)!r}, which cannot be written; choose another place or its permissions.")
    return target
