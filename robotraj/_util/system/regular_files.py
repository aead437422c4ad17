"""Contents of files that other files name: regular ones alone, of bounded size.

Opening a pipe may never return, and a device may never end. Files of ``/proc`` have no size and are read as empty.
"""

from __future__ import annotations

import os
import stat
from difflib import get_close_matches
from itertools import islice
from pathlib import Path

from robotraj._util.errors import InputError

_FLAGS = os.O_RDONLY | os.O_CLOEXEC | os.O_NOCTTY | os.O_NONBLOCK
_MOST_NAMES = 10_000
"""Largest number of names in a folder that are compared."""


def contents(path: str | os.PathLike[str], most: int, what: str = "The file") -> bytes:
    """Return the bytes of a regular file.

    Parameters
    ----------
    path : path
    most : int
        Largest size [bytes].
    what : str
        Name of the file's role, for messages.

    Raises
    ------
    InputError
        There is no such file, it cannot be read, it is a device, pipe or folder, or it is larger.
    """
    named = f"{what} {os.fspath(path)!r}"
    try:
        with open(os.open(path, _FLAGS), "rb") as file:
            found = os.fstat(file.fileno())
            if not stat.S_ISREG(found.st_mode):
                raise InputError(f"{named} is no regular file.")
            if found.st_size > most:
                raise InputError(f"{named} has {found.st_size / 1e6:.1f} MB, above {most / 1e6:.1f} MB.")
            return file.read(found.st_size)
    except InputError:
        raise
    except FileNotFoundError as error:
        raise InputError(f"{named} does not exist.{near_files(path)}") from error
    except (OSError, ValueError) as error:  # a ValueError is a path with a null character
        raise InputError(f"{named} cannot be read: {getattr(error, 'strerror', None) or error}.") from error


def near_files(path: str | os.PathLike[str]) -> str:
    """Return a sentence, after a space, on a path that is no file: what it is, or a near name; empty without one."""
    missing = Path(path)
    if os.path.exists(missing):
        return " It is a folder." if os.path.isdir(missing) else " It is no regular file."
    try:
        if not missing.parent.is_dir():
            return f" Neither does the folder {str(missing.parent)!r}."
        names = [each.name for each in islice(missing.parent.iterdir(), _MOST_NAMES)]
    except (OSError, ValueError):
        return ""
    near = get_close_matches(missing.name, names, n=2)
    return f" Did you mean {' or '.join(map(repr, near))}?" if near else ""
