"""What the robotraj scripts share: the report of a solution."""

from __future__ import annotations

import numpy as np
from report import Report, inside

import robotraj as rt


def finish(solution: rt.Solution) -> None:
    """Stop the clock and hand back the solution."""
    report = Report(solution.times["solve"], solution.iterations, solution.success, solution.status.value)
    part = solution.phases[0]
    t = inside(part.knots)
    samples = [part.at(times, interval=k) for k, times in enumerate(t)]
    report.write(t, *(np.array([getattr(s, name) for s in samples]) for name in ("q", "v", "tau")))
