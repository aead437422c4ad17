"""Continuation: easier problems are solved first, each the guess of the next; the problem itself comes last."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from enum import Enum
from typing import TypeVar, cast

from robotraj._util.errors import InputError, unknown_name
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import Contact
from robotraj.fixed_mesh.solve import solve
from robotraj.problem.constraints.base import Constraint
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.objectives.base import Objective
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.limits import Limits
from robotraj.solution.records import ContinuationRecord
from robotraj.solution.settings import Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress, Solver
from robotraj.solvers.status import Status
from robotraj.transcription.schemes.mesh import Mesh


class Same(Enum):
    """Marks what a step leaves unchanged."""

    SAME = "same"


SAME = Same.SAME
T = TypeVar("T")


@dataclass(frozen=True)
class ContinuationStep(OneLine):
    """Changes of one continuation step; the rest is as in the problem.

    Parameters
    ----------
    mesh : Mesh or sequence of Mesh, optional
        Mesh of this step.
    objective, constraints, limits, contacts : optional
        Values for every phase, or a mapping by name of the phase; phases that it does not name keep theirs.
        ``objective=None`` finds any feasible motion. ``limits=None`` drops the joint limits, and ``()`` drops
        ``constraints`` or ``contacts``.
    solver : Solver, optional
        Solver of this step.
    name : str
        Name in the record of this step.

    Raises
    ------
    InputError
        ``mesh`` or ``solver`` has another type.

    Examples
    --------
    >>> easier_first = [ContinuationStep(mesh=Mesh(10), constraints=(), name="coarse, without obstacles")]
    """

    mesh: Mesh | Sequence[Mesh] | None = None
    objective: Objective | Mapping[str, Objective | None] | Same | None = SAME
    constraints: Sequence[Constraint] | Mapping[str, Sequence[Constraint]] | Same = SAME
    limits: Limits | Mapping[str, Limits | None] | Same | None = SAME
    contacts: Sequence[Contact] | Mapping[str, Sequence[Contact]] | Same = SAME
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
        """Return the problem of this step.

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
                    raise unknown_name("phase", name, names, "A continuation step changes phases by name.")
        if not any(_changes(value, phase) for value in given.values() for phase in problem.phases):
            return problem
        phases = [
            replace(
                phase,
                objective=_chosen(self.objective, phase, phase.objective),
                constraints=_chosen(self.constraints, phase, phase.constraints),
                limits=_chosen(self.limits, phase, phase.limits),
                contacts=_chosen(self.contacts, phase, phase.contacts),
            )
            for phase in problem.phases
        ]
        return Problem(phases, problem.links)


def tightening(problem: Problem | Phase, relaxations: Sequence[float]) -> list[ContinuationStep]:
    """Return steps that solve a problem with implicit contacts from loose to tight.

    Parameters
    ----------
    problem : Problem or Phase
        The problem itself keeps the relaxations of its ``rt.contacts.ImplicitContact``s, which are the smallest.
    relaxations : sequence of float
        Descending relaxations, such as ``[1.0, 0.1, 0.01]`` [N m, W].

    Returns
    -------
    list of ContinuationStep
        For ``rt.plan(problem, continuation=...)``.

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

    def loosened(contact: Contact, e: float) -> Contact:
        return replace(contact, relaxation=e) if isinstance(contact, ImplicitContact) else contact

    return [
        ContinuationStep(
            contacts={p.name: [loosened(c, e) for c in p.contacts] for p in phases}, name=f"relaxation {e:g}"
        )
        for e in relaxations
    ]


def _changes(given: object, phase: Phase) -> bool:
    return phase.name in given if isinstance(given, Mapping) else given is not SAME


def _chosen(given: object, phase: Phase, own: T) -> T:
    """Return the value for a phase, its own where the step does not change it."""
    if not _changes(given, phase):
        return own
    return cast("T", given[phase.name] if isinstance(given, Mapping) else given)


def run_steps(
    problem: Problem,
    continuation: Sequence[ContinuationStep],
    guess: InitialGuess | Solution | None,
    settings: Settings,
    progress: Progress | None = None,
) -> tuple[InitialGuess | Solution | None, tuple[ContinuationRecord, ...], Solution | None]:
    """Solve the steps in order, each from the solution of the last one that was solved.

    A step that fails is recorded, and the next one starts from the same guess. A step that is interrupted is the last.

    Parameters
    ----------
    problem : Problem
    continuation : sequence of ContinuationStep
    guess : InitialGuess, Solution or None
        Guess of the first step.
    settings : Settings
        Settings of every step; the mesh and solver of a step replace them.
    progress : callable, optional

    Returns
    -------
    guess : InitialGuess, Solution or None
        Guess for the problem itself.
    records : tuple of ContinuationRecord
        One for each step that was run.
    interrupted : Solution or None
        Solution of the interrupted step or, without one, of the step before it; None if no step was interrupted.

    Raises
    ------
    InputError
        ``continuation`` is no list of steps, or a step cannot be posed.
    """
    if not isinstance(continuation, Sequence):
        raise InputError(
            f"continuation= is a list of rt.planning.ContinuationStep(...); got {type(continuation).__name__}."
        )
    for i, step in enumerate(continuation):
        if not isinstance(step, ContinuationStep):
            raise InputError(
                f"continuation= is a list of rt.planning.ContinuationStep(...); number {i} is a {type(step).__name__}."
            )
    # A step that cannot be posed raises before any is solved.
    posed = [step.of(problem) for step in continuation]
    solution: Solution | None = None
    records: list[ContinuationRecord] = []
    for i, (step, easier) in enumerate(zip(continuation, posed, strict=True)):
        try:
            own = replace(settings, mesh=step.mesh or settings.mesh, solver=step.solver or settings.solver)
            solution = solve(easier, guess, own, progress)
        except KeyboardInterrupt:
            found = last_solution(records, guess) or solution
            if found is None:
                raise
            return guess, tuple(records), replace(found, status=Status.INTERRUPTED)
        records.append(
            ContinuationRecord(
                step.name or f"step {i + 1}",
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


def last_solution(records: Sequence[ContinuationRecord], guess: InitialGuess | Solution | None) -> Solution | None:
    """Return the solution of the last step that was solved, with the status of an interrupted plan.

    Parameters
    ----------
    records : sequence of ContinuationRecord
    guess : InitialGuess, Solution or None
        Guess that ``run_steps`` returned.

    Returns
    -------
    Solution or None
        None where no step was solved.
    """
    if not isinstance(guess, Solution) or all(record.status is not Status.SOLVED for record in records):
        return None
    return replace(guess, status=Status.INTERRUPTED)
