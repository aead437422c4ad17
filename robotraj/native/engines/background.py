"""Compilation in a separate process, which outlives the process that starts it."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import casadi as ca

from robotraj.native.engines.cache import Cache
from robotraj.native.engines.compiler import Compiler


def start(functions: dict[str, ca.Function], cache: Cache, compiler: Compiler, processes: int) -> None:
    """Start the compilation of functions that no other process compiles already.

    Parameters
    ----------
    functions : dict
        By key.
    """
    locks = {key: lock for key in sorted(functions) if (lock := cache.claim(key)) is not None}
    if not locks:
        return
    try:
        job = Path(tempfile.mkdtemp(prefix="job-", dir=cache.folder))
        for key in locks:
            functions[key].save(str(job / f"{key}.casadi"))
        with (cache.folder / "background.log").open("ab") as log:
            # The process inherits the locks; the system releases them when it ends.
            subprocess.Popen(
                [sys.executable, "-m", "robotraj.native.engines", str(job), compiler.command, str(processes)],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                start_new_session=True,
                pass_fds=[lock.fileno() for lock in locks.values()],
                env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
            )
    finally:
        for lock in locks.values():
            lock.close()
