"""Links between phases: continuity, jumps, periodicity, mirror symmetry and the rows of users, at the ends of phases.

The momentum and the cones of an impact are checked in ``contacts/impact.py``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.dynamics.point import Point
from robotraj.dynamics.row import Row
from robotraj.dynamics.variable import Named, Scalar
from robotraj.problem.links.base import BoundLink, Ends
from robotraj.problem.links.periodic import Repeat
from robotraj.problem.links.touchdown import Touchdown
from robotraj.solution.violation import Violation
from robotraj.witness.checks.points import end_of
from robotraj.witness.checks.watch import Watch
from robotraj.witness.numbers import as_numbers
from robotraj.witness.plants.sizes import named_sizes
from robotraj.witness.protocols import SolutionLike


def link_violations(solution: SolutionLike) -> tuple[Violation, ...]:
    """Evaluate all links at the ends of their phases; return the violated rows, the worst first.

    Raises
    ------
    InputError
        The expression of a link does not return numbers, or not one for each row.
    """
    found: list[Violation] = []
    given = tuple(solution.problem.links)
    sizes = named_sizes(solution)
    for k, bound in enumerate(solution.problem.bound_links):
        ends = [_ends(solution, i) for i in bound.phases]
        link = given[k] if k < len(given) else None
        if isinstance(link, Touchdown):
            rows, values = _placed(link, bound, solution, ends)
        else:
            names = [unknown.name for unknown in bound.unknowns]
            impulses = solution.impulses[k] if names else {}
            unknowns: Named[Scalar] = Named("unknown of the link", names, [float(impulses[name]) for name in names])
            rows, values = list(bound.rows), as_numbers(bound.expression(ends, unknowns), f"expression of {bound.name}")
        if len(values) != len(rows):
            raise InputError(f"The expression of {bound.name} gave {len(values)} numbers for its {len(rows)} rows.")
        time = float(np.asarray(solution.phases[bound.phases[0]].knots)[-1])
        phases = " to ".join(str(solution.phases[i].phase.name) for i in bound.phases)
        for row, value in zip(rows, values, strict=True):
            size = sizes[bound.phases[0]].get(row.joint or "") if row.name == "continuity" else None
            watch = Watch(row, size)
            watch.see(np.array([time]), np.array([value]))
            violation = watch.worst(phases)
            if violation is not None:
                found.append(violation)
    return tuple(sorted(found, key=lambda violation: -violation.relative))


def _ends(solution: SolutionLike, phase: int) -> Ends:
    planned = solution.phases[phase]
    return Ends(end_of(planned, 0)[1], end_of(planned, -1)[1])


def _placed(link: Touchdown, bound: BoundLink, solution: SolutionLike, ends: Sequence[Ends]) -> tuple[list[Row], Array]:
    """Evaluate the continuity of time and positions at a touchdown, displaced or mirrored as the link repeats."""
    before = solution.phases[bound.phases[0]].phase
    names = [state.name for state in before.body.states]
    repeat = Repeat.same(names) if link.repeat is None else link.repeat.of(before, names, bound.name)
    end: Point = ends[0].end
    start: Point = ends[1].start
    image, positions = repeat.image(end), sum(name.startswith("q.") for name in names)
    times = [start.t - end.t] if link.repeat is None else []
    places = [start.x[names[i]] - image[i] for i in repeat.bounded if i < positions]
    return [row for row in bound.rows if row.name == "continuity"], as_numbers([*times, *places], bound.name)
