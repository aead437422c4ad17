"""What a plan knows and solves next, and what a solve found: the values that ``respond`` maps to the next state."""

from __future__ import annotations

from dataclasses import replace
from enum import Enum

from robotraj._util.values import dataclass
from robotraj.fixed_mesh.sizes.shares import shares_of
from robotraj.fixed_mesh.sizes.soft_kinks import with_soft_kinks
from robotraj.planning.loop.measures import LEAST_GROWTH, Measured, proof_on
from robotraj.planning.loop.tolerance_state import Errors, ToleranceState
from robotraj.planning.proving.soft_friction import softening_of
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.proof import Proof
from robotraj.solution.records import Lack, MeshStep
from robotraj.solution.settings import Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.status import Status
from robotraj.transcription.interval_limits.full_friction import has_full_friction
from robotraj.transcription.refinement.equidistribution import Equidistribute
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.transcribe import meshes_of

Meshes = tuple[Mesh, ...]
"""The mesh of every phase."""


class Task(Enum):
    """What a solve is for."""

    SOFTER = "with softer friction"
    MESH = "on the next mesh"
    LIMITS = "with limits between the points"
    SWITCHES = "with knots at the switches"
    SMOOTHER = "with smoother controls"
    AGAIN = "from the plan, on the first mesh"
    BETTER = "from what the first mesh gained"


@dataclass(frozen=True)
class Traits:
    """What the terms of a problem are like.

    Attributes
    ----------
    sticking : bool
        Whether joints stick and slide to save effort.
    kinked : bool
        Whether the objective has kinks that matter.
    rubbing : bool
        Whether dry friction matters in a least time.
    full_friction : bool
        Whether limits of torques between the points are those against full dry friction, on every mesh.
    """

    sticking: bool = False
    kinked: bool = False
    rubbing: bool = False
    full_friction: bool = False

    @classmethod
    def of(cls, problem: Problem) -> Traits:
        """Return those of a problem."""
        shares = shares_of(problem)
        full = any(map(has_full_friction, problem.phases))
        return cls(shares.sticking, shares.kinked, full and shares.rubbing, full)

    @property
    def patient(self) -> bool:
        """Whether many meshes pay where only the objective of a proved motion has not settled."""
        return self.sticking and not self.kinked

    @property
    def sticking_powers(self) -> bool:
        """Whether joints stick and slide and the objective has kinks, as powers have where they change their sign."""
        return self.sticking and self.kinked


def step_of(found: Solution, error: float) -> MeshStep:
    """Return the record of the mesh of a solution with this error."""
    points, intervals = sum(len(part.points) for part in found.phases), sum(part.mesh.count for part in found.phases)
    return MeshStep(intervals, points, error, found.objective, found.iterations, found.seconds)


@dataclass(frozen=True, eq=False)
class MeasuredMotion:
    """A solution with its proof and its measures.

    Attributes
    ----------
    solution : Solution
    measures : Measured
    limited : bool
        Whether limits were imposed between its points.
    stopped_early : bool
        Whether the solver stopped before its tolerance, or that is too large.
    """

    solution: Solution
    measures: Measured
    limited: bool
    stopped_early: bool

    @property
    def meshes(self) -> Meshes:
        """Mesh of every phase."""
        return tuple(part.mesh for part in self.solution.phases)

    @property
    def proof(self) -> Proof:
        """Proof of the solution."""
        assert self.solution.proof is not None
        return self.solution.proof

    @property
    def motion_holds(self) -> bool:
        """Whether it is a motion within its limits, settled or not."""
        return self.proof.motion_holds

    def with_unsettled(self, share: float) -> MeasuredMotion:
        """Return the motion with another share of the objective that is left to gain."""
        return replace(self, solution=replace(self.solution, proof=replace(self.proof, unsettled=share)))

    @property
    def step(self) -> MeshStep:
        """The record of its mesh."""
        return step_of(self.solution, self.proof.error)


@dataclass(frozen=True, eq=False)
class Found:
    """What one solve found.

    Attributes
    ----------
    solution : Solution
    measures : Measured or None
        None where the solve failed.
    limited : bool
        Whether limits were imposed between the points.
    lacks : tuple of Lack
        The measures that are beyond their goals.
    stopped_early : bool
        Whether the solver stopped before its tolerance, or that is too large.
    gained : float
        Share of the objective that a solve from the plan gained on the first mesh.
    errors : Errors or None
        Errors of a solve to a tolerance.
    """

    solution: Solution
    measures: Measured | None = None
    limited: bool = False
    lacks: tuple[Lack, ...] = ()
    stopped_early: bool = False
    gained: float = 0.0
    errors: Errors | None = None

    @property
    def motion(self) -> MeasuredMotion | None:
        """The solution with its proof; None where the solve failed."""
        if self.measures is None:
            return None
        return MeasuredMotion(
            replace(self.solution, proof=self.measures.proof), self.measures, self.limited, self.stopped_early
        )


