"""Where compiled libraries are kept: one folder that only its owner can read or write.

What is loaded from there runs with the user's rights, so a folder or file that somebody else could have written is
refused.
"""

from __future__ import annotations

import fcntl
import os
import shutil
import stat
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import IO

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass


def default_folder() -> Path:
    """``$XDG_CACHE_HOME/robotraj/engines``, or ``~/.cache/robotraj/engines``."""
    given = Path(os.environ.get("XDG_CACHE_HOME", ""))
    # The XDG specification has relative paths ignored.
    base = given if given.is_absolute() else Path.home() / ".cache"
    return base / "robotraj" / "engines"


@dataclass(frozen=True)
class Cache:
    """Libraries by key, shared by processes.

    Parameters
    ----------
    folder : Path
        Made where it does not exist, with mode 0700.

    Raises
    ------
    InputError
        The folder is a link, belongs to another user, or others may write to it.
    """

    folder: Path

    def __post_init__(self) -> None:
        try:
            self.folder.parent.mkdir(parents=True, exist_ok=True)
            self.folder.mkdir(mode=0o700, exist_ok=True)
            found = self.folder.lstat()
        except OSError as error:
            raise InputError(f"The cache of compiled functions cannot be made: {error}. {_ADVICE}") from error
        if not stat.S_ISDIR(found.st_mode):
            raise InputError(f"{self.folder} should be the cache of compiled functions but is a link. {_ADVICE}")
        _require_own(self.folder, found)
        self.folder.chmod(0o700)

    def find(self, key: str) -> Path | None:
        """Give the path of a library, if there is one that may be loaded."""
        path = self._path(key)
        try:
            found = path.lstat()
        except FileNotFoundError:
            return None
        if not stat.S_ISREG(found.st_mode):
            raise InputError(f"{path} is no regular file and will not be loaded; 'robotraj cache --clear' removes it.")
        _require_own(path, found)
        return path

    def store(self, key: str, library: Path) -> Path:
        """Move a finished library into place, in one step: other processes see all of it or nothing."""
        path = self._path(key)
        library.chmod(0o600)
        os.replace(library, path)
        return path

    @contextmanager
    def workplace(self) -> Iterator[Path]:
        """Give a folder for the files of a compilation, on the cache's own file system; removed afterwards."""
        with tempfile.TemporaryDirectory(prefix="build-", dir=self.folder) as name:
            yield Path(name)

    @contextmanager
    def locked(self, keys: Sequence[str]) -> Iterator[None]:
        """Hold libraries against other processes, so that one compiles and the others wait for it."""
        with ExitStack() as stack:
            # All take them in the same order, so nobody waits in a circle.
            for key in sorted(keys):
                fcntl.flock(stack.enter_context(self._lock(key)), fcntl.LOCK_EX)
            yield

    def claim(self, key: str) -> IO[bytes] | None:
        """Give the lock of a library that nobody is compiling; it is held until the file is closed everywhere."""
        lock = self._lock(key)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            lock.close()
            return None
        return lock

    def libraries(self) -> list[Path]:
        """Every library."""
        return sorted(self.folder.glob("*.so"))

    def size(self) -> int:
        """Bytes of all files."""
        return sum(path.lstat().st_size for path in self.folder.rglob("*") if not path.is_dir())

    def clear(self) -> int:
        """Remove everything; give the bytes that were freed. Running processes keep what they have loaded."""
        freed = self.size()
        for path in self.folder.iterdir():
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path, ignore_errors=True)
            else:
                path.unlink(missing_ok=True)
        return freed

    def _path(self, key: str) -> Path:
        return self.folder / f"{key}.so"

    def _lock(self, key: str) -> IO[bytes]:
        return (self.folder / f"{key}.lock").open("ab")


_ADVICE = "Point XDG_CACHE_HOME, or Compiled(cache=...), at a folder of your own."


def _require_own(path: Path, found: os.stat_result) -> None:
    """Refuse what somebody else owns or may write."""
    if found.st_uid != os.getuid():
        raise InputError(
            f"{path} belongs to user {found.st_uid}, not to you ({os.getuid()}); code from there will not be loaded. "
            f"{_ADVICE}"
        )
    if found.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        raise InputError(
            f"Others may write to {path} (mode {stat.S_IMODE(found.st_mode):o}); code from there will not be loaded. "
            f"Remove it, or {_ADVICE[0].lower()}{_ADVICE[1:]}"
        )
