"""Disks that are full, and calls of the operating system that fail, for the tests of all that writes files."""

from __future__ import annotations

import errno
import io
import os
import resource
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

import robotraj as rt


@contextmanager
def full_disk() -> Iterator[None]:
    """Let no file grow above 4 kB."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


CALLS = (
    (os, "mkdir"),
    (os, "open"),
    (io, "open"),
    (os, "chmod"),
    (os, "fsync"),
    (os, "replace"),
    (os, "rmdir"),
    (os, "stat"),
    (os, "unlink"),
)


def _concerns(arguments: tuple[Any, ...], folder: Path) -> bool:
    """Whether a call names a file of the folder, by its path or by an open file."""
    first = arguments[0]
    if isinstance(first, int):
        with_name = Path(f"/proc/self/fd/{first}")
        return with_name.exists() and folder in with_name.resolve().parents
    return str(first).startswith(str(folder))


def fail_in_turn(
    call: tuple[Any, str],
    folder: Path,
    write: Callable[[], object],
    prepared: Callable[[], object],
    judged: Callable[[rt.InputError | None], object],
) -> None:
    """Let each call of a function on a file of the folder fail once, from the first to the last.

    Parameters
    ----------
    call : (module, str)
        One of ``CALLS``.
    write : callable
        Writes files in the folder. It may raise nothing but an InputError.
    prepared, judged : callable
        Called before each attempt, and after it with its error.
    """
    module, function = call
    real, count, number = getattr(module, function), 0, -1
    while count > number:
        number += 1
        assert number < 60, "the calls do not end"
        prepared()
        count = 0

        def failing(*arguments: Any, failed: int = number + 1, **options: Any) -> Any:
            nonlocal count
            if _concerns(arguments, folder):
                count += 1
                if count == failed:
                    raise OSError(errno.EIO, os.strerror(errno.EIO), str(arguments[0]))
            return real(*arguments, **options)

        error: rt.InputError | None = None
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(module, function, failing)
            try:
                write()
            except rt.InputError as refused:
                error = refused
        judged(error)
