"""Who may write to a file or replace it, as ``ssh`` decides it for keys: owners and modes, also of all parents."""

from __future__ import annotations

import grp
import os
import pwd
import stat
from pathlib import Path

from robotraj._util.errors import InputError

ADVICE = "Point XDG_CACHE_HOME, or Compiled(cache=...), at a folder of your own."


def make_folder(folder: Path) -> None:
    """Make a folder and its missing parents, for the user alone whatever the ``umask``."""
    missing = [folder, *folder.parents]
    while missing and missing[-1].exists():
        missing.pop()
    for each in reversed(missing):
        each.mkdir(mode=0o700, exist_ok=True)


def require_own(path: Path, found: os.stat_result) -> None:
    """Refuse a file that another user owns or may write.

    Raises
    ------
    InputError
        Names the path, and its owner or mode.
    """
    if found.st_uid != os.getuid():
        raise InputError(
            f"{path} belongs to user {found.st_uid}, not to you ({os.getuid()}); its code is not loaded. {ADVICE}"
        )
    if found.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        raise InputError(
            f"Others may write to {path} (mode {stat.S_IMODE(found.st_mode):o}); its code is not loaded. "
            f"Remove it, or {ADVICE[0].lower()}{ADVICE[1:]}"
        )


def require_safe_parents(folder: Path) -> None:
    """Refuse a folder that another user could replace by one of the same name.

    Every folder above it, links followed, belongs to the user, to the administrator or to the owner of the root folder,
    whom the kernel trusts. Others may not write there, except where the sticky bit keeps names to their owners, as in
    ``/tmp``. The user's own group is the user, where it has no other members.

    Raises
    ------
    InputError
        Names the folder above, and its owner or mode.
    """
    trusted = {0, os.getuid(), os.stat("/").st_uid}
    for above in folder.resolve().parents:
        found = above.stat()
        if found.st_uid not in trusted:
            raise InputError(
                f"{above}, above the cache of compiled functions, belongs to user {found.st_uid}, who could replace "
                f"it; no code is loaded from it. {ADVICE}"
            )
        by_group = found.st_mode & stat.S_IWGRP and not _is_private(found.st_gid)
        writable = found.st_mode & stat.S_IWOTH or by_group
        if writable and not found.st_mode & stat.S_ISVTX:
            raise InputError(
                f"Others may write to {above} (mode {stat.S_IMODE(found.st_mode):o}), and so replace the cache of "
                f"compiled functions in it; no code is loaded from it. Run 'chmod go-w {above}', or "
                f"{ADVICE[0].lower()}{ADVICE[1:]}"
            )


def _is_private(group: int) -> bool:
    """Whether a group is the user's own: the first one, of the same name, without other members."""
    try:
        user, found = pwd.getpwuid(os.getuid()), grp.getgrgid(group)
    except KeyError:
        return False
    return user.pw_gid == group and found.gr_name == user.pw_name and set(found.gr_mem) <= {user.pw_name}
