"""A gait that is planned again from measured states: its horizons, their clock and their frame."""

from __future__ import annotations

import time
from collections.abc import Collection
from dataclasses import replace

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.checks import whole
from robotraj._util.errors import InputError
from robotraj.applications.replanning.deadline import Deadline
from robotraj.applications.replanning.gait_ticks import Tick, cycle_of, ticks_of, touching
from robotraj.applications.replanning.horizon import Horizon
from robotraj.applications.replanning.replan import Replan
from robotraj.guess.from_solution import FromSolution
from robotraj.planning.plan import plan
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.problem.state import State
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.solution import Solution
from robotraj.solvers.interior_point import InteriorPoint
from robotraj.transcription.schemes.lobatto import HermiteSimpson
from robotraj.transcription.schemes.mesh import Mesh

INTERVALS = 4
"""Intervals of the longest phase by default."""
MOST_AHEAD = 20
"""Largest number of phases ahead."""
EARLY = 0.5
"""Share of a phase after which the feet of the next one may land early."""


class GaitLoop:
    """The horizons of a gait, one for every tick of its cycle, and which of them a step solves.

    Each horizon starts from its own last solution, of one cycle before: a gait repeats, and so do its multipliers.
    Horizons are planned where the gait is in its first cycle. A measured state is moved there along the ground, and the
    plan back.
    """

    def __init__(
        self,
        problem: Problem,
        mesh: Mesh | None,
        guess: InitialGuess | Solution | None,
        solver: InteriorPoint,
        period: float,
        ahead: int,
        deadline: float | None,
    ) -> None:
        self.gait = guess if isinstance(guess, Solution) else plan(problem, guess=guess)
        self._deadline, self.cycle = Deadline(deadline), cycle_of(self.gait)
        self.ticks: tuple[Tick, ...] = ticks_of(self.cycle, period, whole("ahead", ahead, 1, MOST_AHEAD))
        mesh = mesh or Mesh(INTERVALS, HermiteSimpson())
        longest = max(phase.duration for phase in self.cycle.phases)
        self._horizons: list[Horizon] = []
        known: Solution | None = None
        for tick in self.ticks:
            same = known is not None and _feet(known.problem) == _feet(tick.problem)
            shares = [float(phase.duration_bounds[0]) / longest for phase in tick.problem.phases]
            known = plan(
                tick.problem,
                mesh=[Mesh(max(1, round(mesh.count * share)), mesh.scheme) for share in shares],
                guess=FromSolution(known) if known is not None and same else None,
                solver=InteriorPoint(fallback=None),
                keep_program=True,
                progress=False,
            )
            self._horizons.append(Horizon(known, solver, of_gait=True))
        self._axes = 1 if self.cycle.joined.robot.root == "planar" else 2
        self._lead = 0.0
        self._last: Replan | None = None

    def step(self, t: float, start: State, contacts: Collection[str] | None) -> Replan:
        """Plan from a measured state at a time [s]; ``contacts`` are the frames of the feet on the ground."""
        began = time.perf_counter()
        number = self._at(t, contacts)
        tick, horizon = self.ticks[number], self._horizons[number]
        q, v = self._measured(start)
        q, v = touching(tick.stance, q, v)
        moved = np.zeros(self._axes)
        moved[:] = q[: self._axes] - tick.q[: self._axes]
        q = np.array(q)
        q[: self._axes] = tick.q[: self._axes]
        values = horizon.numbers.values(0.0, State(q=q, v=v), None, {})[: len(horizon.numbers.columns)]
        found = horizon.solve(values, self._deadline.left(began))
        solved = time.perf_counter()
        if found.fresh:
            phases = [self._placed(part, t, moved) for part in horizon.motion(found)]
            self._last = Replan(
                t, phases[0], True, found.status, found.violation, found.iterations, 0.0, tuple(phases[1:])
            )
        if self._last is None:
            first = [self._placed(part, t, moved) for part in horizon.first.phases]
            self._last = Replan(
                t, first[0], False, found.status, found.violation, found.iterations, 0.0, tuple(first[1:])
            )
        ended = self._deadline.returned(solved)
        return replace(
            self._last,
            t=float(t),
            fresh=found.fresh,
            status=found.status,
            violation=found.violation,
            iterations=found.iterations,
            seconds=ended - began,
        )

    def _at(self, t: float, contacts: Collection[str] | None) -> int:
        """Return the tick of a time [s]; feet that land early, or late, move the clock to their landing.

        The feet before them carry the robot until then, else it has gone on, and a foot that lost the ground returns.
        """
        cycle, times = self.cycle.duration, np.array([tick.t for tick in self.ticks])
        elapsed = (t + self._lead) % cycle
        number = int(np.argmin(np.abs((elapsed - times + 0.5 * cycle) % cycle - 0.5 * cycle)))
        if contacts is None:
            return number
        here, standing = self.ticks[number], set(contacts)
        own = [k for k, tick in enumerate(self.ticks) if tick.phase == here.phase]
        begun = (number - own[0]) / len(own)
        if begun >= EARLY and standing >= set(here.following) and not set(here.following) <= set(here.feet):
            number = (own[-1] + 1) % len(self.ticks)
        elif begun < EARLY and standing >= set(self.ticks[own[0] - 1].feet) and not standing >= set(here.feet):
            number = (own[0] - 1) % len(self.ticks)
        else:
            return number
        self._lead += self.ticks[number].t - elapsed
        return number

    def _measured(self, start: State) -> tuple[Array, Array]:
        """Return configuration and velocity of a state that leaves nothing open."""
        robot, phase = self.cycle.joined.robot, self.ticks[0].problem.phases[0]
        given = start.bounds(phase.dae, "start")
        if not np.array_equal(given.lower, given.upper) or not np.isfinite(given.lower).all():
            raise InputError("A step of a gait needs every q and v of the measured start as a finite number.")
        return given.lower[: robot.nq], given.lower[robot.nq :]

    def _placed(self, part: PhaseSolution, t: float, moved: Array) -> PhaseSolution:
        """Return a planned phase on the clock of the caller, moved along the ground by ``moved`` [m]."""
        own = part.trajectory
        away = np.zeros(own.x.size)
        away[: self._axes] = moved
        shifts = {
            f"{c.name}.{axis}": gap for c in part.phase.bound_contacts for axis, gap in zip("xy", moved, strict=False)
        }
        trajectory = replace(
            own,
            t0=own.t0 + t,
            x=replace(own.x, breaks=own.x.breaks + t, values=[values + away for values in own.x.values]),
            z=replace(own.z, breaks=own.z.breaks + t),
            u=replace(own.u, breaks=own.u.breaks + t),
            points=own.points + t,
            parameters={name: value + shifts.get(name, 0.0) for name, value in own.parameters.items()},
        )
        return replace(part, trajectory=trajectory)


def _feet(problem: Problem) -> list[tuple[str, ...]]:
    """Return the contacts of each phase."""
    return [tuple(contact.name for contact in phase.bound_contacts) for phase in problem.phases]
