"""Links of consecutive phases, with or without a jump of the state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field

import casadi as ca
import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.row import Row
from robotraj.dynamics.variable import Named
from robotraj.problem.augmentation import free_of
from robotraj.problem.constraints.base import ends_of
from robotraj.problem.constraints.bounds import Interval, as_bounds
from robotraj.problem.links.base import STATE, BoundLink, Carry, Ends, Link, check_order, normal, phase_at, same_states
from robotraj.problem.links.limited_rates import joined_rates
from robotraj.problem.phase import Phase
from robotraj.problem.scalars import Scalar

TIME = Row("continuity", "s", 0.0, 0.0, "time")
"""Continuity of time."""
SLOPE = 1e-9
"""Derivative of a row with respect to a time below which the row does not depend on it."""


@dataclass(frozen=True)
class Continuity(Link):
    """Time and state are continuous: t and x at the end of ``first`` equal t and x at the start of ``second``.

    Under limits of jerk or torque rate on both phases, accelerations or torques are continuous too; from path to path,
    the acceleration along it.
    """

    first: int
    second: int

    def bind(self, phases: Sequence[Phase]) -> BoundLink:
        """Write one row of time and one per state.

        Raises
        ------
        InputError
            The phases do not exist or have different states.
        """
        bound = _follow(phases, self.first, self.second, {}, f"Continuity({self.first}, {self.second})")
        before, after = (phases[i] for i in bound.phases)
        return bound.with_rates(joined_rates(before, after), 0, 1)


@dataclass(frozen=True)
class Jump(Link):
    """Time is continuous and named states jump: x(start of second) - x(end of first) = jump.

    Parameters
    ----------
    first, second : int
    jumps : mapping of str to number, Between or None
        Jump by state name, ``"v"`` or ``"v.elbow"``: a number, bounds, or None for any jump. The other states are
        continuous.
    """

    first: int
    second: int
    jumps: Mapping[str, Interval] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not isinstance(self.jumps, Mapping):
            raise InputError(
                f"jumps of Jump({self.first}, {self.second}) must map names of states to their jumps, such as "
                f"{{'v': -1.0}}; got {self.jumps!r}."
            )
        super().__post_init__()

    def bind(self, phases: Sequence[Phase]) -> BoundLink:
        """Write one row of time and one per state that is not free to jump."""
        return _follow(phases, self.first, self.second, self.jumps, f"Jump({self.first}, {self.second})")


def _follow(phases: Sequence[Phase], first: int, second: int, jumps: Mapping[str, Interval], what: str) -> BoundLink:
    before, after = phase_at(phases, first, what), phase_at(phases, second, what)
    check_order(phases, first, second, what)
    names, units = same_states(before, after, what), [state.unit for state in free_of(before.body).states]
    bounds = as_bounds({name: 0.0 for name in names} | dict(jumps), names, f"jumps of {what}", "state")
    kept = [i for i, (low, high) in enumerate(zip(*bounds, strict=True)) if not (low == -float("inf") and high == -low)]
    kind = {i: "jump" if names[i] in jumps else "continuity" for i in kept}
    rows = (TIME,) + tuple(
        Row(kind[i], units[i], float(bounds.lower[i]), float(bounds.upper[i]), names[i]) for i in kept
    )

    def expression(ends: Sequence[Ends], _: Mapping[str, Scalar]) -> list[Scalar]:
        end, start = ends[0].end, ends[1].start
        return [start.t - end.t, *(start.x[names[i]] - end.x[names[i]] for i in kept)]

    pair = normal(phases, first), normal(phases, second)
    on_path = any(phase.path is not None for phase in (before, after))
    carries = () if jumps or on_path else (Carry(*pair, STATE),)
    return BoundLink(what, pair, rows, expression, carries=carries)


def running_on(phases: Sequence[Phase], links: Sequence[BoundLink]) -> tuple[BoundLink, ...]:
    """Make time continuous into every phase whose start time no link determines.

    Otherwise the phases could overlap or leave gaps between them.
    """
    return tuple(_time(i) for i in range(1, len(phases)) if not any(_times(link, i, phases) for link in links))


def _time(second: int) -> BoundLink:
    pair = second - 1, second
    return BoundLink(f"time{pair}", pair, (TIME,), lambda ends, _: [ends[1].start.t - ends[0].end.t])


def _times(link: BoundLink, index: int, phases: Sequence[Phase]) -> bool:
    """Whether a link determines the start time of a phase: it depends on the time, not on the duration alone."""
    if index not in link.phases:
        return False
    if TIME in link.rows:
        return link.phases[-1] == index
    ends = [Ends(*ends_of(phases[i].dae, phases[i].parameter_names, inner=True)) for i in link.phases]
    own = Named("unknown of the link", [v.name for v in link.unknowns], ca.SX.sym("own", len(link.unknowns)))
    y = ca.vertcat(*link.values(ends, own))
    here = ends[link.phases.index(index)]
    by_start, by_end = (ca.jacobian(y, point.t) for point in here)
    slopes = ca.horzcat(by_start, by_start + by_end)
    free = ca.vertcat(*ca.symvar(slopes), ca.SX(0, 1))
    values = ca.Function("slopes", [free], [slopes])(np.random.default_rng(0).uniform(0.5, 1.5, free.numel())).full()
    return bool(np.all(np.abs(values).max(axis=0, initial=0.0) > SLOPE))
