"""Work on untrusted bytes in a process of its own, whose memory and time are limited.

A parser that crashes, allocates without end or never returns ends that process alone. The parent sends one request at a
time, and starts another process after a failure.
"""

from __future__ import annotations

import os
import resource
import signal
import struct
import subprocess
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import IO

from robotraj._util.system.own_python import command

MEMORY = 640 * 2**20
"""Memory that one answer may allocate [bytes]."""
PAUSE = 10.0
"""Wall-clock time over the processor's, after which an answer that waits for something is stopped; longer by the number
of processes that share a processor, since a busy machine lets a process wait for its turn."""
_LENGTH = struct.Struct("!?Q")


class NoAnswer(Exception):
    """An answer was refused, or its process ended; the text is the reason."""


class LimitedProcess:
    """A process that answers questions, started with the first one; a context manager.

    Parameters
    ----------
    module : str
        Module of this package that calls ``serve``.
    """

    def __init__(self, module: str) -> None:
        self._module = module
        self._running: subprocess.Popen[bytes] | None = None
        self._folder: tempfile.TemporaryDirectory[str] | None = None

    def __enter__(self) -> LimitedProcess:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end()

    def ask(self, question: bytes, seconds: float) -> bytes:
        """Return the answer to a question.

        Parameters
        ----------
        question : bytes
        seconds : float
            Processor time of the answer [s].

        Raises
        ------
        NoAnswer
            The question was refused, or its answer exceeds a limit or ends the process.
        """
        process = self._running or self._start()
        assert process.stdin is not None and process.stdout is not None
        try:
            process.stdin.write(struct.pack("!d", seconds))
            _send(process.stdin, True, question)
            found, answer = _receive(process.stdout)
        except (EOFError, OSError):
            raise NoAnswer(_reason(self._end(), seconds)) from None
        except BaseException:
            self._end()
            raise
        if not found:
            raise NoAnswer(answer.decode("utf-8", "replace"))
        return answer

    def _start(self) -> subprocess.Popen[bytes]:
        # The folder is the process's own; it is removed whatever ends the process.
        self._folder = tempfile.TemporaryDirectory(prefix="robotraj-", ignore_cleanup_errors=True)
        self._running = subprocess.Popen(
            command(self._module),
            cwd=self._folder.name,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
        return self._running

    def _end(self) -> int:
        code = 0
        if self._running is not None:
            self._running.kill()
            for pipe in (self._running.stdin, self._running.stdout):
                assert pipe is not None
                with suppress(OSError):  # the rest of a question that nobody reads
                    pipe.close()
            code = self._running.wait()
            self._running = None
        if self._folder is not None:
            self._folder.cleanup()
            self._folder = None
        return code


def serve(answer: Callable[[bytes], bytes]) -> None:
    """Answer questions of the parent until it closes the line.

    Parameters
    ----------
    answer : callable
        Its errors are sent as refusals.
    """
    questions, answers = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    # Libraries that print must not write into the answers.
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    with suppress(OSError):  # systems without /proc
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, used + MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    while len(head := questions.read(8)) == 8:
        (seconds,) = struct.unpack("!d", head)
        _, question = _receive(questions)
        signal.setitimer(signal.ITIMER_PROF, seconds)
        signal.setitimer(signal.ITIMER_REAL, (seconds + PAUSE) * max(1.0, os.getloadavg()[0] / (os.cpu_count() or 1)))
        try:
            found, text = True, answer(question)
        except MemoryError:
            found, text = False, _TOO_MUCH.encode()
        except Exception as error:
            reason = " ".join(str(error).split())[:200] or type(error).__name__
            if isinstance(error, _UNCHECKED):
                reason = f"its content is damaged ({type(error).__name__})"
            found, text = False, (_TOO_MUCH if "bad_alloc" in reason else reason).encode()
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        _send(answers, found, text)


_UNCHECKED = (ArithmeticError, AssertionError, AttributeError, LookupError, NameError, RecursionError, TypeError)
"""Errors of parsers that do not check what they read, whose texts are about the parser."""
_TOO_MUCH = f"reading it takes more than {MEMORY / 1e6:.0f} MB"


def _reason(code: int, seconds: float) -> str:
    if code in (-signal.SIGPROF, -signal.SIGALRM):
        return f"reading it takes more than {seconds:.0f} s"
    return f"its reader ends with {signal.Signals(-code).name if code < 0 else f'code {code}'}"


def _send(line: IO[bytes], good: bool, data: bytes) -> None:
    line.write(_LENGTH.pack(good, len(data)))
    line.write(data)
    line.flush()


def _receive(line: IO[bytes]) -> tuple[bool, bytes]:
    head = line.read(_LENGTH.size)
    if len(head) < _LENGTH.size:
        raise EOFError
    good, size = _LENGTH.unpack(head)
    data = line.read(size)
    if len(data) < size:
        raise EOFError
    return good, data
