"""Files that are written whole: after any failure, the old file or the new one is there."""

from __future__ import annotations

import errno
import os
import shutil
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from robotraj._util.errors import InputError

_ADVICE = {
    errno.ENOSPC: "free space or choose another place",
    errno.EDQUOT: "free space or choose another place",
    errno.EFBIG: "a limit of the size of files is set; raise it or choose another place",
    errno.EROFS: "the file system is read-only; choose another place",
    errno.EACCES: "change the permissions of its folder or choose another place",
    errno.EPERM: "change the permissions of its folder or choose another place",
    errno.ENAMETOOLONG: "choose a shorter name",
    errno.ENOENT: "its folder does not exist; create it",
}


@contextmanager
def whole_file(target: Path) -> Iterator[Path]:
    """Yield a path to write to; the file takes its place at ``target`` once it is complete and on the disk.

    An older file at ``target`` stays unchanged until then, and the new one has its permissions. A symbolic link stays
    one; the file that it names is replaced. The path lies in a folder that only its owner can open, so nobody else can
    have put a link there. If writing fails, nothing is left of it.

    Raises
    ------
    InputError
        The operating system refuses to write, as on a full disk, or ``target`` is a device or pipe.
    """
    folder: str | None = None
    try:
        place = target.resolve() if target.is_symlink() else target
        older = place.stat() if place.exists() else None
        if older is not None and not stat.S_ISREG(older.st_mode):
            raise InputError(f"{str(target)!r} is no regular file; choose another name.")
        folder = tempfile.mkdtemp(prefix=".robotraj-", dir=place.parent)
        partial = Path(folder) / "partial"
        yield partial
        if older is not None:
            partial.chmod(stat.S_IMODE(older.st_mode))
        _to_disk(partial)
        os.replace(partial, place)
        _to_disk(place.parent)
    except OSError as error:
        advice = _ADVICE.get(error.errno or 0, "choose another place")
        raise InputError(
            f"{str(target)!r} could not be written: {error.strerror or error}. Nothing of it was kept; {advice}."
        ) from error
    finally:
        if folder is not None:
            shutil.rmtree(folder, ignore_errors=True)


def _to_disk(path: Path) -> None:
    """Wait until a file, or the names in a folder, are on the disk."""
    number = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
    try:
        os.fsync(number)
    except OSError as error:
        # Some file systems cannot synchronise folders.
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):
            raise
    finally:
        os.close(number)
