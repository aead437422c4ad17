"""Where programs of other packages are looked for: the absolute entries of PATH.

An entry that is empty or relative means the working folder, whose files would then be run.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager


def absolute_entries() -> str:
    """Return PATH without entries that depend on the working folder; the system's own ones where none is left."""
    # An empty PATH would mean the working folder, too.
    return os.pathsep.join(filter(os.path.isabs, os.get_exec_path())) or os.defpath


@contextmanager
def without_working_folder() -> Iterator[None]:
    """Let this process look programs up in the absolute entries of PATH alone, as long as the context is open."""
    before = os.environ.get("PATH")
    os.environ["PATH"] = absolute_entries()
    try:
        yield
    finally:
        if before is None:
            del os.environ["PATH"]
        else:
            os.environ["PATH"] = before
