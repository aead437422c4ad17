"""The cache of compiled libraries: a folder that only its owner can read, write or replace.

Loaded libraries run with the user's rights. A folder or file that another user could have written is therefore refused.
A library is loaded only if its digest is that of the file that was stored: a truncated one would end the process.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import shutil
import stat
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import IO

from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.native.engines.ownership import ADVICE, make_folder, require_own, require_safe_parents


@dataclass(frozen=True)
class Cache(OneLine):
    """Libraries by key, shared by processes.

    Parameters
    ----------
    folder : Path
        Created with mode 0700 where it does not exist.

    Raises
    ------
    InputError
        The folder is a link, belongs to another user, or others may write to it or to a folder above it.
    """

    folder: Path

    def __post_init__(self) -> None:
        try:
            str(self.folder).encode()  # CasADi opens libraries by names in UTF-8
        except UnicodeEncodeError as error:
            named = ascii(str(self.folder))
            raise InputError(
                f"The cache of compiled functions {named} has letters that are not of this locale, such as LC_ALL=C. "
                f"{ADVICE}"
            ) from error
        try:
            make_folder(self.folder)
            found = self.folder.lstat()
        except OSError as error:
            raise InputError(f"The cache of compiled functions cannot be made: {error}. {ADVICE}") from error
        if not stat.S_ISDIR(found.st_mode):
            raise InputError(f"{self.folder} should be the cache of compiled functions but is a link. {ADVICE}")
        require_own(self.folder, found)
        require_safe_parents(self.folder)
        if stat.S_IMODE(found.st_mode) != 0o700 and self.writable:
            self.folder.chmod(0o700)

    @property
    def writable(self) -> bool:
        """Whether libraries can be added; those of a read-only folder are used all the same."""
        return os.access(self.folder, os.W_OK) and not os.statvfs(self.folder).f_flag & os.ST_RDONLY

    def find(self, key: str) -> Path | None:
        """Return the path of a library, None where there is none, or a damaged one."""
        path = self._path(key)
        try:
            found = path.lstat()
        except FileNotFoundError:
            return None
        if not stat.S_ISREG(found.st_mode):
            raise InputError(f"{path} is no regular file and is not loaded. Remove it with 'robotraj cache --clear'.")
        require_own(path, found)
        return path if self._is_whole(path, found) else None

    def store(self, key: str, library: Path) -> Path:
        """Move a finished library into the cache; the move is atomic for other processes."""
        path, digest = self._path(key), library.with_suffix(".digest")
        library.chmod(0o600)
        digest.write_text(_digest(library))
        # Between the two moves the library has the digest of another file at worst, and is built once more.
        os.replace(digest, path.with_suffix(".digest"))
        os.replace(library, path)
        return path

    def _is_whole(self, path: Path, found: os.stat_result) -> bool:
        """Whether a library is the file that was stored; each file is read once by a process."""
        version = (path, found.st_mtime_ns, found.st_size)
        if version not in _WHOLE:
            try:
                known = path.with_suffix(".digest").read_text()
            except OSError:
                return False
            if known != _digest(path):
                return False
            _WHOLE.add(version)
        return True

    @contextmanager
    def workplace(self) -> Iterator[Path]:
        """Create a temporary folder for a compilation, on the file system of the cache.

        Folders that killed processes left behind are removed.

        Raises
        ------
        InputError
            The cache is read-only.
        """
        self._require_writable()
        for left in self.folder.glob("build-*"):
            if _is_abandoned(left):
                shutil.rmtree(left, ignore_errors=True)
        with tempfile.TemporaryDirectory(prefix=f"build-{os.getpid()}-", dir=self.folder) as name:
            yield Path(name)

    @contextmanager
    def locked(self, keys: Sequence[str]) -> Iterator[None]:
        """Lock libraries: one process compiles them, others wait.

        Raises
        ------
        InputError
            The cache is read-only.
        """
        self._require_writable()
        with ExitStack() as stack:
            # A fixed order of locking prevents deadlocks.
            for key in sorted(keys):
                fcntl.flock(stack.enter_context(self._lock(key)), fcntl.LOCK_EX)
            yield

    def claim(self, key: str) -> IO[bytes] | None:
        """Return the lock of a library that no process compiles; it is held until the file is closed everywhere."""
        lock = self._lock(key)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            lock.close()
            return None
        return lock

    def libraries(self) -> list[Path]:
        """Return the paths of all libraries."""
        return sorted(self.folder.glob("*.so"))

    def size(self) -> int:
        """Return the size of all files in bytes."""
        return sum(path.lstat().st_size for path in self.folder.rglob("*") if not path.is_dir())

    def clear(self) -> int:
        """Remove all files and return the bytes that were freed. Running processes keep loaded libraries."""
        freed = self.size()
        for path in self.folder.iterdir():
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path, ignore_errors=True)
            else:
                path.unlink(missing_ok=True)
        return freed

    def _require_writable(self) -> None:
        if not self.writable:
            raise InputError(f"The cache {self.folder} is read-only and lacks a library of this plan. {ADVICE}")

    def _path(self, key: str) -> Path:
        return self.folder / f"{key}.so"

    def _lock(self, key: str) -> IO[bytes]:
        return (self.folder / f"{key}.lock").open("ab")


_WHOLE: set[tuple[Path, int, int]] = set()
"""Libraries whose digest this process has compared: path, time of the last change, size."""
ABANDONED = 24 * 3600.0
"""Age [s] at which a folder of a compilation on another machine counts as left behind."""


def _digest(path: Path) -> str:
    digest = hashlib.blake2b()
    with path.open("rb") as file:
        while part := file.read(1 << 20):
            digest.update(part)
    return digest.hexdigest()


def _is_abandoned(folder: Path) -> bool:
    """Whether the process that compiles in a folder is gone."""
    number = folder.name.removeprefix("build-").partition("-")[0]
    try:
        if number.isdecimal() and number != str(os.getpid()):
            os.kill(int(number), 0)
        return time.time() - folder.stat().st_mtime > ABANDONED
    except (ProcessLookupError, FileNotFoundError):
        return True
    except OSError:
        return False
