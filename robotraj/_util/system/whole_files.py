"""Files, and folders of files, that are written whole: after any failure, the old one or the new one is there."""

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
from robotraj._util.system.interrupts import HeldBack

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


class WholeFile:
    """A path to write to; the file takes its place at ``target`` once it is complete and on the disk.

    With ``folder`` it is a folder, which takes the place of an empty one or of none. An older file at
    ``target`` stays unchanged until then, and the new one has its permissions. A symbolic link stays one; the file that
    it names is replaced. The path lies in a folder that only its owner can open, so nobody else can have put a link
    there. If writing fails or is interrupted, nothing is left of it: a press of Ctrl-C stops the block, and waits while
    the folder is made, moved or removed.

    Raises
    ------
    InputError
        The operating system refuses to write, as on a full disk, or ``target`` is a device or pipe.
    """

    def __init__(self, target: Path, folder: bool = False) -> None:
        self._target = target
        self._of_kind = stat.S_ISDIR if folder else stat.S_ISREG
        self._place = target
        self._older: os.stat_result | None = None
        self._folder = ""
        self._held = HeldBack(WholeFile.__enter__.__code__, WholeFile.__exit__.__code__)

    def __enter__(self) -> Path:
        self._held.begin()
        try:
            self._place = Path(os.path.realpath(self._target)) if self._target.is_symlink() else self._target
            if self._place.is_symlink():  # what a loop of links leaves
                raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))
            self._older = self._place.stat() if self._place.exists() else None
            if self._older is not None and not self._of_kind(self._older.st_mode):
                raise InputError(f"{str(self._target)!r} is no regular file; choose another name.")
            self._folder = tempfile.mkdtemp(prefix=".robotraj-", dir=self._place.parent)
        except OSError as error:
            raise refusal(self._target, error) from error
        finally:
            if not self._folder:
                self._held.end()
        return Path(self._folder) / "partial"

    def __exit__(self, kind: object, error: BaseException | None, traceback: object) -> None:
        try:
            if isinstance(error, OSError):
                raise refusal(self._target, error) from error
            if error is None:
                self._finish(Path(self._folder) / "partial")
        except OSError as refused:
            raise refusal(self._target, refused) from refused
        finally:
            shutil.rmtree(self._folder, ignore_errors=True)
            self._held.end()

    def _finish(self, partial: Path) -> None:
        if self._older is not None:
            partial.chmod(stat.S_IMODE(self._older.st_mode))
        for each in (*partial.rglob("*"), partial):
            _to_disk(each)
        os.replace(partial, self._place)
        try:
            _to_disk(self._place.parent)
        except OSError as error:
            raise InputError(
                f"{str(self._target)!r} was written and is whole, but the disk did not confirm its name: "
                f"{error.strerror or error}. After a power failure the older file may be there."
            ) from error


@contextmanager
def refusals_named(target: Path) -> Iterator[None]:
    """Turn what the operating system refuses in the block into an ``InputError`` that names the target."""
    try:
        yield
    except OSError as error:
        raise refusal(target, error) from error


def refusal(target: Path, error: OSError) -> InputError:
    """Return the error for a file or folder that the operating system refuses to write."""
    advice = _ADVICE.get(error.errno or 0, "choose another place")
    reason = error.strerror or error
    return InputError(f"{str(target)!r} could not be written: {reason}. Nothing of it was kept; {advice}.")


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
