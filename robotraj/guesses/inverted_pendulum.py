"""A guess for robots that walk, run and jump."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline

from robotraj.chart import Chart
from robotraj.errors import InputError
from robotraj.guess import Curve, Guess, PhaseGuess, default_parameters
from robotraj.guesses.pendulum import Pendulum, heights
from robotraj.guesses.schedule import Schedule, schedule_of
from robotraj.guesses.stance import Stance, standing
from robotraj.guesses.support import support
from robotraj.guesses.swing import Swing, swings
from robotraj.links import BoundLink

if TYPE_CHECKING:
    from robotraj.dynamics import Variable
    from robotraj.problem import Phase, Problem

Array = NDArray[np.float64]

KEYS = 11
"""Configurations found by inverse kinematics in a phase; curves run through them."""
LANDING = 0.02
"""Guessed impulse of a foot that comes down, as the fraction of the robot's weight times a second it carries."""


@dataclass(frozen=True)
class InvertedPendulum(Guess):
    """Feet on a timetable, the centre of mass a linear inverted pendulum on them, legs by inverse kinematics.

    The default guess of problems in which a robot with a free root stands on contacts. Nothing is asked for: the phases
    say which feet stand when, their links how the motion repeats and how far it goes. A foot is put down under where
    its hip will be halfway through its stance (Raibert, Legged Robots That Balance, 1986), swinging feet run on arcs.
    Velocities and accelerations are those of a spline through the configurations, on the manifold of a floating root;
    forces and torques hold that motion up, ``guesses.support``; footholds are where the feet stand.

    Parameters
    ----------
    height : float, optional
        Of the centre of mass above the feet [m]; by default that of the robot as ``rt.gait.stand`` has it.
    apex : float, optional
        How high swinging feet are lifted [m]; by default a twentieth of that height, or a fifth more than the
        ``rt.SwingApex`` of the phase asks for.
    durations : mapping of int to float
        Guessed durations [s] of phases whose duration is free.
    """

    height: float | None = None
    apex: float | None = None
    durations: Mapping[int, float] = field(default_factory=dict)

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Guess a phase on its own, as a problem of one phase."""
        from robotraj.problem import Problem

        return self.prepared(Problem([phase])).of(phase, 0)

    def prepared(self, problem: Problem) -> Guess:
        """Walk through the whole problem.

        Raises
        ------
        InputError
            The problem moves no robot with a free root, or nothing in it stands on the ground.
        """
        robot = problem.phases[0].robot
        if robot is None or robot.root == "fixed":
            raise InputError("InvertedPendulum guesses motions of robots with root='floating' or root='planar'.")
        schedule = schedule_of(problem, self.durations)
        if not any(contact.anchors for contact in schedule.contacts):
            raise InputError("InvertedPendulum needs contacts with the ground, but no phase has any.")
        return _Walk(self, problem, schedule, Stance(robot, schedule.contacts))


@dataclass(frozen=True, eq=False)
class _Walk(Guess):
    """The guess of one problem."""

    settings: InvertedPendulum
    problem: Problem
    schedule: Schedule
    stance: Stance

    @cached_property
    def _plane(self) -> tuple[str, ...]:
        """Horizontal axes in which the robot moves."""
        return ("x",) if self.stance.robot.root == "planar" else ("x", "y")

    @cached_property
    def _home(self) -> Array:
        """How the robot stands: the start where it is given whole, else on all feet."""
        q = standing(self.stance, self.settings.height)
        return _fixed(q, self.problem.phases[0].start_bounds)

    @cached_property
    def _mass(self) -> Array:
        """Centre of mass at home."""
        model = self.stance.robot.model
        return np.array(pin.centerOfMass(model, model.createData(), self._home))

    @cached_property
    def _way(self) -> dict[str, tuple[float, float]]:
        """Start and gain of the centre of mass along each horizontal axis, as if it moved evenly."""
        last = self.problem.phases[-1].end_bounds
        names = list(self.stance.robot.position_names)
        moved = {}
        for k, axis in enumerate(self._plane):
            i = names.index(f"root_{axis}")
            start, gain = float(self._mass[k]), 0.0
            ends = [side[i] for side in (last.lower, last.upper) if np.isfinite(side[i])]
            if self.schedule.repeat is not None:
                gain = self.schedule.displacement[f"q.root_{axis}"]
                # The image of the path in a mirror at y = 0 continues it.
                start = 0.0 if self.schedule.sign < 0 and axis == "y" else start
            elif ends:
                gain = float(np.mean(ends)) - float(self._home[i])
            moved[axis] = (start, gain)
        return moved

    @cached_property
    def swings(self) -> dict[str, Swing]:
        """Where each foot is at every time."""
        places = self.stance.locate(self._home)
        found = {}
        for contact in self.schedule.contacts:
            stands = self.schedule.stands(contact.name)
            spots = [self._spot(contact.name, s.start, s.end, places) for s in stands]
            found[contact.name] = swings(contact, stands, spots, places)
        return found

    def _spot(self, foot: str, start: float, end: float, places: Mapping[str, float]) -> dict[str, float]:
        """Where a foot stands from one time to another: under its hip halfway."""
        whole = self.schedule.times[-1]
        if np.isinf(start):
            share = 0.0
        elif np.isinf(end):
            share = 1.0
        else:
            share = 0.5 * (start + end) / whole
        own = {name: value for name, value in places.items() if name.rsplit(".", 1)[0] == foot}
        for k, axis in enumerate(self._plane):
            name = f"{foot}.{axis}"
            if name in own:
                begin, gain = self._way[axis]
                own[name] += begin - float(self._mass[k]) + share * gain
        return own

    @cached_property
    def _shift(self) -> dict[str, float]:
        """How far footholds that a phase fixes are from those found: the whole walk moves there."""
        gaps: dict[str, list[float]] = {axis: [] for axis in self._plane}
        for i, phase in enumerate(self.problem.phases):
            t = 0.5 * (self.schedule.times[i] + self.schedule.times[i + 1])
            bounds = phase.parameter_bounds
            for name, low, high in zip(phase.parameter_names, bounds.lower, bounds.upper, strict=True):
                foot, _, axis = name.rpartition(".")
                if foot in self.swings and axis in gaps and np.isfinite(low) and low == high:
                    gaps[axis].append(float(low) - self.swings[foot].at(t)[name])
        return {axis: float(np.mean(values)) if values else 0.0 for axis, values in gaps.items()}

    def feet(self, t: float) -> tuple[dict[str, float], dict[str, float]]:
        """Anchors of all contacts, and how high [m] their feet are, at a time [s]."""
        places: dict[str, float] = {}
        lifts: dict[str, float] = {}
        for name, swing in self.swings.items():
            places |= swing.at(t)
            lifts[name] = swing.lift(t) * self._apex(t)
        for name in places:
            axis = name.rsplit(".", 1)[1]
            places[name] += self._shift.get(axis, 0.0)
        return places, lifts

    def _apex(self, t: float) -> float:
        """How high feet swing [m]."""
        if self.settings.apex is not None:
            return self.settings.apex
        i = int(np.clip(np.searchsorted(self.schedule.times, t, side="right") - 1, 0, len(self.problem.phases) - 1))
        wanted = [getattr(getattr(c, "height", None), "apex", 0.0) for c in self.problem.phases[i].constraints]
        return max([0.05 * self._above, *(1.2 * float(w) for w in wanted)])

    @cached_property
    def _above(self) -> float:
        """Height of the centre of mass above the feet at home [m]."""
        places = self.stance.locate(self._home)
        ground = [self._ground(c.name, places) for c in self.schedule.contacts if c.anchors]
        return float(self._mass[2] - np.mean(ground))

    def _ground(self, foot: str, places: Mapping[str, float]) -> float:
        contact = next(c for c in self.schedule.contacts if c.name == foot)
        return float(contact.contact.ground.height(places.get(f"{foot}.x", 0.0), places.get(f"{foot}.y", 0.0)))  # type: ignore[attr-defined]

    @cached_property
    def _grounded(self) -> list[list[str]]:
        """Feet that stand on the ground in every phase."""
        feet = {contact.name for contact in self.schedule.contacts if contact.anchors}
        return [sorted(held & feet) for held in self.schedule.held]

    @cached_property
    def mass(self) -> Any:
        """Path of the centre of mass: from a time [s] to a place (3,) [m]."""
        times, model = self.schedule.times, self.stance.robot.model
        gravity = float(np.linalg.norm(model.gravity.linear))
        standing_at = [self.feet(0.5 * (a + b))[0] for a, b in zip(times[:-1], times[1:], strict=True)]
        paths = {}
        for axis in self._plane:
            begin, gain = self._way[axis]
            begin += self._shift[axis]
            middles = [
                float(np.mean([places[f"{f}.{axis}"] for f in feet])) if feet else np.nan
                for feet, places in zip(self._grounded, standing_at, strict=True)
            ]
            pendulum = Pendulum(times, middles, float(np.sqrt(gravity / self._above)))
            if self.schedule.repeat is not None:
                sign = self.schedule.sign if axis == "y" else 1.0
                start = pendulum.repeating(sign, gain)
            else:
                start = pendulum.between(begin, begin + gain)
            paths[axis] = (pendulum, start)
        levels = self._levels(standing_at)
        z = heights(times, levels, [not f for f in self._grounded], gravity, self.schedule.repeat is not None)

        def at(t: float) -> Array:
            across = {axis: float(pendulum.at(start, t)[0]) for axis, (pendulum, start) in paths.items()}
            return np.array([across["x"], across.get("y", float(self._mass[1])), float(z(t))])

        return at

    def _levels(self, standing_at: Sequence[Mapping[str, float]]) -> list[float]:
        """Height of the centre of mass where phases meet: above the feet of both sides [m]."""
        known = [
            float(np.mean([self._ground(f, places) for f in feet])) if feet else None
            for feet, places in zip(self._grounded, standing_at, strict=True)
        ]
        levels = []
        for before, after in zip([None, *known], [*known, None], strict=True):
            sides = [v for v in (before, after) if v is not None]
            levels.append(float(np.mean(sides)) if sides else 0.0)
        return [level + self._above for level in levels]

    @cached_property
    def _keys(self) -> list[Array]:
        """Configurations of every phase, (KEYS, nq) each."""
        q, found = self._home, []
        robot = self.stance.robot
        for i in range(len(self.problem.phases)):
            rows = []
            for t in np.linspace(self.schedule.times[i], self.schedule.times[i + 1], KEYS):
                places, lifts = self.feet(float(t))
                mass = self.mass(float(t))
                if not self._grounded[i]:
                    # Legs keep their length in flight: feet rise with the centre of mass.
                    rise = float(mass[2] - self._above)
                    level = np.mean([self._ground(c.name, places) for c in self.schedule.contacts if c.anchors])
                    lifts = {name: max(lift, rise - float(level)) for name, lift in lifts.items()}
                if robot.root == "planar":
                    mass[1] = np.nan
                near = np.array(q)
                near[0] += mass[0] - pin.centerOfMass(robot.model, robot.model.createData(), q)[0]
                q = self.stance.reach(near, places, mass, lifts, self._home)
                rows.append(q)
            found.append(np.array(rows))
        return found

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Curves through the configurations of a phase."""
        keys, robot = self._keys[index], self.stance.robot
        duration = self.schedule.times[index + 1] - self.schedule.times[index]
        pace = duration if duration > 0 else 1.0
        fractions = np.linspace(0.0, 1.0, KEYS)
        chart = Chart.around(robot.model, keys[0])
        y = make_interp_spline(fractions, chart.coordinates(keys), k=5)
        rate, second = y.derivative(1), y.derivative(2)

        def motion(s: Array) -> tuple[Array, Array, Array]:
            at, first = y(s), rate(s) / pace
            return chart.positions(at), chart.velocities(at, first), chart.accelerations(at, first, second(s) / pace**2)

        parameters = default_parameters(phase)
        middle, _ = self.feet(0.5 * (self.schedule.times[index] + self.schedule.times[index + 1]))
        low, high = phase.parameter_bounds
        for name, least, most in zip(phase.parameter_names, low, high, strict=True):
            if name in middle:
                parameters[name] = float(np.clip(middle[name], least, most))
        held = [c.name for c in self.schedule.contacts if c.name in self.schedule.held[index]]
        loads = _loads(self.stance, held, fractions, motion)

        def columns(variables: Sequence[Variable]) -> Curve:
            def curve(s: Array) -> Array:
                s = np.asarray(s, dtype=float)
                q, v, a = motion(s)
                known = {f"q.{n}": q[:, i] for i, n in enumerate(robot.position_names)}
                for kind, values in (("v", v), ("a", a)):
                    known |= {f"{kind}.{n}": values[:, i] for i, n in enumerate(robot.velocity_names)}
                known |= {name: np.interp(s, fractions, values) for name, values in loads.items()}
                still = np.zeros(len(s))
                return np.column_stack([known.get(x.name, still) for x in variables] or [np.zeros((len(s), 0))])

            return curve

        dae = phase.dae
        return PhaseGuess(duration, columns(dae.states), columns(dae.algebraic), columns(dae.controls), parameters)

    def of_link(self, link: BoundLink, index: int) -> dict[str, float]:
        """Feet come down softly: impulses upwards, a small part of the weight."""
        weight = pin.computeTotalMass(self.stance.robot.model) * float(
            np.linalg.norm(self.stance.robot.model.gravity.linear)
        )
        up = [unknown.name for unknown in link.unknowns if unknown.name.endswith(".z")]
        return {name: LANDING * weight / len(up) for name in up}


def _loads(stance: Stance, held: Sequence[str], fractions: Array, motion: Any) -> dict[str, Array]:
    """Contact forces and torques by variable name, at fractions of a phase."""
    robot = stance.robot
    names = [force.name for contact in stance.contacts if contact.name in held for force in contact.forces]
    rows = [support(stance, held, *row) for row in zip(*motion(fractions), strict=True)]
    forces, torques = (np.array([row[k] for row in rows]) for k in (0, 1))
    return {name: forces[:, i] for i, name in enumerate(names)} | {
        f"tau.{joint}": torques[:, i] for i, joint in enumerate(robot.actuated)
    }


def _fixed(q: Array, bounds: Any) -> Array:
    """Configuration with the entries that bounds fix."""
    q = np.array(q)
    n = len(q)
    fixed = bounds.lower[:n] == bounds.upper[:n]
    q[fixed] = bounds.lower[:n][fixed]
    return q
