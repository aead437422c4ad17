"""A gait repeated several times: each period is displaced from the last, and mirrored if the plan is half a gait."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robotraj._util.arrays import Array
from robotraj._util.checks import whole
from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.dynamics.variable import Named
from robotraj.problem.links.touchdown import Touchdown
from robotraj.problem.phase import Phase
from robotraj.robot.robot import Robot
from robotraj.solution.cycles.cycle_map import CycleMap, cycle_map_of
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.sample import Sample
from robotraj.solution.solution import Solution

MOST = 1_000
"""Largest number of periods."""


@dataclass(frozen=True, eq=False)
class CycleSample(OneLine):
    """Values of a later period at some times, with the attributes of a ``Sample``.

    Attributes
    ----------
    t : float or ndarray (m,)
        [s].
    q, v, a, tau : ndarray
        (nq,), (nv,), (nv,), (nu,), or with m rows.
    forces : Named
        By contact, (3,) or (6,), or with m rows [N, N m].
    """

    t: float | Array
    q: Array
    v: Array
    a: Array
    tau: Array
    forces: Named[Array]


@dataclass(frozen=True, eq=False)
class CyclePhase(OneLine):
    """One phase of one period, with the attributes of a ``PhaseSolution``.

    Attributes
    ----------
    planned : PhaseSolution
        The planned phase.
    index, period : int
        Number of the phase in the plan, and of the period, from 0.
    t0 : float
        Start time [s].
    cycle_map : CycleMap or None
        Map from one period to the next; None if the plan is not periodic.
    """

    planned: PhaseSolution
    index: int
    period: int
    t0: float
    cycle_map: CycleMap | None = None

    @property
    def phase(self) -> Phase:
        """The phase of the problem, as it was planned."""
        return self.planned.phase

    @property
    def robot(self) -> Robot:
        """The robot of the phase.

        Raises
        ------
        InputError
            The phase moves a System.
        """
        if self.phase.robot is None:
            raise InputError(f"Phase {self.phase.name!r} moves an rt.System; only robots have contacts and shapes.")
        return self.phase.robot

    @property
    def parameters(self) -> Mapping[str, float]:
        """Planned parameters of the phase; footholds are those of the first period."""
        return self.planned.parameters

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return float(self.planned.duration)

    @property
    def knots(self) -> Array:
        """Times of the knots [s]."""
        return np.asarray(self.planned.knots, dtype=float) + (self.t0 - self.planned.t0)

    @property
    def mirrored(self) -> bool:
        """Whether left and right are swapped."""
        return self.cycle_map is not None and self.cycle_map.mirrors and self.period % 2 == 1

    @property
    def name(self) -> str:
        """Name of the phase, and whether it is its mirror image."""
        return f"{self.phase.name} (mirrored)" if self.mirrored else str(self.phase.name)

    def at(self, t: float | Array, interval: int | None = None) -> Sample[Any] | CycleSample:
        """Evaluate the plan at times [s] in the phase: a ``Sample`` in the first period, later a ``CycleSample``."""
        sample = self.planned.at(np.asarray(t, dtype=float) - (self.t0 - self.planned.t0), interval)
        if self.period == 0 or self.cycle_map is None:
            return sample
        q, v, a, tau = (np.asarray(getattr(sample, name), dtype=float) for name in ("q", "v", "a", "tau"))
        actuation = np.asarray(self.robot.actuation)
        turned = actuation.T @ self.cycle_map.velocities @ actuation
        for _ in range(self.period):
            q, v, a, tau = (
                self.cycle_map.onwards(q),
                v @ self.cycle_map.velocities,
                a @ self.cycle_map.velocities,
                tau @ turned,
            )
        forces = {self.contact(c): self.forces(sample.forces[c.name]) for c in self.phase.bound_contacts}
        return CycleSample(t, q, v, a, tau, Named("contact", list(forces), list(forces.values())))

    def contact(self, bound: BoundContact) -> str:
        """Name of the contact in this period that corresponds to ``bound`` in the plan."""
        if self.cycle_map is None or not self.mirrored:
            return str(bound.name)
        return self.cycle_map.partner(bound.name, bound.frame)

    def points(self, points: ArrayLike) -> Array:
        """Return points (..., 3) of the plan [m] as they are in this period."""
        moved = np.asarray(points, dtype=float)
        for _ in range(self.period if self.cycle_map is not None else 0):
            moved = self.cycle_map.points_onwards(moved)  # type: ignore[union-attr]
        return moved

    def bounds(self, quantity: str, lower: Array, upper: Array) -> tuple[Array, Array]:
        """Bounds of the plan's ``"q"``, ``"v"`` or ``"tau"`` as they are in this period."""
        if self.cycle_map is None or not len(lower):
            return lower, upper
        actuation = np.asarray(self.robot.actuation)
        matrix, shift = {
            "q": (self.cycle_map.positions, self.cycle_map.shift),
            "v": (self.cycle_map.velocities, np.zeros(len(actuation))),
            "tau": (actuation.T @ self.cycle_map.velocities @ actuation, np.zeros(actuation.shape[1])),
        }[quantity]
        sources = np.abs(matrix).argmax(axis=0)
        flipped = matrix[sources, np.arange(len(sources))] < 0.0
        for _ in range(self.period):
            low, high = (lower - shift)[sources], (upper - shift)[sources]
            lower, upper = np.where(flipped, -high, low), np.where(flipped, -low, high)
        return lower, upper

    def forces(self, forces: ArrayLike) -> Array:
        """Return forces or directions (..., 3), or wrenches (..., 6), of the plan as they are in this period."""
        turned = np.asarray(forces, dtype=float)
        for _ in range(self.period if self.cycle_map is not None else 0):
            turned = self.cycle_map.forces_onwards(turned)  # type: ignore[union-attr]
        return turned


