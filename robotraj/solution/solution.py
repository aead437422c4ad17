"""Solutions: the collocated polynomials, the status of the solve, and violated rows."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.checks import is_whole
from robotraj._util.display import drawn
from robotraj._util.errors import InputError, no_attribute, no_entry
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import ENTRIES, OneLine, brief, plain
from robotraj._util.values import dataclass
from robotraj.problem.problem import Problem
from robotraj.solution.claims.claim import Claim
from robotraj.solution.claims.planned_claims import planned_claims
from robotraj.solution.conflict import Conflict
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.proof import Proof
from robotraj.solution.records import History, Round
from robotraj.solution.reserves.shares import Share, shares_of, used_up
from robotraj.solution.sample import JOINTS, Sample, Times, as_times, join
from robotraj.solution.settings import Settings
from robotraj.solution.violation import Violation
from robotraj.solvers.status import Status
from robotraj.transcription.interval_limits.row_places import AddedRow

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from robotraj.problem.phase import Phase
    from robotraj.solution.costates.duals import PhaseDuals
    from robotraj.solution.feedback.gains import Gains
    from robotraj.solution.records import ContinuationRecord, MeshStep
    from robotraj.solvers.base import Multipliers


STOPPED = (Status.TIME_LIMIT, Status.MEMORY_LIMIT, Status.INTERRUPTED)
"""Statuses of plans that end before their motion is proved."""
WORDS = {
    **dict.fromkeys(("trajectory", "path", "positions", "configurations"), "q"),
    "velocities": "v",
    "accelerations": "a",
    "torques": "tau",
    "states": "x",
    "controls": "u",
}
"""Words of other libraries for values along a motion, and the attribute of a sample."""


@dataclass(frozen=True, eq=False)
class Solution(OneLine):
    """The result of a solver, checked outside the solver.

    Attributes
    ----------
    problem : Problem
    phases : tuple of PhaseSolution
    status : Status
        How the solve ended; ``status.remedy`` names a remedy.
    message : str
        The solver's message.
    objective : float
    iterations : int
    times : dict of str to float
        Processor seconds: ``"build"`` the transcription and its derivatives, ``"compile"`` what the engine prepared,
        ``"setup"`` and ``"solve"`` of the solver. Entries named ``"solve: ..."`` are parts of ``"solve"``.
    violation_list : tuple of Violation
        Every row and bound violated by more than the tolerance, worst first.
    multipliers : Multipliers or None
        Multipliers in physical units, for warm starts, computed when first read.
    refinement : tuple of MeshStep
        The meshes of the refinement, in order; empty for a plan on a given mesh.
    duals : sequence of PhaseDuals
        Costates and densities of multipliers, one entry a phase, found when first read; see ``rt.indirect.costates``.
    continuation : tuple of ContinuationRecord
        The steps of the continuation, in order; empty without one.
    added_rows : tuple of AddedRow
        Rows that were imposed between collocation points as well.
    interval_violations : tuple of Violation
        Rows on states that are violated between collocation points, worst first.
    control_interval_violations : sequence of Violation
        Bounds of controls, accelerations and other algebraic variables that are exceeded by more than 1 % there, worst
        first; computed when first read. Polynomials exceed their bounds where they switch, unless
        ``rt.interval_limits.BernsteinBounds(controls=True)`` bounds them.
    impulses : tuple of mapping
        For every link of the problem, the impulses of its impact by name, ``"impulse.left_foot.z"`` [N s, N m s]; empty
        for links without one.
    conflicts : tuple of Conflict
        Where no motion was found: bounds that exclude motions, worst first, with values that suffice.
    settings : Settings or None
        Settings of the plan with their reasons; ``rt.plan(problem, settings=solution.settings)`` repeats it.
    proof : Proof or None
        Measures between the collocation points; None where nothing was proved, as on a given mesh.
    rounds : tuple of Round
        Every solve of the plan; ``print(solution.history)`` shows them.
    """

    problem: Problem
    phases: tuple[PhaseSolution, ...]
    status: Status
    message: str
    objective: float
    iterations: int
    times: dict[str, float]
    violation_list: tuple[Violation, ...] = ()
    multipliers: Multipliers | None = None
    refinement: tuple[MeshStep, ...] = ()
    duals: Sequence[PhaseDuals] = ()
    continuation: tuple[ContinuationRecord, ...] = ()
    added_rows: tuple[AddedRow, ...] = ()
    interval_violations: tuple[Violation, ...] = ()
    conflicts: tuple[Conflict, ...] = ()
    control_interval_violations: Sequence[Violation] = ()
    impulses: tuple[Mapping[str, float], ...] = ()
    settings: Settings | None = None
    proof: Proof | None = None
    rounds: tuple[Round, ...] = ()

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> object:
            read = name if name in (*JOINTS, "x", "u") else WORDS.get(name)
            advice = f"Read values at times: solution.at(t).{read}." if read else ""
            raise no_attribute(self, name, advice)

        def __getitem__(self, name: object) -> object:
            raise no_entry(self, name)

    def __getstate__(self) -> dict[str, object]:
        """Pickle and copy the solution without its program; feedback gains that were read from a file are kept."""
        from robotraj.solution.released import released

        kept = vars(released(self))
        names = [entry.name for entry in fields(self)]
        return {name: kept[name] for name in names} | {n: v for n, v in vars(self).items() if n == "gains"}

    @property
    def history(self) -> History:
        """Every solve of the plan in order: its mesh, what its solution lacked, the response, iterations and seconds.

        ``history.start`` names the start that led to the solution, where that is not the guess.
        """
        return History(self.rounds)

    @property
    def success(self) -> bool:
        """Whether the solver converged and every row, evaluated again outside it, holds."""
        return self.status is Status.SOLVED

    @property
    def seconds(self) -> float:
        """Processor time [s]: the sum of ``times`` without the entries that are parts of others."""
        return sum(seconds for name, seconds in self.times.items() if ":" not in name)

    @cached_property
    def error(self) -> float:
        """Largest relative error of an interval between its nodes (``refinement.errors_of``).

        NaN where equations are missing from a file.
        """
        if self.problem.missing:
            return np.nan
        from robotraj.transcription.refinement.assess import errors_of

        return max(float(errors_of(part.phase, part.trajectory, part.mesh).max()) for part in self.phases)

    @cached_property
    def gains(self) -> Gains:
        """Time-varying linear feedback along the plan: tau = tau_plan - K(t) (x - x_plan); see ``Gains``.

        Computed when first read, and kept in files.

        Raises
        ------
        InputError
            A phase moves a System, the robot has no motors, or the plan cannot be linearised.
        """
        from robotraj.solution.feedback.gains import gains_of

        return gains_of(self)

    @cached_property
    def shares(self) -> tuple[Share, ...]:
        """How much of cone, sole, torque and speed a plan with contacts uses; see ``solution.reserves.shares``."""
        return shares_of(self.phases)

    def sensitivity(self, by: str | Callable[[float], Problem | Phase]) -> float:
        """Return the derivative of the optimal objective by a number of the problem, without another solve.

        ``by`` names a fixed parameter or ``"duration"``, or is a function of a step that returns the problem with a
        larger number: ``lambda h: phase.with_(end=rt.State(q=1.0 + h))``; see ``costates.sensitivity``.

        Raises
        ------
        InputError
            There is no such number, the plan was not solved, has rows on distances, or was read from a file.
        """
        from robotraj.solution.costates.sensitivity import sensitivity
        from robotraj.solution.released import released

        if not self.success:
            raise InputError(f"solution.sensitivity needs a solved plan; this one ended with: {self.status.value}.")
        own = released(self)
        return sensitivity(own.multipliers, own.problem, by)

    @property
    def duration(self) -> float:
        """From the start of the first phase to the end of the last [s]."""
        return self.phases[-1].t0 + self.phases[-1].duration - self.phases[0].t0

    @property
    def parameters(self) -> dict[str, float]:
        """Values of the parameters of all phases."""
        return {name: value for phase in self.phases for name, value in phase.parameters.items()}

    @property
    def knots(self) -> Array:
        """Times of all knots [s]."""
        return np.unique(np.concatenate([phase.knots for phase in self.phases]))

    @overload
    def at(self, t: float) -> Sample[float]: ...
    @overload
    def at(self, t: Sequence[float] | Array) -> Sample[Array]: ...
    @overload
    def at(self, t: Times) -> Sample[Any]: ...

    def at(self, t: Times) -> Sample[Any]:
        """Evaluate the plan at global times; where two phases meet, the later phase is evaluated.

        Parameters
        ----------
        t : float or array (m,)
            Global times [s].

        Returns
        -------
        Sample
            ``.q .v .a .tau`` for robots, ``.x .u .z`` by name for Systems; (n,) for one time, (m, n) for m times. Times
            in several phases give the variables that all of these have; forces are 0 where a contact is not held.
        """
        times = as_times(t)
        starts = np.array([phase.t0 for phase in self.phases])
        owner = np.clip(np.searchsorted(starts, times, side="right") - 1, 0, len(self.phases) - 1)
        if times.ndim == 0:
            return self.phases[int(owner)].at(float(times)).with_contacts(self._contacts)
        used = np.unique(owner)
        if len(used) <= 1:
            return self.phases[int(used[0]) if len(used) else 0].at(times).with_contacts(self._contacts)
        parts = [np.flatnonzero(owner == i) for i in used]
        samples = [
            self.phases[int(i)].at(times[part]).with_contacts(self._contacts)
            for i, part in zip(used, parts, strict=True)
        ]
        return join(samples, np.argsort(np.concatenate(parts)))

    @cached_property
    def _contacts(self) -> dict[str, int]:
        """Every contact of any phase, with the number of components of its force."""
        return {
            contact.name: len(contact.vector([0.0] * len(contact.forces)))
            for part in self.phases
            for contact in part.phase.bound_contacts
        }

    def violations(self, top: int = 3) -> tuple[Violation, ...]:
        """List the most violated rows and bounds, worst first, relative to their scale.

        Raises
        ------
        InputError
            ``top`` is no whole number.
        """
        if not is_whole(top):
            raise InputError(f"violations(top) is {top!r}; give a whole number.")
        return self.violation_list[:top]

    def save(self, path: str | Path) -> Path:
        """Write the solution to an ``.npz`` file, without pickle; ``rt.load_solution`` reads it back.

        Everything that is plain data is kept, the robot and the polynomials bit for bit. Python functions are not:
        see ``load_solution``. ``.npz`` is appended where it is missing; the absolute path is returned.
        """
        from robotraj.solution.storage.archive import Contents, write

        others = ("problem", "phases", "settings")
        facts = {entry.name: getattr(self, entry.name) for entry in fields(self) if entry.name not in others}
        if self.multipliers is not None:
            facts["multipliers"] = self.multipliers.plain
        # Plans of Systems and plans that were not solved have no gains.
        with suppress(InputError):
            facts["gains"] = self.gains.plain
        return write(path, Contents(self.problem, self.phases, facts, self.settings))

    def to_csv(
        self,
        path: str | Path,
        samples: int | Sequence[float] = 201,
        gains: bool = False,
        rate: float | None = None,
    ) -> Path:
        """Write a table over time, a column per variable with its unit; see ``robotraj.solution.export.tables``."""
        from robotraj.solution.export.tables import to_csv

        return to_csv(self, path, samples, gains, rate)

    def to_json(
        self,
        path: str | Path,
        samples: int | Sequence[float] = 201,
        gains: bool = False,
        rate: float | None = None,
    ) -> Path:
        """Write the status, figures and sampled trajectory as JSON; see ``robotraj.solution.export.tables``."""
        from robotraj.solution.export.tables import to_json

        return to_json(self, path, samples, gains, rate)

    def to_controller(self, path: str | Path, rate: float = 1000.0) -> Path:
        """Write the file that a controller reads, by its suffix; see ``robotraj.solution.export.controllers``."""
        from robotraj.solution.export.controllers import to_controller

        return to_controller(self, path, rate)

    def plot(self) -> Figure:
        """Draw the trajectories with limits, knots and collocation points; see ``robotraj.solution.plotting``."""
        from robotraj.solution.plotting import plot

        return plot(self)

    @property
    def proved(self) -> bool:
        """Whether a motion was found and its ``proof`` holds; False where nothing was measured, as on a given mesh."""
        return self.success and self.proof is not None and self.proof.holds

    @property
    def claims(self) -> tuple[Claim, ...]:
        """What the planner's own measures show, claim by claim; ``rt.validate`` judges the others."""
        return planned_claims(self, self.proof)

    @property
    def cause(self) -> str:
        """Why no solution was found: the first limit to relax, else the worst violated row, else the message.

        The cause of a motion that is not proved, also since a limit of the plan was reached, is the worst violation
        between its points, else its error. Where such a limit ended a solve, the cause is what the last iterate uses up
        of friction, torque and speed: the row that it violates most changes from iterate to iterate.
        """
        if self.conflicts:
            return self.in_phase(self.conflicts[0])
        stopped = self.status in STOPPED and not self.violation_list
        if (self.status is Status.NOT_PROVED or stopped) and self.proof is not None:
            between = [*self.interval_violations, *self.control_interval_violations]
            worst = max(between, key=lambda violation: violation.relative, default=None)
            if worst is not None and worst.relative > self.proof.goals.excess:
                return f"{self.status.value}, between the points {self.in_phase(worst)}"
            return f"{self.status.value}, {self.proof.missed}"
        if self.status is Status.INVALID_NUMBER or not self.violation_list:
            return self.message
        if self.status in STOPPED and (used := used_up(self.shares)):
            return f"{self.status.value}, and the last iterate uses {', '.join(map(str, used))}"
        return f"{self.status.value}, {self.in_phase(self.violation_list[0])}"

    def in_phase(self, entry: Conflict | Violation) -> str:
        """Write an entry, with its phase where there are several."""
        return f"{entry} (phase {entry.phase!r})" if len(self.phases) > 1 else str(entry)

    def __repr__(self) -> str:
        names = brief(tuple(part.phase.name for part in self.phases)).strip("(),")
        if len(self.phases) > ENTRIES:
            names = f"{len(self.phases)} phases"
        return (
            f"<Solution of {names}: {self.status.value}, objective {self.objective:.6g}, {self.duration:.4g} s, "
            f"{self.iterations} iterations>"
        )

    def _repr_html_(self) -> str:
        """Show the replay page in a notebook."""
        return drawn(self)

    def __str__(self) -> str:
        from robotraj.solution.summary import summary

        return plain(summary(self))
