"""Solutions without the program of their solver, and on their way between processes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from operator import is_
from typing import Any, ClassVar, Protocol, TypeVar, cast

from robotraj._util.lazy_values import LazySequence
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.costates.duals import PhaseDuals
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solvers.base import Multipliers
from robotraj.solvers.kept_multipliers import KeptMultipliers
from robotraj.transcription.shooting.explicit_dynamics import explicit


class _OfProblem(Protocol):
    """The parts of a ``Solution`` that refer to its problem or its program."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def problem(self) -> Problem: ...

    @property
    def phases(self) -> tuple[PhaseSolution, ...]: ...

    @property
    def multipliers(self) -> Multipliers | None: ...

    @property
    def duals(self) -> Sequence[PhaseDuals]: ...


S = TypeVar("S", bound=_OfProblem)


def released(solution: S) -> S:
    """Return a solution that holds raw multipliers in place of the program, from which they are computed when read.

    Without rows on distances the solution takes a tenth of the memory then. With them it is returned as it is: their
    planes belong to the motion that the solver followed, so its program cannot be built again.
    """
    from robotraj.solvers.kept_multipliers import KeptMultipliers

    known = solution.multipliers
    if known is None or isinstance(known, KeptMultipliers):
        return solution
    kept = KeptMultipliers.of(known)
    if kept is None:
        return solution
    duals = solution.duals
    if isinstance(duals, LazySequence) and not duals.found:
        duals = _lazy_duals(kept, len(duals))
    return replace(solution, multipliers=kept, duals=duals)


def detached(solution: S, problem: Problem) -> S:
    """Return a solution without its problem, to be sent to a process that has the problem.

    A solution of another problem, such as one with the best of several candidates, keeps its own.
    """
    solution = released(solution)
    pairs = zip(problem.phases, solution.problem.phases, strict=False)
    alike = (
        len(one.constraints) == len(other.constraints) and all(map(is_, one.constraints, other.constraints))
        for one, other in pairs
    )
    if not all(alike):
        return solution
    bare = tuple(replace(part, phase=cast("Phase", None)) for part in solution.phases)
    return _with_problem(replace(solution, problem=cast("Problem", None), phases=bare), None)


def attached(solution: S, problem: Problem) -> S:
    """Return a detached solution with its problem, in the form that its meshes transcribe."""
    given: Problem | None = solution.problem
    if given is not None:
        return solution
    problem = explicit(problem, [part.mesh for part in solution.phases])
    pairs = zip(solution.phases, problem.phases, strict=True)
    whole = replace(solution, problem=problem, phases=tuple(replace(part, phase=phase) for part, phase in pairs))
    return _with_problem(whole, problem)


def _with_problem(solution: S, problem: Problem | None) -> S:
    """Return a solution whose raw multipliers have another problem, or none on their way."""
    from robotraj.solvers.kept_multipliers import KeptMultipliers

    known = solution.multipliers
    if not isinstance(known, KeptMultipliers):
        return solution
    kept, duals = known.of_problem(problem), solution.duals
    if isinstance(duals, LazySequence) and not duals.found:
        duals = _lazy_duals(kept, len(duals))
    return replace(solution, multipliers=kept, duals=duals)


def _lazy_duals(kept: KeptMultipliers, count: int) -> Sequence[PhaseDuals]:
    return LazySequence(cast("Callable[[], Sequence[PhaseDuals]]", partial(_duals, kept)), count, travels=True)


def _duals(kept: KeptMultipliers) -> Sequence[PhaseDuals]:
    from robotraj.solution.costates.covector import covectors

    return covectors(kept.nlp, kept.w, kept)
