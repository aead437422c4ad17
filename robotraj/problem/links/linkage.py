"""Links by user expressions of the ends of phases."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from robotraj._util.errors import InputError, unknown_name
from robotraj._util.values import dataclass
from robotraj.dynamics.expression_values import rows_of
from robotraj.dynamics.row import Row
from robotraj.problem.constraints.base import ends_of
from robotraj.problem.constraints.bounds import SideLike
from robotraj.problem.constraints.path import flat, side
from robotraj.problem.links.base import BoundLink, Ends, Link, normal, phase_at
from robotraj.problem.phase import Phase
from robotraj.problem.scalars import Scalar, Scalars


@dataclass(frozen=True)
class Linkage(Link):
    """lower <= expression(*ends of the phases) <= upper.

    Parameters
    ----------
    phases : sequence of int
        The phases whose ends are the arguments.
    expression : callable
        ``lambda a, b: b.start.x["v"] + 0.8 * a.end.x["v"]``: one argument per phase, with ``.start`` and ``.end``.
    lower, upper : float or sequence, optional
        Bounds; both 0 by default.
    name, unit : str
        Label and SI unit, for reports.
    """

    phases: Sequence[int]
    expression: Callable[..., Scalars]
    lower: SideLike = 0.0
    upper: SideLike = 0.0
    name: str = "linkage"
    unit: str = ""

    def __post_init__(self) -> None:
        if not isinstance(self.phases, Sequence):
            raise InputError(
                f"Linkage: phases is {self.phases!r}; it must be a sequence of phases, such as (0, 1). The expression "
                "follows it: Linkage((0, 1), lambda a, b: ...)."
            )
        super().__post_init__()

    def bind(self, phases: Sequence[Phase]) -> BoundLink:
        """Try the expression on symbols and pair its rows with bounds."""
        chosen = [phase_at(phases, i, f"linkage {self.name!r}") for i in self.phases]
        symbols = [Ends(*ends_of(phase.dae, phase.parameter_names)) for phase in chosen]
        what = f"expression of link {self.name!r}"
        count = len(rows_of(what, self.expression, *symbols))
        lower, upper = (
            side(self.lower, -float("inf"), count, self.name),
            side(self.upper, float("inf"), count, self.name),
        )
        names = [self.name] if count == 1 else [f"{self.name}[{i}]" for i in range(count)]
        rows = tuple(Row(n, self.unit, low, high) for n, low, high in zip(names, lower, upper, strict=True))
        user = self.expression
        return BoundLink(
            self.name, tuple(normal(phases, i) for i in self.phases), rows, lambda ends, _: flat(user(*ends))
        )


@dataclass(frozen=True)
class EqualDuration(Link):
    """Two phases have the same duration."""

    first: int
    second: int

    def bind(self, phases: Sequence[Phase]) -> BoundLink:
        """Write one row of time."""

        def difference(a: Ends, b: Ends) -> Scalar:
            return (b.end.t - b.start.t) - (a.end.t - a.start.t)

        return Linkage((self.first, self.second), difference, name="equal duration", unit="s").bind(phases)


@dataclass(frozen=True)
class SameParameter(Link):
    """A parameter that several phases declare under one name has one value: a static parameter.

    Parameters
    ----------
    name : str
    phases : sequence of int, optional
        Every phase that declares it, by default.
    """

    name: str
    phases: Sequence[int] | None = None

    def bind(self, phases: Sequence[Phase]) -> BoundLink:
        """Write one row for each neighbouring pair of phases."""
        sharing = self.phases
        if sharing is None:
            sharing = [i for i, phase in enumerate(phases) if self.name in phase.parameters]
        what = f"SameParameter({self.name!r})"
        for i in sharing:
            phase = phase_at(phases, i, what)
            if self.name not in phase.parameters:
                advice = f"{what} needs it in phase {phase.name!r}."
                raise unknown_name("parameter", self.name, phase.parameters, advice)
        if len(sharing) < 2:
            raise InputError(f"{what}: {len(sharing)} phase(s) declare it; at least two phases must.")
        name = self.name

        def differences(*ends: Ends) -> list[Scalar]:
            return [b.start.p[name] - a.start.p[name] for a, b in zip(ends[:-1], ends[1:], strict=True)]

        return Linkage(sharing, differences, name=f"same parameter {name}").bind(phases)
