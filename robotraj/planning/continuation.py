"""Stages: easier problems solved first, each the guess of the next; the problem itself comes last."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from enum import Enum
from typing import Any

from robotraj._util.errors import InputError, unknown_name
from robotraj._util.values import dataclass
from robotraj.guess.base import InitialGuess
from robotraj.planning.solve import solve
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.records import ContinuationRecord
from robotraj.solution.settings import Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress, Solver
from robotraj.solvers.status import Status
from robotraj.transcription.schemes.mesh import Mesh


class Same(Enum):
    """What a stage does not change."""

    SAME = "same"


SAME = Same.SAME


@dataclass(frozen=True)
class ContinuationStep:
    """What differs in one stage; what is not given is as in the problem.

    Parameters
    ----------
    mesh : Mesh or sequence of Mesh, optional
        Of this stage.
    objective, constraints, limits, contacts : optional
        Of every phase, or a mapping from names of phases to theirs (phases not named stay as they are). None
        for ``objective`` looks for any feasible motion, for ``limits`` drops the joint limits; ``()`` for
        ``constraints`` and ``contacts`` drops those.
    solver : Solver, optional
        Of this stage.
    name : str

    Raises
    ------
    InputError
        What is given as mesh or solver is none.

    Examples
    --------
    >>> easier_first = [ContinuationStep(mesh=Mesh(10), constraints=(), name="coarse, without obstacles")]
    """

    mesh: Mesh | Sequence[Mesh] | None = None
    objective: Any = SAME
    constraints: Any = SAME
    limits: Any = SAME
    contacts: Any = SAME
    solver: Solver | None = None
    name: str = ""

    def __post_init__(self) -> None:
        several = isinstance(self.mesh, Sequence) and all(isinstance(mesh, Mesh) for mesh in self.mesh)
        if self.mesh is not None and not isinstance(self.mesh, Mesh) and not several:
            raise InputError(f"ContinuationStep(mesh) must be an rt.Mesh, or one for each phase; got {self.mesh!r}.")
        if self.solver is not None and not isinstance(self.solver, Solver):
            raise InputError(
                f"ContinuationStep(solver) must be a solver value such as rt.Ipopt(); got {self.solver!r}."
            )

    def of(self, problem: Problem) -> Problem:
        """Give the problem of this stage.

        Raises
        ------
        InputError
            A mapping names a phase that does not exist, or the changed phase cannot be posed.
        """
        names = [phase.name for phase in problem.phases]
        given = {key: getattr(self, key) for key in ("objective", "constraints", "limits", "contacts")}
        for value in given.values():
            for name in value if isinstance(value, Mapping) else ():
                if name not in names:
                    raise unknown_name("phase", name, names, "A stage changes phases by name.")
        changes = [_changes(given, phase) for phase in problem.phases]
        if not any(changes):
            return problem
        pairs = zip(problem.phases, changes, strict=True)
        return Problem([replace(phase, **change) for phase, change in pairs], problem.links)


def tightening(problem: Problem | Phase, relaxations: Sequence[float]) -> list[ContinuationStep]:
    """Stages that solve a problem with implicit contacts from loose to tight.

    Parameters
    ----------
    problem : Problem or Phase
        Its ``rt.contacts.ImplicitContact``s keep their own relaxation, the last and smallest, for the problem itself.
    relaxations : sequence of float
        Descending, such as ``[1.0, 0.1, 0.01]`` [N m, W].

    Raises
    ------
    InputError
        There is no implicit contact, or the relaxations do not descend.
    """
    from robotraj.dynamics.contacts.implicit import ImplicitContact

    phases = (problem,) if isinstance(problem, Phase) else problem.phases
    if not any(isinstance(contact, ImplicitContact) for phase in phases for contact in phase.contacts):
        raise InputError(
            "rt.planning.tightening is for phases with contacts=[rt.contacts.ImplicitContact(...)]; there is none."
        )
    if any(b >= a for a, b in zip(relaxations[:-1], relaxations[1:], strict=True)):
        raise InputError(f"The relaxations of rt.planning.tightening must descend; got {list(relaxations)}.")

    def loosened(contact: Any, e: float) -> Any:
        return replace(contact, relaxation=e) if isinstance(contact, ImplicitContact) else contact

    return [
        ContinuationStep(
            contacts={p.name: [loosened(c, e) for c in p.contacts] for p in phases}, name=f"relaxation {e:g}"
        )
        for e in relaxations
    ]


def _changes(given: Mapping[str, Any], phase: Phase) -> dict[str, Any]:
    mine = {key: value.get(phase.name, SAME) if isinstance(value, Mapping) else value for key, value in given.items()}
    return {key: value for key, value in mine.items() if value is not SAME}


def run_steps(
    problem: Problem,
    continuation: Sequence[ContinuationStep],
    guess: InitialGuess | Solution | None,
    settings: Settings,
    progress: Progress | None = None,
) -> tuple[InitialGuess | Solution | None, tuple[ContinuationRecord, ...], Solution | None]:
    """Solve the stages in order; return the guess they leave for the problem itself, and what each did.

    A stage that fails is recorded, and the next one starts from where the failed one had started. One that is
    interrupted is the last; its solution comes third, that of the stage before where it has none yet, None where all
    went on.

    Parameters
    ----------
    problem : Problem
    continuation : sequence of ContinuationStep
    guess : InitialGuess, Solution or None
        Of the first step.
    settings : Settings
        Of steps that do not bring a mesh or solver of their own.
    progress : callable, optional
    """
    if not isinstance(continuation, Sequence):
        raise InputError(
            f"continuation= is a list of rt.planning.ContinuationStep(...); got {type(continuation).__name__}."
        )
    for i, stage in enumerate(continuation):
        if not isinstance(stage, ContinuationStep):
            raise InputError(
                f"continuation= is a list of rt.planning.ContinuationStep(...); number {i} is a {type(stage).__name__}."
            )
    # A stage that cannot be posed is told before any is solved.
    posed = [stage.of(problem) for stage in continuation]
    solution: Solution | None = None
    records: list[ContinuationRecord] = []
    for i, (stage, easier) in enumerate(zip(continuation, posed, strict=True)):
        try:
            own = replace(settings, mesh=stage.mesh or settings.mesh, solver=stage.solver or settings.solver)
            solution = solve(easier, guess, own, progress)
        except KeyboardInterrupt:
            found = found_by(records, guess) or solution
            if found is None:
                raise
            return guess, tuple(records), replace(found, status=Status.INTERRUPTED)
        records.append(
            ContinuationRecord(
                stage.name or f"stage {i + 1}",
                solution.status,
                solution.objective,
                solution.iterations,
                solution.seconds,
            )
        )
        if solution.status is Status.INTERRUPTED:
            return guess, tuple(records), solution
        if solution.success:
            guess = solution
    return guess, tuple(records), None


def found_by(records: Sequence[ContinuationRecord], guess: InitialGuess | Solution | None) -> Solution | None:
    """Give the last solution of the stages, as interrupted, for Ctrl-C where no solver waits for it.

    Parameters
    ----------
    records : sequence of ContinuationRecord
    guess : InitialGuess, Solution or None
        That the stages left.

    Returns
    -------
    Solution or None
        None where no stage was solved.
    """
    if not isinstance(guess, Solution) or all(record.status is not Status.SOLVED for record in records):
        return None
    return replace(guess, status=Status.INTERRUPTED)