@dataclass(frozen=True, eq=False)
class PlannedImpact(OneLine):
    """Impulses of one touchdown.

    Attributes
    ----------
    t : float
        Time of the impact [s].
    after : CyclePhase
        The phase that starts with it. After the last period it is not among the phases of the motion.
    impulses : mapping of str to float
        Planned impulses, such as ``"impulse.left_foot.z"`` [N s, N m s].
    """

    t: float
    after: CyclePhase
    impulses: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class GaitCycles(OneLine):
    """A solution repeated ``periods`` times; its phases have the attributes of those of a solution.

    Attributes
    ----------
    solution : Solution
    periods : int
    cycle_map : CycleMap or None
        None if the plan is not periodic; then there is one period.
    """

    solution: Solution
    periods: int
    cycle_map: CycleMap | None

    @property
    def period(self) -> float:
        """Duration of one period [s]."""
        phases = self.solution.phases
        return float(phases[-1].t0 + phases[-1].duration - phases[0].t0)

    @property
    def duration(self) -> float:
        """Duration of all periods [s]."""
        return self.periods * self.period

    @property
    def phases(self) -> tuple[CyclePhase, ...]:
        """All phases of all periods, in time."""
        return tuple(self.phase(i, k) for k in range(self.periods) for i in range(len(self.solution.phases)))

    @property
    def impacts(self) -> tuple[PlannedImpact, ...]:
        """Impacts of all periods in time, the one that ends the motion included."""
        phases = self.solution.phases
        found = []
        for link, impulses in zip(self.solution.problem.links, self.solution.impulses, strict=False):
            if not isinstance(link, Touchdown):
                continue
            first, second = link.first % len(phases), link.second % len(phases)
            for period in range(self.periods):
                after = self.phase(second, period if link.repeat is None else period + 1)
                before = self.phase(first, period)
                found.append(PlannedImpact(before.t0 + before.duration, after, impulses))
        return tuple(sorted(found, key=lambda impact: impact.t))

    def phase(self, index: int, period: int) -> CyclePhase:
        """Return phase ``index`` of a period, which may be after the last."""
        planned = self.solution.phases[index]
        return CyclePhase(planned, index, period, float(planned.t0) + period * self.period, self.cycle_map)


def gait_cycles(solution: Solution, periods: int = 1) -> GaitCycles:
    """Repeat a plan ``periods`` times.

    Raises
    ------
    InputError
        ``periods`` is no whole number from 1 to ``MOST``, or several periods are wanted of a System or of a plan
        without a periodic link.
    """
    whole("periods", periods, 1, MOST)
    if periods > 1 and any(planned.phase.robot is None for planned in solution.phases):
        raise InputError(
            f"periods = {periods}, but the plan moves an rt.System; only robots are repeated. Use periods=1."
        )
    cycle_map = cycle_map_of(solution)
    if cycle_map is None and periods > 1:
        raise InputError(
            f"periods = {periods}, but the plan ends elsewhere than it starts: no rt.Periodic, rt.Mirror or "
            "rt.Touchdown(repeat=...) closes it. Use periods=1."
        )
    return GaitCycles(solution, periods, cycle_map)
