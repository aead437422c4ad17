"""Paths of output files, which are checked before a long computation starts, and of caches."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from threading import get_ident

from robotraj._util.errors import InputError


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
    target = Path(path).expanduser().absolute()
    if suffixes and target.suffix.lower() not in suffixes:
        raise InputError(f"{what} is {str(path)!r}; let it end in {' or '.join(suffixes)}.")
    if not target.parent.is_dir():
        parent = str(target.parent)
        raise InputError(f"{what} is {str(path)!r}, but the directory {parent!r} does not exist; create it.")
    if target.is_dir():
        raise InputError(f"{what} is {str(path)!r}, which is a directory; name a file.")
    if not os.access(target if target.exists() else target.parent, os.W_OK):
        raise InputError(f"{what} is {str(path)!r}, which cannot be written; choose another place or its permissions.")
    return target


def cache_folder(name: str) -> Path:
    """Return a folder of the user's cache: ``$XDG_CACHE_HOME/robotraj/NAME``, or ``~/.cache/robotraj/NAME``."""
    given = Path(os.environ.get("XDG_CACHE_HOME", ""))
    # The XDG specification requires that relative paths are ignored.
    base = given if given.is_absolute() else Path.home() / ".cache"
    return base / "robotraj" / name


@contextmanager
def whole_file(target: Path) -> Iterator[Path]:
    """Yield a path to write to; the file takes its place at ``target`` once it is complete.

    An older file at ``target`` stays unchanged until then. If writing fails, the partial file is deleted.

    Raises
    ------
    InputError
        The operating system refuses to write, as on a full disk.
    """
    partial = target.with_name(f".{target.name}.{os.getpid()}.{get_ident()}.part")
    try:
        yield partial
        partial.replace(target)
    except OSError as error:
        raise InputError(
            f"{str(target)!r} could not be written: {error.strerror or error}. Nothing of it was kept; free space or "
            "choose another place."
        ) from error
    finally:
        partial.unlink(missing_ok=True)
