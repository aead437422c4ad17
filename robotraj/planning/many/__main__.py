"""A worker process: tasks come in and answers go out on the socket whose number is its argument."""

from __future__ import annotations

import os
import pickle
import socket
import sys
import threading
import traceback
from queue import SimpleQueue

import cloudpickle

import robotraj.planning.many.sweep  # noqa: F401 - imported before the parent's folders are searched
from robotraj.planning.many.processes import RemoteTraceback, receive, send


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
    with socket.socket(fileno=int(sys.argv[1])) as line:
        sys.path[:] = pickle.loads(receive(line))
        waiting: SimpleQueue[bytes] = SimpleQueue()
        threading.Thread(target=_read, args=(line, waiting), daemon=True).start()
        while True:
            send(line, _answer(waiting.get()))
