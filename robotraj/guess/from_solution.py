"""An earlier solution as a guess: a warm start."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol, TypeGuard

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.variable import Variable
from robotraj.guess.ends import default_parameters
from robotraj.problem.initial_guess import Curve, InitialGuess, PhaseGuess
from robotraj.problem.links.base import BoundLink
from robotraj.problem.phase import Phase


class SolvedPhase(Protocol):
    """The motion of one phase, as ``rt.solution.PhaseSolution`` has it."""

    @property
    def phase(self) -> Phase: ...  # noqa: D102
    @property
    def t0(self) -> float: ...  # noqa: D102
    @property
    def duration(self) -> float: ...  # noqa: D102
    @property
    def parameters(self) -> dict[str, float]: ...  # noqa: D102
    def columns(self, times: Array, names: Sequence[str]) -> list[Array]: ...  # noqa: D102


class SolvedProblem(Protocol):
    """The motion of all phases, as ``rt.Solution`` has it; that class belongs to a higher room."""

    @property
    def phases(self) -> Sequence[SolvedPhase]: ...  # noqa: D102
    @property
    def impulses(self) -> Sequence[Mapping[str, float]]: ...  # noqa: D102


@dataclass(frozen=True)
class FromSolution(InitialGuess):
    """An earlier solution on any mesh and scheme; variables are matched by name.

    Parameters
    ----------
    solution : Solution
    """

    solution: SolvedProblem

    def __post_init__(self) -> None:
        if not is_solution(self.solution):
            raise InputError(
                f"FromSolution takes a Solution, got {type(self.solution).__name__}; pass what rt.plan returns."
            )

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Sample the earlier solution's phase of the same index.

        Raises
        ------
        InputError
            The earlier solution has no such phase, or none of its states.
        """
        known = self.solution.phases
        if index >= len(known):
            raise InputError(
                f"The guess is a solution of {len(known)} phases, but phase {phase.name!r} is number {index}; give one "
                "with as many phases."
            )
        source = known[index]
        given, wanted = ([v.name for v in each.dae.states] for each in (source.phase, phase))
        if not set(given) & set(wanted):
            raise InputError(
                f"The guess has none of the states of phase {phase.name!r}: it is a motion of {', '.join(given)}, "
                f"not of {', '.join(wanted)}. Start from a solution of the same robot or system, or from "
                "rt.guess.StraightLine()."
            )
        low, high = phase.duration_bounds
        fallback = default_parameters(phase)
        return PhaseGuess(
            float(np.clip(source.duration, low, high)),
            _sampled(source, phase.dae.states),
            _sampled(source, phase.dae.algebraic),
            _sampled(source, phase.dae.controls),
            {name: source.parameters.get(name, value) for name, value in fallback.items()},
        )

    def of_link(self, link: BoundLink, index: int) -> Mapping[str, float]:
        """Return the impulses of the earlier solution's link of the same index."""
        known = self.solution.impulses
        return known[index] if index < len(known) else {}


def is_solution(value: object) -> TypeGuard[SolvedProblem]:
    """Return whether a value has the attributes of ``rt.Solution``."""
    return hasattr(value, "phases") and hasattr(value, "status")


def _sampled(source: SolvedPhase, variables: Sequence[Variable]) -> Curve:
    def curve(s: Array) -> Array:
        times = source.t0 + np.asarray(s) * source.duration
        columns = source.columns(times, [v.name for v in variables])
        return np.column_stack(columns) if columns else np.zeros((len(times), 0))

    return curve