@dataclass(frozen=True, eq=False)
class PlanState:
    """What a plan knows, and what it solves next.

    Attributes
    ----------
    problem, settings
        The problem, with rounded kinks where their share is small, and settings with goals and a refinement.
    sharp : Problem
        The problem with its own kinks.
    traits : Traits
    guess : InitialGuess, Solution or None
        Guess of the plan, until there is a solution.
    meshes : tuple of Mesh
        Meshes of the next solve.
    second : float
        Growth from the first mesh to the second.
    task : Task
    softening : tuple of float
        Factors of softer friction that are still to be solved, the next one first.
    start : Solution or None
        Where the next solve starts, if not from the best motion or the guess.
    gained : float
        Share of the objective that ``start`` gained over the best motion.
    number : int
        Number of meshes before the next one.
    best, first : MeasuredMotion or None
        The best solution so far, and the first one, whose program is solved again from the plan.
    failed : Solution or None
        The last solve that failed, until there is a solution.
    steps : tuple of MeshStep
    afresh : bool
        Whether the plan began again from the guess, on a finer mesh.
    stagnant : int
        Meshes in a row on which an error stagnated.
    neighbour : Proof or None
        Proof of a similar problem on the first mesh, whose solution is the guess.
    is_brief : bool
        Whether the plan ends with the first solve that fails.
    why : str
        The response that led to this state.
    """

    problem: Problem
    sharp: Problem
    settings: Settings
    traits: Traits
    guess: InitialGuess | Solution | None
    meshes: Meshes
    second: float = LEAST_GROWTH
    task: Task = Task.MESH
    softening: tuple[float, ...] = ()
    start: Solution | None = None
    gained: float = 0.0
    number: int = 0
    best: MeasuredMotion | None = None
    first: MeasuredMotion | None = None
    failed: Solution | None = None
    steps: tuple[MeshStep, ...] = ()
    afresh: bool = False
    stagnant: int = 0
    neighbour: Proof | None = None
    is_brief: bool = False
    why: str = ""

    @property
    def coarsest(self) -> Meshes:
        """Meshes of the settings."""
        return meshes_of(self.problem, self.settings.mesh)

    @property
    def approximates(self) -> bool:
        """Whether the next mesh only approximates the motion, from which a finer one finds the optimum."""
        return self.task is Task.MESH and self.number == 0 and self.neighbour is None

    @property
    def only_unsettled(self) -> bool:
        """Whether the best motion is proved on a second mesh or a later one, and only its objective has not settled."""
        return self.best is not None and self.best.measures.only_unsettled

    @property
    def is_softened(self) -> bool:
        """Whether the guess is the solution with softer friction."""
        return self.traits.sticking and isinstance(self.guess, Solution) and self.guess.proof is None

    @property
    def begin(self) -> InitialGuess | Solution | None:
        """Where the next solve starts."""
        return self.start or (self.guess if self.best is None else self.best.solution)

    @property
    def kept(self) -> Solution:
        """The best motion or else the last solve. A motion beyond its limits has ``Status.NOT_PROVED``."""
        best = self.best
        if best is None:
            assert self.failed is not None
            return replace(self.failed, refinement=self.steps)
        status = best.solution.status
        if status is Status.SOLVED and not best.motion_holds:
            status = Status.NOT_PROVED
        return replace(best.solution, status=status, refinement=self.steps)


@dataclass(frozen=True, eq=False)
class PlanEnd:
    """The end of a plan, and why."""

    state: PlanState | ToleranceState
    why: str

    @property
    def solution(self) -> Solution:
        """What the plan returns."""
        return self.state.kept


def begin(
    problem: Problem, guess: InitialGuess | Solution | None, settings: Settings, is_brief: bool = False
) -> PlanState | ToleranceState:
    """Return the first state of a plan."""
    meshes, refinement = meshes_of(problem, settings.mesh), settings.refinement
    if settings.goals is None:
        return ToleranceState(problem, settings, guess, meshes)
    traits = Traits.of(problem)
    second = refinement.second if isinstance(refinement, Equidistribute) else LEAST_GROWTH
    soft = with_soft_kinks(problem, settings.goals, settings.smoothing)
    neighbour = proof_on(guess, meshes)
    state = PlanState(soft, problem, settings, traits, guess, meshes, second, neighbour=neighbour, is_brief=is_brief)
    known = guess if isinstance(guess, Solution) and neighbour is not None else None
    softening = softening_of(problem, known)
    return replace(state, task=Task.SOFTER, softening=softening) if softening else state
