"""Measures of a plan between its collocation points, and their goals."""

from __future__ import annotations

from dataclasses import fields

from robotraj._util.checks import is_number
from robotraj._util.curves.teeth import SMOOTH
from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine, wrapped
from robotraj._util.values import dataclass
from robotraj.solution.records import Lack

FRICTION = 3e-3
"""Share of Coulomb's friction that may be left out: the simulated joint then stays within a hundredth of its range."""


@dataclass(frozen=True)
class Goals(OneLine):
    """Bounds on the measures of a plan between its collocation points.

    Attributes
    ----------
    error : float
        Largest relative error of the equations of motion on an interval.
    excess : float
        Largest excess over a limit or path constraint, relative to its bound.
    objective : float
        Largest relative difference of the objective from its integral along the motion, and from a finer mesh.

    Raises
    ------
    InputError
        A bound is no number above 0; infinity leaves its measure unbounded.
    """

    error: float = 1e-4
    excess: float = 1e-3
    objective: float = 1e-3

    def __post_init__(self) -> None:
        for entry in fields(self):
            value = getattr(self, entry.name)
            if not (is_number(value) and value > 0.0):
                raise InputError(f"Goals({entry.name}) is {value!r}; give a number above 0.")


@dataclass(frozen=True)
class Proof(OneLine):
    """Measures of a plan between its collocation points.

    Attributes
    ----------
    error : float
        Largest relative error of the equations of motion on an interval; 0 where torques follow from inverse dynamics.
    excess : float
        Largest excess over a limit or path constraint, relative to its bound; in its unit where all bounds are 0.
    quadrature : float
        Relative difference between the objective's integral along the motion and its sum at the points.
    unsettled : float
        Relative decrease of the objective to expect on finer meshes, estimated from the last meshes. Where the solver
        stopped early, a further solve from the plan, on a mesh no finer, gains less than the goal. Both are claims on
        this local optimum: another one may be better.
    goals : Goals
    shortfall : float
        Largest shortfall of a distance of ``CollisionFree`` in the proof [m]; 0 where all distances are proved.
    roughness : float
        Height of the largest teeth of a torque or another control, relative to its limit (``smoothness.roughness``).
    friction : float
        Share of the objective that the smooth law of dry friction leaves out of Coulomb's
        (``planning.proving.friction_left_out``).
    deviation : float
        How far a machine with Coulomb's friction leaves the plan, relative to what ``rt.validate`` allows; 0 where it
        was not simulated, since hardly any friction is left out.
    """

    error: float
    excess: float
    quadrature: float
    unsettled: float
    goals: Goals
    shortfall: float = 0.0
    roughness: float = 0.0
    friction: float = 0.0
    deviation: float = 0.0

    @property
    def motion_holds(self) -> bool:
        """Whether the plan is a motion within its limits, whether or not its objective has settled."""
        within = self.error <= self.goals.error and self.excess <= self.goals.excess
        return within and self.shortfall <= 0.0 and self.deviation <= 1.0

    @property
    def holds(self) -> bool:
        """Whether all measures are within their goals."""
        return self.motion_holds and self.is_settled and self.is_smooth

    @property
    def verdict(self) -> str:
        """In a few words, what is proved and what is not."""
        if not self.motion_holds:
            return "not proved"
        missed = {"objective not settled": not self.is_settled, "controls with teeth": not self.is_smooth}
        lacking = [what for what, is_missed in missed.items() if is_missed]
        return ", ".join(["motion proved", *lacking]) if lacking else "proved"

    @property
    def is_settled(self) -> bool:
        """Whether the objective is that of the motion, and finer meshes gain no more than its goal."""
        return max(self.quadrature, self.unsettled) <= self.goals.objective

    @property
    def is_smooth(self) -> bool:
        """Whether no torque or other control alternates with the mesh by more than 2 percent of its limit."""
        return self.roughness <= SMOOTH

    @property
    def missed(self) -> str:
        """The measure of the motion that is furthest beyond its goal, with that goal."""
        error, excess = self.error / self.goals.error, self.excess / self.goals.excess
        if max(error, excess) <= 1.0 and self.shortfall > 0.0:
            return f"a distance falls short by {self.shortfall:.1e} m"
        if max(error, excess) <= 1.0 and self.deviation > 1.0:
            return f"with Coulomb's friction the robot leaves the plan by {self.deviation:.2g} times what is allowed"
        if error >= excess:
            return f"the error of the motion is {self.error:.1e} (allowed {self.goals.error:.0e})"
        return f"the excess over limits is {self.excess:.1e} (allowed {self.goals.excess:.0e})"

    @property
    def measures(self) -> tuple[Lack, ...]:
        """Every measure with its goal."""
        more = (Lack("distance not proved [m]", self.shortfall, 0.0),) if self.shortfall > 0.0 else ()
        if not self.is_smooth:
            more = (*more, Lack("teeth of a control, of its limit", self.roughness, SMOOTH))
        if self.friction > 0.0:
            more = (*more, Lack("dry friction left out by the smooth law", self.friction, FRICTION))
        if self.deviation > 1.0:
            more = (*more, Lack("deviation with Coulomb's friction, of the allowed one", self.deviation, 1.0))
        return (
            Lack("error of the motion", self.error, self.goals.error),
            Lack("excess over limits", self.excess, self.goals.excess),
            Lack("error of the objective's integral", self.quadrature, self.goals.objective),
            Lack("objective still to gain in this local optimum", self.unsettled, self.goals.objective),
            *more,
        )

    @property
    def lacks(self) -> tuple[Lack, ...]:
        """The measures beyond their goals."""
        return tuple(each for each in self.measures if not each.amount <= each.allowed)

    def __str__(self) -> str:
        shown = (str(each) if each in self.lacks else f"{each.kind} {each.amount:.1e}" for each in self.measures)
        return "\n".join(wrapped(f"{self.verdict} between the points: {', '.join(shown)}"))
