"""A warning before planning: phases that no link joins to an earlier one."""

from __future__ import annotations

import numpy as np

from robotraj._util.errors import warn
from robotraj.problem.links.continuity import TIME
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem


def warn_of_unlinked_phases(problem: Problem) -> None:
    """Warn of phases with the states of the one before that no link and no equal given states join to an earlier one.

    Warns
    -----
    UserWarning
        Names both phases and the link that is mostly meant.
    """
    joined = [link.phases for link in problem.bound_links if any(row is not TIME for row in link.rows)]
    for i, phase in enumerate(problem.phases[1:], 1):
        before = problem.phases[i - 1]
        linked = any(i in each and min(each) < i for each in joined)
        if linked or before.body.states != phase.body.states or _meet(before, phase):
            continue
        warn(
            f"Phases {before.name!r} and {phase.name!r} are not linked, so that the state may jump between them. Give "
            f"rt.Problem(phases, links=[rt.Continuity({i - 1}, {i})])."
        )


def _meet(before: Phase, after: Phase) -> bool:
    """Whether the given end of a phase is the given start of the next one."""
    end, start = before.end_bounds, after.start_bounds
    given = (end.lower, end.upper, start.lower, start.upper)
    return all(np.array_equal(given[0], each) for each in given[1:])
