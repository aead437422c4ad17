"""The C compiler of this machine, which makes a library from source files."""

from __future__ import annotations

import hashlib
import math
import os
import platform
import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from concurrent.futures import Executor, Future
from functools import cache
from pathlib import Path

from robotraj._util.errors import InputError, RobotrajError
from robotraj._util.system.own_python import absolute_entries
from robotraj._util.values import dataclass
from robotraj.native.engines.source import Source

CANDIDATES = ("gcc", "clang", "cc")
"""Names that are tried in this order."""
# Without contraction a*b + c is rounded twice, as by CasADi's virtual machine: results are bitwise equal.
FLAGS = ("-std=gnu11", "-O1", "-march=native", "-ffp-contract=off", "-fPIC", "-fvisibility=hidden", "-w")
"""Higher optimisation levels take longer and do not speed up straight-line arithmetic."""


class CompilationFailed(RobotrajError):
    """The C compiler refused generated code, or could not be started."""


class CompilationStopped(RobotrajError):
    """The time limit of the plan ended a compilation."""


@dataclass(frozen=True)
class Compiler:
    """A C compiler.

    Attributes
    ----------
    command : str
        Its path.
    version : str
        Its output of ``-v``.
    """

    command: str
    version: str

    def identity(self) -> str:
        """Return the compiler, its flags and the processor as text; libraries are shared where it is equal."""
        return "\n".join([self.version, *FLAGS, platform.machine(), processor()])

    def start(self, source: Source, folder: Path, pool: Executor, until: float = math.inf) -> Callable[[], Path]:
        """Compile the files of a library on the pool; return a function that waits for them and links.

        Parameters
        ----------
        until : float
            Value of ``time.monotonic()`` at which the compiler is stopped.

        Raises
        ------
        CompilationStopped
            Raised by the returned function.
        CompilationFailed
            Raised by the returned function, with the compiler's output.
        """
        objects: list[tuple[Path, Future[None]]] = []
        for i, text in enumerate(source.files):
            written, made = folder / f"{i}.c", folder / f"{i}.o"
            written.write_text(text)
            objects.append((made, pool.submit(self._run, folder, until, *FLAGS, "-c", str(written), "-o", str(made))))

        def finish() -> Path:
            for _, future in objects:
                future.result()
            library = folder / "library.so"
            self._run(folder, until, "-shared", "-o", str(library), *(str(made) for made, _ in objects), "-lm")
            return library

        return finish

    def _run(self, folder: Path, until: float, *arguments: str) -> None:
        left = until - time.monotonic()
        if left <= 0.0:
            raise CompilationStopped(f"{self.command} was not started: the time limit is over.")
        try:
            # A compiler of its own group can be stopped with the processes that it has started.
            # Relative entries of PATH, CPATH and the like then name no file of the working folder.
            done = subprocess.Popen(
                [self.command, *arguments],
                cwd=folder,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                text=True,
                start_new_session=math.isfinite(until),
            )
        except OSError as error:
            raise CompilationFailed(f"{self.command} could not be started: {error}.") from error
        try:
            _, output = done.communicate(timeout=left if math.isfinite(left) else None)
        except subprocess.TimeoutExpired as error:
            os.killpg(done.pid, signal.SIGKILL)
            done.communicate()
            raise CompilationStopped(f"{self.command} was stopped at the time limit.") from error
        if done.returncode:
            words = "\n".join(output.splitlines()[:10])
            raise CompilationFailed(
                f"{self.command} failed with code {done.returncode}; engine=rt.engines.VirtualMachine() needs "
                f"no compiler.\n" + words
            )


def find_compiler(command: str | None = None) -> Compiler:
    """Find a C compiler.

    Parameters
    ----------
    command : str, optional
        A name or path; otherwise the environment's ``CC``, then gcc, clang, cc.

    Raises
    ------
    InputError
        There is none.
    """
    names = [command] if command else [os.environ.get("CC", ""), *CANDIDATES]
    for name in names:
        path = _on_path(name) if name else None
        if path is not None:
            return Compiler(path, _version(path))
    sought = repr(command) if command else " or ".join(CANDIDATES)
    raise InputError(
        f"rt.engines.Compiled() needs a C compiler, and {sought} is not on this machine's path. Install gcc or clang "
        "(Debian and Ubuntu: apt install gcc), or plan with engine=rt.engines.Native(), which needs none."
    )


def _on_path(name: str) -> str | None:
    """Return the absolute path of a program; a name is looked for in the absolute entries of PATH alone."""
    if os.path.dirname(name):
        name = os.path.abspath(name)
    return shutil.which(name, path=absolute_entries())


@cache
def _version(path: str) -> str:
    done = subprocess.run([path, "-v"], capture_output=True, text=True, check=False, cwd=os.path.dirname(path))
    if done.returncode:
        raise InputError(f"{path} is no working C compiler: '{path} -v' fails. Give another one by compiler= or CC.")
    # On some systems clang prints a temporary folder on later lines.
    return f"{path}\n{done.stdout}{done.stderr}"


@cache
def processor() -> str:
    """Return a digest of the processor's instruction sets, for which code is compiled (-march=native)."""
    known = {line.split(":", 1)[1].strip() for line in _cpuinfo() if line.startswith(("flags", "Features"))}
    return hashlib.sha256("".join(sorted(known) or [platform.processor()]).encode()).hexdigest()


@cache
def points_at_once() -> int:
    """Return the number of doubles in a vector register: 8 with AVX-512, 4 with AVX, else 2."""
    flags = {word for line in _cpuinfo() if line.startswith("flags") for word in line.split()}
    return 8 if "avx512f" in flags else 4 if "avx" in flags else 2


@cache
def _cpuinfo() -> tuple[str, ...]:
    try:
        return tuple(Path("/proc/cpuinfo").read_text().splitlines())
    except OSError:
        return ()
