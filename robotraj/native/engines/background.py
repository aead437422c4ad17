"""Compilation in a separate process, which outlives the process that starts it."""

from __future__ import annotations

import json
import subprocess
import tempfile

import casadi as ca

from robotraj._util.system.own_python import command
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
        # A file without a name is gone when the last process closes it, however that process ends.
        with tempfile.TemporaryFile(dir=cache.folder) as job, (cache.folder / "background.log").open("ab") as log:
            job.write(json.dumps({key: functions[key].serialize() for key in locks}).encode())
            job.seek(0)
            # The process inherits the locks; the system releases them when it ends.
            subprocess.Popen(
                command("robotraj.native.engines", str(cache.folder), compiler.command, str(processes)),
                cwd=cache.folder,
                stdin=job,
                stdout=log,
                stderr=log,
                start_new_session=True,
                pass_fds=[lock.fileno() for lock in locks.values()],
            )
    finally:
        for lock in locks.values():
            lock.close()
