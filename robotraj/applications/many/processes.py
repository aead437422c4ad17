"""Worker processes: isolated, independent of the script that starts them, and ended with it.

Each process is served by a thread of its own through a socket. A process that dies fails its task alone; the next task
gets a new process. ``multiprocessing`` would run files of the working folder, and imports the script in every worker.
"""

from __future__ import annotations

import atexit
import os
import pickle
import signal
import socket
import struct
import subprocess
import sys
import threading
from collections.abc import Callable
from concurrent.futures import Executor, Future
from concurrent.futures.process import BrokenProcessPool
from queue import Empty, SimpleQueue
from typing import ParamSpec, TypeVar, cast

import cloudpickle

from robotraj._util.system.own_python import command

P = ParamSpec("P")
R = TypeVar("R")

IDLE = 300.0
"""Time without a task after which a worker process ends [s]."""
_LENGTH = struct.Struct("!Q")


class WorkerDied(BrokenProcessPool):
    """A worker process ended in the middle of a task.

    Attributes
    ----------
    code : int or None
        How it ended, a signal as a negative number; None where it could not be started.
    """

    def __init__(self, code: int | None) -> None:
        how = "could not be started" if code is None else f"ended with code {code}"
        if code is not None and code < 0:
            how = f"was ended by {signal.Signals(-code).name}"
        super().__init__(f"A worker process {how}.")
        self.code = code

    def __reduce__(self) -> tuple[type, tuple[int | None]]:
        return type(self), (self.code,)


class RemoteTraceback(Exception):
    """Traceback of an error in a worker, as its cause."""

    def __str__(self) -> str:
        return f"\n{self.args[0]}"


class Processes(Executor):
    """An executor of Python processes, which start with their first tasks.

    Parameters
    ----------
    count : int
        Tasks that run at once.
    """

    def __init__(self, count: int) -> None:
        self._tasks: SimpleQueue[tuple[Future[object], bytes] | None] = SimpleQueue()
        self._running: set[subprocess.Popen[bytes]] = set()
        self._lock = threading.Lock()
        self._closed = False
        self._threads = [threading.Thread(target=self._serve, daemon=True) for _ in range(count)]
        for thread in self._threads:
            thread.start()

    def submit(self, fn: Callable[P, R], /, *args: P.args, **kwargs: P.kwargs) -> Future[R]:
        """Queue ``fn(*args, **kwargs)``; all three travel by cloudpickle."""
        if self._closed:
            raise RuntimeError("these processes were shut down")
        future: Future[object] = Future()
        self._tasks.put((future, cloudpickle.dumps((fn, args, kwargs))))
        return cast("Future[R]", future)

    @property
    def running(self) -> tuple[int, ...]:
        """Numbers of the processes that are running."""
        with self._lock:
            return tuple(process.pid for process in self._running)

    @property
    def started(self) -> bool:
        """Whether a process is running."""
        return bool(self._running)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the processes: after their tasks, or at once without ``wait``."""
        self._closed = True
        while cancel_futures or not wait:
            try:
                entry = self._tasks.get_nowait()
            except Empty:
                break
            if entry is not None:
                entry[0].cancel()
        for _ in self._threads:
            self._tasks.put(None)
        if not wait:
            with self._lock:
                for process in self._running:
                    process.kill()
        for thread in self._threads:
            thread.join()

    def _serve(self) -> None:
        """Hand tasks to one process, and start another where it died."""
        process: subprocess.Popen[bytes] | None = None
        line: socket.socket | None = None
        while (entry := self._tasks.get()) is not None:
            future, task = entry
            if not future.set_running_or_notify_cancel():
                continue
            try:
                if process is None or line is None or process.poll() is not None:
                    self._end(process, line)
                    process, line = self._start()
                send(line, task)
                found, value = pickle.loads(receive(line))
            except (OSError, EOFError):
                future.set_exception(WorkerDied(self._end(process, line)))
                process = line = None
            except Exception as error:  # an answer that cannot be unpacked
                future.set_exception(error)
            else:
                if found:
                    future.set_result(value)
                else:
                    raised, raised.__cause__ = value
                    future.set_exception(raised)
        self._end(process, line)

    def _start(self) -> tuple[subprocess.Popen[bytes], socket.socket]:
        here, there = socket.socketpair()
        with there, self._lock:
            if self._closed:
                here.close()
                raise EOFError
            process = subprocess.Popen(
                command("robotraj.applications.many", str(there.fileno())),
                stdin=subprocess.DEVNULL,
                pass_fds=[there.fileno()],
            )
            self._running.add(process)
        # An empty entry is the working folder; only a parent that was started so imports from it.
        send(here, pickle.dumps([entry or os.getcwd() for entry in sys.path]))
        return process, here

    def _end(self, process: subprocess.Popen[bytes] | None, line: socket.socket | None) -> int | None:
        """Close the line to a process, wait for its end, and return its code."""
        if line is not None:
            line.close()
        if process is None:
            return None
        code = process.wait()
        with self._lock:
            self._running.discard(process)
        return code


_kept: list[Processes] = []
"""The processes of this machine: those of one call serve the next."""
_keeping = threading.Lock()


def kept(start: bool = True) -> Processes | None:
    """Return the processes that outlive a call, one for each processor; None without them where none is to ``start``.

    They end with this process, and after ``IDLE`` seconds without a task.
    """
    with _keeping:
        if not _kept and start:
            _kept.append(Processes(len(os.sched_getaffinity(0))))
        return _kept[0] if _kept else None


def release_kept() -> None:
    """End the processes that outlive a call, at once."""
    with _keeping:
        ended, _kept[:] = list(_kept), []
    for each in ended:
        each.shutdown(wait=False, cancel_futures=True)


atexit.register(release_kept)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_kept.clear)


def send(line: socket.socket, data: bytes) -> None:
    """Send a message with its length."""
    line.sendall(_LENGTH.pack(len(data)) + data)


def receive(line: socket.socket) -> bytes:
    """Return the next message.

    Raises
    ------
    EOFError
        The other side has closed the line.
    """
    (length,) = _LENGTH.unpack(_exactly(line, _LENGTH.size))
    return bytes(_exactly(line, length))


def _exactly(line: socket.socket, size: int) -> bytearray:
    data, got = bytearray(size), 0
    with memoryview(data) as view:
        while got < size:
            count = line.recv_into(view[got:])
            if not count:
                raise EOFError
            got += count
    return data
