"""A child process makes the attempts, so that its crash, hang or unexpected exception is detected."""

from __future__ import annotations

import json
import os
import selectors
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

CACHE = (("robotraj",), ("robotraj", "meshes"))
"""Folders in which the arrays of meshes are kept."""
START = 120.0
"""Longest time that a child takes to start [s]."""


@dataclass(frozen=True)
class Verdict:
    """The end of one attempt: ``kind`` is loaded, refused, raw, wrote, crash or slow; only the first two are right."""

    kind: str
    text: str = ""
    seconds: float = 0.0

    @property
    def right(self) -> bool:
        return self.kind in ("loaded", "refused")


class Guard:
    """Makes attempts in a child process, in an empty home and working folder; a dead or hung child is replaced."""

    def __init__(self, seconds: float = 5.0) -> None:
        self._seconds, self._child = seconds, None
        self._home = tempfile.TemporaryDirectory()

    def __enter__(self) -> Guard:
        return self

    def __exit__(self, *_: object) -> None:
        self._end()
        self._home.cleanup()

    def attempt(self, kind: str, argument: str) -> Verdict:
        """Make one attempt; its name and argument go to ``attempts.py``."""
        child = self._child or self._start()
        began = time.perf_counter()
        child.stdin.write(json.dumps([kind, argument]) + "\n")
        child.stdin.flush()
        line = self._line(child, self._seconds)
        seconds = time.perf_counter() - began
        if line is None:
            self._end()
            return Verdict("slow", f"no answer within {self._seconds:g} s", seconds)
        if not line:
            code = child.wait()
            self._end()
            return Verdict("crash", f"the process ended with code {code}", seconds)
        answer, text = json.loads(line)
        every = (path.relative_to(self._home.name) for path in Path(self._home.name).rglob("*"))
        left = sorted(str(path) for path in every if path.parts[:2] not in CACHE)
        if left:
            return Verdict("wrote", ", ".join(left), seconds)
        return Verdict(answer, text, seconds)

    def _start(self) -> subprocess.Popen[str]:
        script = Path(__file__).with_name("attempts.py")
        environment = {
            **os.environ,
            "HOME": self._home.name,
            "XDG_CACHE_HOME": self._home.name,
            "TMPDIR": self._home.name,
        }
        environment["PYTHONPATH"] = os.pathsep.join([str(Path(__file__).parents[2]), os.environ.get("PYTHONPATH", "")])
        environment["PYTHONDONTWRITEBYTECODE"] = "1"
        self._child = subprocess.Popen(
            [sys.executable, str(script)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            cwd=self._home.name,
            env=environment,
        )
        assert self._line(self._child, START) == "ready\n", "the child process did not start"
        return self._child

    @staticmethod
    def _line(child: subprocess.Popen[str], seconds: float) -> str | None:
        """Return the next line, an empty one after the end of the process, None after the time."""
        with selectors.DefaultSelector() as selector:
            selector.register(child.stdout, selectors.EVENT_READ)
            if not selector.select(seconds):
                return None
        return child.stdout.readline()

    def _end(self) -> None:
        if self._child is not None:
            self._child.kill()
            self._child.wait()
            self._child.stdin.close()
            self._child.stdout.close()
            self._child = None
