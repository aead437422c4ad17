"""Point functions as compiled C, kept in the user's cache."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import tempfile
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, suppress
from functools import cache as once
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import casadi as ca

from robotraj._util.checks import is_number, is_whole
from robotraj._util.errors import InputError, RobotrajError
from robotraj._util.paths import cache_folder
from robotraj._util.system.own_python import command
from robotraj._util.time_left import time_left
from robotraj._util.values import dataclass
from robotraj.native.engines import source
from robotraj.native.engines.base import Engine, Mapped, StageMapped, VirtualMachine
from robotraj.native.engines.blocks import StageFunctions, casadi_block
from robotraj.native.engines.blocks import wanted as wanted_of
from robotraj.native.engines.cache import Cache
from robotraj.native.engines.compiler import CompilationStopped, Compiler, find_compiler, points_at_once
from robotraj.native.engines.source import write_source

if TYPE_CHECKING:
    from robotraj.native import PointBlock


@dataclass(frozen=True)
class Compiled(Engine):
    """Machine code of the large point functions: the same numbers, to the last bit, many times faster.

    The key of a library is a digest of the function, CasADi's version, the compiler, its flags and the processor. The
    library is used by every plan whose phase has the same equations, on any mesh. CasADi's virtual machine evaluates
    functions of few operations, functions of few points, and functions that are no scalar graph (shooting).

    Parameters
    ----------
    wait : bool
        True compiles missing libraries before the plan. False plans with the virtual machine, while a separate process
        compiles the libraries for later plans.
    least : int
        Smallest number of operations of a function that is compiled.
    compiler : str, optional
        Name or path; the environment's ``CC``, gcc, clang or cc by default.
    cache : path, optional
        Folder of the libraries; ``~/.cache/robotraj/engines`` (or below ``$XDG_CACHE_HOME``) by default.
    jobs : int, optional
        Compilers that run at once; as many as the process has processors by default.

    Examples
    --------
    >>> solution = rt.plan(phase, engine=rt.engines.Compiled())  # doctest: +SKIP
    """

    made_for_ipopt: ClassVar[bool] = True

    wait: bool = True
    least: int = 300
    compiler: str | None = None
    cache: Path | str | None = None
    jobs: int | None = None

    def __post_init__(self) -> None:
        if not (is_number(self.least) and self.least >= 0):
            raise InputError(f"Compiled(least) is a number of operations, 0 or more; got {self.least!r}.")
        if self.jobs is not None and not (is_whole(self.jobs) and self.jobs >= 1):
            raise InputError(f"Compiled(jobs) is a number of processes, 1 or more; got {self.jobs!r}.")

    def prepare(self, wanted: Sequence[Mapped | StageMapped]) -> list[ca.Function]:
        """Return every function over its points, compiled where it is large.

        Raises
        ------
        InputError
            There is no compiler, or other users may write to the cache.
        CompilationFailed
            The compiler fails; the message has its output.
        """
        chosen = VirtualMachine().prepare(wanted)
        for i, library in self._libraries(wanted).items():
            chosen[i] = _mapped(library, wanted[i])
        return chosen

    def block(self, stage: StageFunctions, count: int, costs: bool) -> PointBlock:
        """Evaluate several points in a call of a compiled function, else one point at a time."""
        functions = wanted_of(stage, costs)
        batches = {name: (function, 1) for name, function in functions.items()}
        names = list(functions)
        libraries = self._libraries([Mapped(functions[name], count) for name in names])
        batches |= {names[i]: (library, points_at_once()) for i, library in libraries.items()}
        return casadi_block(stage, count, costs, batches)

    def _libraries(self, wanted: Sequence[Mapped | StageMapped]) -> dict[int, ca.Function]:
        """Return the compiled functions of ``points_at_once()`` columns, by the index of their entry."""
        large = self._large(wanted)
        if not large:
            return {}
        cache, compiler = self.open_cache(), find_compiler(self.compiler)
        keys = {i: key_of(function, compiler) for i, function in large.items()}
        missing = {keys[i]: function for i, function in large.items() if cache.find(keys[i]) is None}
        if missing and self.wait:
            with cache.locked(list(missing)):
                missing = {key: function for key, function in missing.items() if cache.find(key) is None}
                # At a time limit the virtual machine evaluates what has not been compiled.
                with suppress(CompilationStopped):
                    build(missing, cache, compiler, self.processes)
        elif missing and cache.writable:
            start_compiling(missing, cache, compiler, self.processes)
        found = {i: cache.find(key) for i, key in keys.items()}
        return {
            i: self._load(large[i], keys[i], library, cache, compiler)
            for i, library in found.items()
            if library is not None
        }

    def libraries(self, wanted: Sequence[Mapped | StageMapped]) -> set[Path]:
        """Return the libraries in the cache that these functions use."""
        cache, compiler = self.open_cache(), find_compiler(self.compiler)
        found = {cache.find(key_of(function, compiler)) for function in self._large(wanted).values()}
        return {path for path in found if path is not None}

    def open_cache(self) -> Cache:
        """Return the cache after the checks of its folder."""
        return Cache(cache_folder("engines") if self.cache is None else Path(self.cache).expanduser().absolute())

    @property
    def processes(self) -> int:
        """Compilers that run at once."""
        return self.jobs or len(os.sched_getaffinity(0))

    def _large(self, wanted: Sequence[Mapped | StageMapped]) -> dict[int, ca.Function]:
        return {i: each.function for i, each in enumerate(wanted) if self._pays(each)}

    def _pays(self, each: Mapped | StageMapped) -> bool:
        function = each.function
        # A library evaluates several points at once; a single point gains little.
        many = each.count >= points_at_once() // 2
        return many and function.is_a("SXFunction") and function.n_instructions() >= max(self.least, 1)

    def _load(self, function: ca.Function, key: str, library: Path, cache: Cache, compiler: Compiler) -> ca.Function:
        try:
            return ca.external(function.name(), str(library))
        except RuntimeError:
            # The file is damaged, for example by a full disk.
            library.unlink(missing_ok=True)
            build({key: function}, cache, compiler, self.processes)
            return ca.external(function.name(), str(library))


def key_of(function: ca.Function, compiler: Compiler) -> str:
    """Return a digest of all inputs of a library."""
    digest = hashlib.sha256(_writer())
    for part in (ca.__version__, str(points_at_once()), compiler.identity(), function.serialize()):
        digest.update(hashlib.sha256(part.encode()).digest())
    return digest.hexdigest()


def build(functions: dict[str, ca.Function], cache: Cache, compiler: Compiler, processes: int) -> None:
    """Compile functions into the cache, several files at a time.

    Parameters
    ----------
    functions : dict
        By key.
    """
    with ExitStack() as stack:
        place = stack.enter_context(cache.workplace())
        pool = ThreadPoolExecutor(processes)
        # After an error or Ctrl-C no further compilation starts.
        stack.callback(pool.shutdown, wait=True, cancel_futures=True)
        waiting, until = [], time.monotonic() + time_left()
        for key, function in functions.items():
            folder = place / key
            folder.mkdir()
            waiting.append((key, compiler.start(write_source(function, points_at_once()), folder, pool, until)))
        for key, finish in waiting:
            cache.store(key, finish())


def _mapped(external: ca.Function, wanted: Mapped | StageMapped) -> ca.Function:
    """Map a function of several columns over any number of columns, padded by copies of the last one."""
    function, count = wanted.function, wanted.count
    points = points_at_once()
    calls = -(-count // points)
    symbols = [ca.MX.sym(f"i{i}", function.numel_in(i), count) for i in range(function.n_in())]
    spare = calls * points - count
    full = [ca.horzcat(s, ca.repmat(s[:, -1], 1, spare)) for s in symbols] if spare else symbols
    results = external.map(calls)(*full)
    if results.shape != (function.numel_out(0), calls * points):
        raise RobotrajError(
            f"The library of {function.name()!r} has other shapes than its function. "
            "Remove it with 'robotraj cache --clear'."
        )
    return ca.Function(function.name(), symbols, [results[:, :count] if spare else results])


@once
def _writer() -> bytes:
    """Return a digest of the code that writes the C sources."""
    return hashlib.sha256(Path(source.__file__).read_bytes()).digest()


def start_compiling(functions: dict[str, ca.Function], cache: Cache, compiler: Compiler, processes: int) -> None:
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
