"""Paths of the feet and of the centre of mass: footholds under the hips, swing arcs and an inverted pendulum."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.lazy_values import cached_property
from robotraj._util.values import dataclass
from robotraj.dynamics.terrain.function import as_ground
from robotraj.guess.legs.centre_of_mass import Pendulum, heights
from robotraj.guess.legs.schedule import Schedule, StanceTime
from robotraj.guess.legs.somersault import Somersault, somersault_of
from robotraj.guess.legs.stance import BalancedStance
from robotraj.guess.legs.standing_posture import pendulum_height, standing
from robotraj.guess.legs.swing import Swing, swings
from robotraj.problem.constraints.bounds import Bounds
from robotraj.problem.problem import Problem
from robotraj.robot.root import QUATERNION


@dataclass(frozen=True, eq=False)
class Footsteps:
    """Paths of the feet and of the centre of mass of one problem.

    Attributes
    ----------
    problem : Problem
    schedule : Schedule
    stance : BalancedStance
        Inverse kinematics of all feet.
    height : float or None
        Height of the centre of mass above the feet [m]; None for that of the standing robot.
    lift : float or None
        Apex of swinging feet [m]; None for a default that the clearances of the phases increase.
    """

    problem: Problem
    schedule: Schedule
    stance: BalancedStance
    height: float | None = None
    lift: float | None = None

    @cached_property
    def _plane(self) -> tuple[str, ...]:
        """Return the horizontal axes in which the robot moves."""
        return ("x",) if self.stance.robot.root == "planar" else ("x", "y")

    @cached_property
    def home(self) -> Array:
        """Return the standing configuration (nq,), with the entries that the start of the first phase fixes."""
        q = standing(self.stance, self.height)
        return _fixed(q, self.problem.phases[0].start_bounds)

    @cached_property
    def _standing_com(self) -> Array:
        """Return the centre of mass in the standing configuration, (3,) [m]."""
        model = self.stance.robot.model
        return np.array(pin.centerOfMass(model, model.createData(), self.home))

    @cached_property
    def _displacements(self) -> dict[str, tuple[float, float]]:
        """Return start and displacement [m] of the centre of mass along each axis, for motion at constant speed."""
        last = self.problem.phases[-1].end_bounds
        names = list(self.stance.robot.position_names)
        moved = {}
        for k, axis in enumerate(self._plane):
            i = names.index(f"root_{axis}")
            start, gain = float(self._standing_com[k]), 0.0
            ends = [side[i] for side in (last.lower, last.upper) if np.isfinite(side[i])]
            if self.schedule.repeat is not None:
                gain = self.schedule.displacement[f"q.root_{axis}"]
                # A mirrored path is continuous only if it starts at y = 0.
                start = 0.0 if self.schedule.sign < 0 and axis == "y" else start
            elif ends:
                gain = float(np.mean(ends)) - float(self.home[i])
            moved[axis] = (start, gain)
        return moved

    @cached_property
    def swings(self) -> dict[str, Swing]:
        """Return the motion of every foot."""
        found = {}
        for contact in self.schedule.contacts:
            stands = self.schedule.stands(contact.name)
            footholds = [self._foothold(stand) for stand in stands]
            found[contact.name] = swings(contact, stands, footholds, self._standing_anchors)
        return found

    @cached_property
    def _standing_anchors(self) -> dict[str, float]:
        """Return the anchors of all feet in the standing configuration."""
        return self.stance.locate(self.home)

    def _regular_foothold(self, stand: StanceTime) -> dict[str, float]:
        """Return the anchors of a stance at constant speed: under the hip halfway through the stance."""
        whole = self.schedule.times[-1]
        if np.isinf(stand.start):
            share = 0.0
        elif np.isinf(stand.end):
            share = 1.0
        else:
            share = 0.5 * (stand.start + stand.end) / whole
        own = {name: value for name, value in self._standing_anchors.items() if name.rsplit(".", 1)[0] == stand.foot}
        names = [f"{stand.foot}.{axis}" for axis in self._plane]
        if not all(name in own for name in names):
            return own
        heading = self.heading(share)
        offset = np.array([own[name] for name in names]) - self._standing_com[: len(names)]
        if len(names) == 2:
            c, s = np.cos(heading), np.sin(heading)
            offset = np.array([[c, -s], [s, c]]) @ offset
        for name, axis, entry in zip(names, self._plane, offset, strict=True):
            begin, gain = self._displacements[axis]
            own[name] = begin + share * gain + float(entry)
        if f"{stand.foot}.yaw" in own:
            own[f"{stand.foot}.yaw"] += heading
        return own

    def heading(self, share: float) -> float:
        """Return the turn about the vertical axis [rad] at a fraction of the motion, linear in it.

        It is that of the last quaternion, where the end fixes it and the motion does not repeat.
        """
        last = self.problem.phases[-1].end_bounds
        fixed = np.array_equal(last.lower[QUATERNION], last.upper[QUATERNION])
        if self.stance.robot.root != "floating" or self.schedule.repeat is not None or not fixed:
            return 0.0
        x, y, z, w = (float(v) for v in last.lower[QUATERNION])
        return share * float(np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)))

    def posture(self, t: float) -> Array:
        """Return the standing configuration (nq,) with the heading and the somersault of a time [s]."""
        q, angle = np.array(self.home), self.heading(t / self.schedule.times[-1])
        if angle:
            turn = pin.Quaternion(pin.AngleAxis(angle, np.array([0.0, 0.0, 1.0])).toRotationMatrix())
            x, y, z, w = q[QUATERNION]
            q[QUATERNION] = (turn * pin.Quaternion(w, x, y, z)).coeffs()
        return q if self.somersault is None else self.somersault.turned(q, t)

    @cached_property
    def somersault(self) -> Somersault | None:
        """Return the turn of the root in flight, if the motion has one."""
        return somersault_of(self.problem, self.schedule, self.home)

    def _foothold(self, stand: StanceTime) -> dict[str, float]:
        """Return the anchors of a stance: those that a phase fixes, else those of constant speed, shifted."""
        spot = self._regular_foothold(stand)
        for name in spot:
            spot[name] += self._shift.get(name.rsplit(".", 1)[1], 0.0)
        # The footholds of a repeating gait stay regular, since no phase fixes those of its other periods.
        return spot if self.schedule.repeat is not None else spot | self._fixed_anchors(stand)

    def _fixed_anchors(self, stand: StanceTime) -> dict[str, float]:
        """Return the anchors that phases fix during a stance."""
        times = self.schedule.times
        fixed = {}
        for i, phase in enumerate(self.problem.phases):
            bounds = phase.parameter_bounds
            for name, low, high in zip(phase.parameter_names, bounds.lower, bounds.upper, strict=True):
                mine = name.rpartition(".")[0] == stand.foot and stand.start <= 0.5 * (times[i] + times[i + 1])
                if mine and 0.5 * (times[i] + times[i + 1]) <= stand.end and np.isfinite(low) and low == high:
                    fixed[name] = float(low)
        return fixed

    @cached_property
    def _shift(self) -> dict[str, float]:
        """Return the mean distance [m] of fixed footholds from those of constant speed; zero if the start is fixed.

        The whole motion is shifted by it.
        """
        gaps: dict[str, list[float]] = {axis: [] for axis in self._plane}
        first, names = self.problem.phases[0].start_bounds, list(self.stance.robot.position_names)
        for stand in (stand for contact in self.schedule.contacts for stand in self.schedule.stands(contact.name)):
            spot = self._regular_foothold(stand)
            for name, value in self._fixed_anchors(stand).items():
                axis = name.rsplit(".", 1)[1]
                if axis in gaps and name in spot:
                    gaps[axis].append(value - spot[name])
        for axis in self._plane:
            i = names.index(f"root_{axis}")
            if first.lower[i] == first.upper[i]:
                gaps[axis] = []
        return {axis: float(np.mean(values)) if values else 0.0 for axis, values in gaps.items()}

    def feet(self, t: float) -> tuple[dict[str, float], dict[str, float]]:
        """Return the anchors of all contacts and the heights of their feet [m], at a time [s]."""
        places: dict[str, float] = {}
        lifts: dict[str, float] = {}
        for name, swing in self.swings.items():
            places |= swing.at(t)
            lifts[name] = swing.lift(t) * self._apex
        return places, lifts

    @cached_property
    def _apex(self) -> float:
        """Return the apex of the swing [m]: above the clearances of the phases and the rise in flight."""
        if self.lift is not None:
            return self.lift
        constraints = [c for phase in self.problem.phases for c in phase.constraints]
        wanted = [getattr(getattr(c, "height", None), "apex", 0.0) for c in constraints]
        gravity = float(np.linalg.norm(self.stance.robot.model.gravity.linear))
        spans = zip(np.diff(self.schedule.times), self.grounded, strict=True)
        rises = [gravity * float(span) ** 2 / 8.0 for span, feet in spans if not feet]
        return max([0.05 * self.above, *(1.2 * float(w) for w in wanted), *rises])

    @cached_property
    def above(self) -> float:
        """Return the height of the pendulum in the standing configuration [m]."""
        places = self.stance.locate(self.home)
        ground = [self.ground(c.name, places) for c in self.stance.feet]
        return pendulum_height(self.stance, float(self._standing_com[2] - np.mean(ground)))

    def ground(self, foot: str, places: Mapping[str, float]) -> float:
        """Return the height of the ground [m] under a foot."""
        contact = next(c for c in self.schedule.contacts if c.name == foot)
        ground = as_ground(contact.contact.ground)
        return float(ground.height(places.get(f"{foot}.x", 0.0), places.get(f"{foot}.y", 0.0)))

    @cached_property
    def grounded(self) -> list[list[str]]:
        """Return the feet on the ground in every phase."""
        feet = {contact.name for contact in self.stance.feet}
        return [sorted(held & feet) for held in self.schedule.held]

    @cached_property
    def com(self) -> Callable[[float], Array]:
        """Return the path of the centre of mass, from a time [s] to a position (3,) [m]."""
        times, model = self.schedule.times, self.stance.robot.model
        gravity = float(np.linalg.norm(model.gravity.linear))
        standing_at = [self.feet(0.5 * (a + b))[0] for a, b in zip(times[:-1], times[1:], strict=True)]
        paths = {}
        for axis in self._plane:
            begin, gain = self._displacements[axis]
            begin += self._shift[axis]
            middles = [
                float(np.mean([places[f"{f}.{axis}"] for f in feet])) if feet else np.nan
                for feet, places in zip(self.grounded, standing_at, strict=True)
            ]
            pendulum = Pendulum(times, middles, float(np.sqrt(gravity / self.above)))
            if self.schedule.repeat is not None:
                sign = self.schedule.sign if axis == "y" else 1.0
                knots = pendulum.repeating(sign, gain)
            else:
                knots = pendulum.joining(begin, begin + gain)
            paths[axis] = (pendulum, knots)
        levels = self._levels(standing_at)
        z = heights(times, levels, [not f for f in self.grounded], gravity, self.schedule.repeat is not None)

        def at(t: float) -> Array:
            across = {axis: pendulum.at(knots, t) for axis, (pendulum, knots) in paths.items()}
            return np.array([across["x"], across.get("y", float(self._standing_com[1])), float(z(t))])

        return at

    def _levels(self, standing_at: Sequence[Mapping[str, float]]) -> list[float]:
        """Return the height of the centre of mass [m] between phases: above the mean of the feet of both phases."""
        known = [
            float(np.mean([self.ground(f, places) for f in feet])) if feet else None
            for feet, places in zip(self.grounded, standing_at, strict=True)
        ]
        levels = []
        for before, after in zip([None, *known], [*known, None], strict=True):
            sides = [v for v in (before, after) if v is not None]
            levels.append(float(np.mean(sides)) if sides else 0.0)
        return [level + self.above for level in levels]


def _fixed(q: Array, bounds: Bounds) -> Array:
    """Return a configuration with the entries that the bounds fix."""
    q = np.array(q)
    n = len(q)
    fixed = bounds.lower[:n] == bounds.upper[:n]
    q[fixed] = bounds.lower[:n][fixed]
    return q
