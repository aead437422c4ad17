"""A planned gait as one of its periods after the other: supports, footholds and the rest before or after them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.lazy_values import cached_property
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import Contact
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.function import GroundFunction
from robotraj.gait.bounds.own_sides import LateralDistance, OwnSides
from robotraj.gait.bounds.swing_clearance import partners_of
from robotraj.gait.bounds.upright import Upright
from robotraj.gait.checks import positive
from robotraj.gait.feet import foot_contact
from robotraj.gait.standing import FOOT_TOLERANCE, stand
from robotraj.gait.stepping.capture import capture_point, caught
from robotraj.gait.stepping.footholds import SHIFT
from robotraj.gait.supports import GaitTerms, Support
from robotraj.guess.legs.stance import BalancedStance
from robotraj.guess.legs.standing_posture import pendulum_time
from robotraj.problem.constraints.clearance import GroundClearance
from robotraj.problem.constraints.path import PathConstraint
from robotraj.problem.links.periodic import Mirror, Periodic
from robotraj.problem.links.touchdown import Touchdown
from robotraj.problem.objectives.base import Objective
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.robot import Robot


class PlannedPhase(Protocol):
    """The planned motion of a phase."""

    @property
    def phase(self) -> Phase:
        """The phase that was planned."""

    @property
    def t0(self) -> float:
        """Time at which it begins [s]."""

    @property
    def duration(self) -> float:
        """Its duration [s]."""


class PlannedState(Protocol):
    """A planned state of the robot."""

    @property
    def q(self) -> Array:
        """Configuration (nq,)."""

    @property
    def v(self) -> Array:
        """Velocity (nv,)."""


class PlannedGait(Protocol):
    """A plan of a repeating gait, such as a solution of ``rt.gait.walk``."""

    @property
    def problem(self) -> Problem:
        """Its phases and links."""

    @property
    def phases(self) -> Sequence[PlannedPhase]:
        """The motion of each phase."""

    @property
    def duration(self) -> float:
        """Duration of one period [s]."""

    def at(self, t: float) -> PlannedState:
        """Evaluate at a time [s]."""


@dataclass(frozen=True, eq=False)
class JoinedGait:
    """A planned gait with its repetition."""

    gait: PlannedGait
    repeat: Mirror | Periodic

    @property
    def robot(self) -> Robot:
        """The robot."""
        robot = self.gait.phases[0].phase.robot
        assert robot is not None, "a phase with contacts moves a robot"
        return robot

    @property
    def partners(self) -> Mapping[str, str]:
        """Frames that change places from one period to the next."""
        return partners_of(self.repeat)

    @property
    def contact(self) -> Contact:
        """The contact of a foot, to copy to the others."""
        return next(contact for part in self.gait.phases for contact in part.phase.contacts)

    @property
    def feet(self) -> tuple[str, ...]:
        """Frames of all feet."""
        held = [contact.frame for part in self.gait.phases for contact in part.phase.bound_contacts]
        return tuple(dict.fromkeys(name for foot in held for name in (foot, self.partners.get(foot, foot))))

    @property
    def length(self) -> float:
        """Displacement along x in a period [m]."""
        return float(self.gait.at(self.gait.duration).q[0] - self.gait.at(0.0).q[0])

    def period(self, number: int) -> list[Support]:
        """Return the phases of a period, counted from the planned one."""
        swapped = self.partners if number % 2 else {}
        written = []
        for part in self.gait.phases:
            feet = tuple(swapped.get(c.frame, c.frame) for c in part.phase.bound_contacts)
            written.append(Support(feet, part.duration, f"{part.phase.name}, period {number}"))
        return written

    @property
    def entry(self) -> tuple[Array, Array]:
        """Configuration (nq,) and velocity (nv,) at the end of the previous period: the image of the last state."""
        robot, phase = self.robot, self.gait.phases[-1].phase
        first, last = self.gait.at(0.0), self.gait.at(self.gait.duration)
        names = [state.name for state in phase.body.states][: robot.nq + robot.nv]
        values = dict(zip(names, [*last.q, *last.v], strict=True))
        seen = self.repeat.of(phase, names, type(self.repeat).__name__)
        speeds = [sign * values[name] for name, sign in seen.sources[robot.nq :]]
        return np.array(first.q), np.array(speeds)

    @cached_property
    def stance(self) -> BalancedStance:
        """Inverse kinematics of all feet."""
        return BalancedStance(self.robot, tuple(foot_contact(self.contact, n).bound_to(self.robot) for n in self.feet))

    def rest(self, shift: float | None, what: str) -> float:
        """Return the duration on all feet at rest [s]."""
        home = stand(self.robot, self.feet, self.contact)
        return positive(shift, SHIFT * pendulum_time(self.stance, home), f"rt.gait.{what}(shift)")

    def resting(self, period: int, last: bool, held: bool) -> dict[str, float]:
        """Return the standing configuration before or after a period, by name, without the root's y.

        It is placed above the standing feet of the period's first or ``last`` step. If ``held``, these feet are on
        their footholds, and of two point feet the other one is where it stops the fall.
        """
        home = stand(self.robot, self.feet, self.contact)
        feet, bearing = self.stance.locate(home), self._bearing(period, last)
        shift = np.zeros(3)
        for i, axis in enumerate("xy"):
            shift[i] = np.mean([at - feet[name] for name, at in bearing.items() if name.endswith(f".{axis}")] or [0.0])
        near = np.array(home)
        near[0] += shift[0]
        if held:
            shifts = dict(zip("xy", shift, strict=False))
            spots = {n: at + shifts.get(n[-1], 0.0) for n, at in feet.items()} | bearing
            if len(self.feet) == 2 and all(len(contact.outline()) == 1 for contact in self.stance.contacts):
                spots |= self._caught(period, last, bearing)
            com = np.array(pin.centerOfMass(self.robot.model, self.stance.data, home))
            for i, axis in enumerate("xy"):
                com[i] += np.mean([at - feet[n] for n, at in spots.items() if n.endswith(f".{axis}")] or [0.0])
            if self.robot.root == "planar":
                com[1] = np.nan
            near = self.stance.reach(near, spots, com, {}, near)
            if np.max(np.abs(self.stance.places(near, spots)[0]), initial=0.0) > FOOT_TOLERANCE:
                raise InputError(
                    f"{self.robot.name!r} cannot stand on the footholds {', '.join(sorted(bearing))} of the gait with "
                    "the other feet beside them; give count= of at least 2."
                )
        return {n: float(v) for n, v in zip(self.robot.position_names, near, strict=True) if n != "root_y"}

    @property
    def _steps(self) -> list[tuple[float, set[str]]]:
        """Times at which some feet begin to stand alone [s], and their frames."""
        standing = [(part.t0, {c.frame for c in part.phase.bound_contacts}) for part in self.gait.phases]
        return [(t0, feet) for t0, feet in standing if 0 < len(feet) < len(self.feet)] or standing

    def _bearing(self, number: int, last: bool) -> dict[str, float]:
        """Return the anchors of the feet that stand in all of a period, or else in its first or last step."""
        steps = self._steps
        time, bearing = steps[-1 if last else 0]
        always = set.intersection(*(feet for _, feet in steps))
        names = {contact.name: contact.frame for contact in self.stance.contacts}
        labels = {frame: name for name, frame in names.items()}
        found = {}
        for name, at in self.stance.locate(self.gait.at(time).q).items():
            foot, _, axis = name.rpartition(".")
            if names[foot] not in (always or bearing):
                continue
            if isinstance(self.repeat, Mirror) and number % 2:
                foot = labels[self.partners.get(names[foot], names[foot])]
            found[f"{foot}.{axis}"] = self._in_period(number, axis, at)
        return found

    def _in_period(self, number: int, axis: str, at: float) -> float:
        """Return a coordinate of the planned period in another period."""
        first, end = self.gait.at(0.0).q, self.gait.at(self.gait.duration).q
        side = 1 if self.robot.root == "floating" else 0
        if axis == "x":
            return float(at + number * self.length)
        if not isinstance(self.repeat, Mirror):
            return float(at + number * (end[side] - first[side])) if axis == "y" else float(at)
        if not number % 2:
            return float(at)
        return float(first[side] + end[side] - at) if axis == "y" else -float(at)

    def _caught(self, number: int, last: bool, bearing: Mapping[str, float]) -> dict[str, float]:
        """Return where the second foot lands to stop the fall of a period, or stands before its first step."""
        began = self._steps[-1 if last else 0][0]
        landed = (part.t0 for part in self.gait.phases if part.t0 > began and part.phase.contacts)
        state = self.gait.at(next(landed, self.gait.duration) if last else began)
        point = capture_point(self.stance, state.q, state.v, backwards=not last)
        other = next(contact.name for contact in self.stance.contacts if f"{contact.name}.x" not in bearing)
        standing = {name[-1]: at for name, at in bearing.items() if name.endswith((".x", ".y"))}
        falling = {axis: self._in_period(number, axis, point["xyz".index(axis)]) for axis in standing}
        return {f"{other}.{axis}": at for axis, at in caught(standing, falling).items()}

    def terms(self, clearance: float | None, objective: Objective | None, upright: Upright | None) -> GaitTerms:
        """Return the options of all phases; a clearance of 0 is left out if the gait has none."""
        own = self.gait.phases[0].phase.objective if objective is None else objective
        if clearance == 0.0 and not self._clears_ground:
            clearance = None
        sides, margin = OwnSides() if self._keeps_sides else None, self.contact.margin
        return GaitTerms(self.contact, clearance, own, upright, _ground(self.contact), sides, margin)

    @property
    def _keeps_sides(self) -> bool:
        """Whether feet of the gait keep to their own sides; legs of others may cross in the motions joined to it."""
        rows = [row for part in self.gait.phases for row in part.phase.constraints if isinstance(row, PathConstraint)]
        return any(isinstance(row.expression, LateralDistance) for row in rows)

    @property
    def _clears_ground(self) -> bool:
        """Whether feet of the gait swing above the ground; those of walkers without knees pass through it."""
        rows = [row for part in self.gait.phases for row in part.phase.constraints if isinstance(row, GroundClearance)]
        return all(row.height is not None for row in rows)


def joined_gait(gait: PlannedGait, count: object, what: str) -> JoinedGait:
    """Return the cycle of a planned gait, given to a call such as ``"rt.gait.start"`` (``what``).

    Raises
    ------
    InputError
        The motion does not repeat, its ground is not level, or the count is not positive.
    """
    if not isinstance(count, int) or count < 1:
        raise InputError(f"{what}(count) is {count!r}; give at least 1 period.")
    problem = getattr(gait, "problem", None)
    if not isinstance(problem, Problem):
        raise InputError(f"{what} needs the solution of a gait, as of rt.gait.walk; got {type(gait).__name__}.")
    links = [link.repeat if isinstance(link, Touchdown) else link for link in problem.links]
    repeats = [link for link in links if isinstance(link, Mirror | Periodic)]
    if not repeats or problem.phases[0].robot is None:
        raise InputError(f"The motion given to {what} does not repeat; plan one of rt.gait.walk, run or trot.")
    cycle = JoinedGait(gait, repeats[0])
    if not isinstance(_ground(cycle.contact), Flat):
        raise InputError(f"The gait given to {what} is not on level ground; plan it on rt.terrain.Flat().")
    return cycle


def _ground(contact: Contact) -> Ground | GroundFunction:
    return contact.ground or Flat()
