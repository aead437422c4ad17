"""Settings of a plan: all options that the user may leave open, with the reason of every choice.

The values are chosen in ``robotraj.planning.settings``. They are defined here since a solution holds them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, fields

from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine, as_call, table
from robotraj._util.values import dataclass
from robotraj.native.engines.base import Engine
from robotraj.solution.proof import Goals
from robotraj.solvers.base import Solver
from robotraj.transcription.interval_limits.methods import ConstraintGeneration
from robotraj.transcription.refinement.base import Refinement
from robotraj.transcription.schemes.mesh import Mesh


@dataclass(frozen=True)
class Restarts(OneLine):
    """Further guesses for a problem that was not solved from its first guess.

    Parameters
    ----------
    count : int
        Largest number of starts that are tried: first longer motions, then variations. 0 turns restarts off.
    longer : sequence of float
        Factors by which guessed free durations are multiplied. For each factor a motion without objective is planned
        first, and is the guess of the problem. They need a free duration.
    seeds : sequence of int
        Seeds of random variations of the guess. A guess that is a solution is not varied.

    Raises
    ------
    InputError
        A negative number of starts, or a factor that is not above 0.
    """

    count: int = 5
    longer: Sequence[float] = (3.0, 9.0, 27.0)
    seeds: Sequence[int] = (0, 1)

    def __post_init__(self) -> None:
        if isinstance(self.count, bool) or not isinstance(self.count, int) or self.count < 0:
            raise InputError(f"Restarts(count) must be a whole number of 0 or more, got {self.count!r}.")
        object.__setattr__(self, "longer", tuple(float(factor) for factor in self.longer))
        object.__setattr__(self, "seeds", tuple(int(seed) for seed in self.seeds))
        if any(not factor > 0 for factor in self.longer):
            raise InputError(f"Restarts(longer) must hold factors above 0, got {self.longer}.")
        if any(seed < 0 for seed in self.seeds):
            raise InputError(f"Restarts(seeds) must hold whole numbers of 0 or more, got {self.seeds}.")


@dataclass(frozen=True)
class Settings(OneLine):
    """The settings of a plan. ``rt.plan(problem, settings=...)`` repeats it.

    Attributes
    ----------
    tolerance : float or None
        Relative error to which the mesh is refined; None solves on the given mesh alone.
    goals : Goals or None
        Bounds on the errors between the points; None where nothing is proved.
    mesh : Mesh or tuple of Mesh
        The first mesh: one for all phases, or one for each.
    solver : Solver
    engine : Engine
    interval_limits : ConstraintGeneration
        Method that imposes rows between collocation points.
    refinement : Refinement or None
        None where there is no tolerance.
    restarts : Restarts
    smoothing : float
        Weight of the mean square of bounded torques and accelerations beside a duration.
    reasons : mapping of str to str
        Why each of them was chosen, by name.
    """

    tolerance: float | None
    goals: Goals | None
    mesh: Mesh | Sequence[Mesh]
    solver: Solver
    engine: Engine
    interval_limits: ConstraintGeneration
    refinement: Refinement | None
    restarts: Restarts
    smoothing: float
    reasons: Mapping[str, str] = field(default_factory=dict)

    def __str__(self) -> str:
        names = [entry.name for entry in fields(self) if entry.name != "reasons"]
        rows = [(name, f"{as_call(getattr(self, name))}: {self.reasons.get(name, 'given')}") for name in names]
        return "\n".join(table(rows))
