"""Paths of output files, which are checked before a long computation starts, and of caches."""

from __future__ import annotations

import errno
import os
from collections.abc import Sequence
from pathlib import Path

from robotraj._util.errors import InputError
from robotraj._util.printing import brief

LONGEST = 255
"""Largest length of the name of a file [bytes]."""

NO_PATHS = (errno.ENAMETOOLONG, errno.ELOOP, errno.EILSEQ, errno.EINVAL)
"""Refusals of the operating system that concern the path; others are faults of a disk, or lacking permissions."""


def input_path(path: object, what: str) -> Path:
    """Return the path of a file or folder that is read, with the user's home in place of ``~``; it may not exist.

    Parameters
    ----------
    path : path
    what : str
        The role of the file, for messages.

    Raises
    ------
    InputError
        It is no path, or none that a file can have: too long, with a null character, a loop of links. A disk fails.
    """
    try:
        found = Path(path).expanduser()  # type: ignore[arg-type]
        os.fsencode(found.resolve())
        found.exists()
    except (TypeError, ValueError, OSError, RuntimeError) as error:
        raise _refused(path, what, error, "read") from error
    return found


def output_path(path: str | os.PathLike[str], suffixes: Sequence[str], what: str) -> Path:
    """Return the absolute path of a file that can be written.

    Parameters
    ----------
    path : path
        Path of the file; an existing file is replaced.
    suffixes : sequence of str
        Allowed suffixes in lower case; ``()`` allows all.
    what : str
        The function or option of the path, for messages.

    Raises
    ------
    InputError
        Another suffix, no such directory, one that cannot be written to, or a directory of that name.
    """
    try:
        target = Path(path).expanduser().absolute()
        name = os.fsencode(target.name)
        if b"\0" in name:
            raise ValueError("it holds a null character")
        if suffixes and target.suffix.lower() not in suffixes:
            raise InputError(f"{what} is {str(path)!r}; let it end in {' or '.join(suffixes)}.")
        if len(name) > LONGEST:
            raise InputError(f"{what} has a name of {len(name)} bytes, above {LONGEST}; choose a shorter name.")
        if not target.parent.is_dir():
            parent = str(target.parent)
            raise InputError(f"{what} is {str(path)!r}, but the directory {parent!r} does not exist; create it.")
        if target.is_dir():
            raise InputError(f"{what} is {str(path)!r}, which is a directory; name a file.")
        if not os.access(target if target.exists() else target.parent, os.W_OK):
            raise InputError(f"{what} is {str(path)!r}, which cannot be written; choose another place or permissions.")
    except (OSError, ValueError, RuntimeError) as error:
        if isinstance(error, InputError):
            raise
        raise _refused(path, what, error, "written") from error
    return target


def _refused(path: object, what: str, error: Exception, done: str) -> InputError:
    reason = (error.strerror if isinstance(error, OSError) else None) or str(error)
    given = str(path) if isinstance(path, os.PathLike) else path
    if isinstance(error, OSError) and error.errno not in NO_PATHS:
        return InputError(f"{what} is {given!r}, which cannot be {done}: {reason[:100]}.")
    return InputError(f"{what} is {brief(given)}, which is no path of a file: {reason[:100]}.")


def cache_folder(name: str) -> Path:
    """Return a folder of the user's cache: ``$XDG_CACHE_HOME/robotraj/NAME``, or ``~/.cache/robotraj/NAME``."""
    given = Path(os.environ.get("XDG_CACHE_HOME", ""))
    # The XDG specification requires that relative paths are ignored.
    base = given if given.is_absolute() else Path.home() / ".cache"
    return base / "robotraj" / name
