"""Limits of the operating system on one task of a worker process, beside those that ``rt.plan`` reads itself.

A plan reads its limits between iterations. An equation that never returns, or that fills the memory, is ended here: by
timers whose signals end the process, and by a limit of its data.
"""

from __future__ import annotations

import resource
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from robotraj._util.values import dataclass

WALL, PROCESSOR, LATE = 3.0, 1.5, 5.0
"""Ratios of the timers to the time limit of a plan, and what both have beyond [s]: a plan stops by itself first."""
LARGER, ROOM = 1.2, 200.0
"""Ratio of the limit of data to the memory limit of a plan, and what it has beyond [MB]."""


@dataclass(frozen=True)
class CaseLimits:
    """Limits of one task.

    Attributes
    ----------
    seconds : float or None
        Time limit of the plan: processor time [s].
    megabytes : float or None
        Memory limit of the plan [MB].
    """

    seconds: float | None = None
    megabytes: float | None = None

    def __bool__(self) -> bool:
        """Whether there is a limit."""
        return self.seconds is not None or self.megabytes is not None

    @contextmanager
    def imposed(self) -> Iterator[None]:
        """Let the operating system end this process, or refuse it memory, beyond the limits."""
        soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
        if self.seconds is not None:
            signal.setitimer(signal.ITIMER_REAL, WALL * self.seconds + LATE)
            signal.setitimer(signal.ITIMER_PROF, PROCESSOR * self.seconds + LATE)
        if self.megabytes is not None:
            more = LARGER * self.megabytes + ROOM
            resource.setrlimit(resource.RLIMIT_DATA, (min(_data() + int(1e6 * more), _finite(hard)), hard))
        try:
            yield
        finally:
            for timer in (signal.ITIMER_REAL, signal.ITIMER_PROF):
                signal.setitimer(timer, 0.0)
            resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))


def _data() -> int:
    """Bytes of data beyond those that are resident: reserved, but not used."""
    try:
        entries = dict(line.split(":", 1) for line in Path("/proc/self/status").read_text().splitlines())
    except OSError:  # no Linux
        return 0
    data, used = (1024 * int(entries[name].split()[0]) for name in ("VmData", "RssAnon"))
    return max(0, data - used)


def _finite(limit: int) -> int:
    return 2**62 if limit == resource.RLIM_INFINITY else limit
