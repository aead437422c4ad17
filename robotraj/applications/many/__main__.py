"""A worker process: tasks come in and answers go out on the socket whose number is its argument."""

from __future__ import annotations

import os
import pickle
import resource
import socket
import sys
import threading
import traceback
from contextlib import suppress
from queue import Empty, SimpleQueue

import cloudpickle

import robotraj.applications.many.sweep  # noqa: F401 - imported before the parent's folders are searched
from robotraj.applications.many.processes import IDLE, RemoteTraceback, receive, send


def _read(line: socket.socket, tasks: SimpleQueue[bytes]) -> None:
    """Pass tasks on; a parent that is gone ends this process in the middle of a task."""
    try:
        while True:
            tasks.put(receive(line))
    except (OSError, EOFError):
        os._exit(0)


def _answer(task: bytes) -> bytes:
    try:
        function, arguments, options = cloudpickle.loads(task)
        return cloudpickle.dumps((True, function(*arguments, **options)))
    except BaseException as error:
        error.__cause__ = RemoteTraceback(traceback.format_exc())
        try:
            return cloudpickle.dumps((False, (error, error.__cause__)))
        except Exception:
            return pickle.dumps((False, (RuntimeError(f"{type(error).__name__}: {error}"), error.__cause__)))


if __name__ == "__main__":
    # A process that crashes writes no image of its memory, which takes seconds.
    resource.setrlimit(resource.RLIMIT_CORE, (0, resource.getrlimit(resource.RLIMIT_CORE)[1]))
    with socket.socket(fileno=int(sys.argv[1])) as line:
        sys.path[:] = pickle.loads(receive(line))
        waiting: SimpleQueue[bytes] = SimpleQueue()
        threading.Thread(target=_read, args=(line, waiting), daemon=True).start()
        with suppress(Empty):
            while True:
                send(line, _answer(waiting.get(timeout=IDLE)))
