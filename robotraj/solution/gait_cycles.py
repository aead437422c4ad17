"""A plan run through several times: every period displaced from the last, and mirrored if the plan is half a gait.

The plan's closing link says how its start x_0 sees its end x_T: x_0 = P x_T + d, with P a permutation with signs (the
identity, or left and right swapped). So the next period goes on where the last one ended if it follows
F(x) = P' (x - d), the one after F(F(x)), and so on. Points and forces follow the root: p_0 = W p_T + e.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.design.binding import realised
from robotraj.dynamics.variable import Named
from robotraj.problem.links.periodic import Mirror, Periodic
from robotraj.problem.links.touchdown import Touchdown
from robotraj.robot.root import QUATERNION

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Return(OneLine):
    """How the start of a plan sees its end: q_0 = P q_T + d, v_0 = P_v v_T, and points of the world p_0 = W p_T + e.

    Attributes
    ----------
    positions : ndarray (nq, nq)
        P.
    shift : ndarray (nq,)
        d [m, rad]; zero for a quaternion.
    velocities : ndarray (nv, nv)
        P_v.
    partners : mapping of str to str
        Joints and contacts, or their frames, that change places.
    world : ndarray (3, 3)
        W, diagonal: signs of the root's coordinates; a mirror of a robot without them swaps left and right, y.
    moved : ndarray (3,)
        e [m].
    """

    positions: Array
    shift: Array
    velocities: Array
    partners: Mapping[str, str] = field(default_factory=dict)
    world: Array = field(default_factory=lambda: np.eye(3))
    moved: Array = field(default_factory=lambda: np.zeros(3))

    @property
    def mirrors(self) -> bool:
        """Whether left and right are swapped, so that two periods make a whole one."""
        return not np.array_equal(self.velocities, np.eye(len(self.velocities)))

    def onwards(self, q: Array) -> Array:
        """Position (..., nq) as it is a period later."""
        return np.asarray((q - self.shift) @ self.positions)

    def back(self, q: Array) -> Array:
        """Position (..., nq) as it was a period before."""
        return np.asarray(q @ self.positions.T + self.shift)

    def points_onwards(self, points: Array) -> Array:
        """Points (..., 3) of the world [m] as they are a period later."""
        return np.asarray((points - self.moved) @ self.world)

    def forces_onwards(self, forces: Array) -> Array:
        """Give forces (..., 3), or with moments (..., 6), in world axes as they are a period later [N, N m].

        A moment m = r x f turns with det(W) W: a mirror turns it round where it lies in the mirror.
        """
        linear, angular = forces[..., :3] @ self.world, forces[..., 3:]
        if angular.shape[-1] == 0:
            return np.asarray(linear)
        return np.concatenate([linear, np.linalg.det(self.world) * (angular @ self.world)], axis=-1)

    def partner(self, *names: str) -> str:
        """Name of what takes the place a period later: a contact is looked up by its own name, then by its frame's."""
        return next((self.partners[name] for name in names if name in self.partners), names[0])


@dataclass(frozen=True, eq=False)
class Moment(OneLine):
    """What a later period says at some times, as a ``Sample`` of the plan does.

    Attributes
    ----------
    t : float or ndarray (m,)
        [s].
    q, v, a, tau : ndarray
        (nq,), (nv,), (nv,), (nu,), or with m rows.
    forces : Named
        By contact, (3,) or (6,), or with m rows [N, N m].
    """

    t: Any
    q: Array
    v: Array
    a: Array
    tau: Array
    forces: Named


@dataclass(frozen=True, eq=False)
class Passage(OneLine):
    """One phase of one period; it is read like the phase's solution.

    Attributes
    ----------
    planned : PhaseSolution
        As it was planned.
    index, period : int
        Which phase of the plan, and of which period; from 0.
    t0 : float
        When it starts [s].
    closing : Return or None
        How the plan closes on itself, where it does.
    """

    planned: Any
    index: int
    period: int
    t0: float
    closing: Return | None = None

    @property
    def phase(self) -> Any:
        """The phase of the problem, as it was planned."""
        return self.planned.phase

    @property
    def parameters(self) -> Any:
        """Parameters of the phase, as they were planned: footholds are those of the first period."""
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
        return self.closing is not None and self.closing.mirrors and self.period % 2 == 1

    @property
    def name(self) -> str:
        """Name of the phase, and whether it is its mirror image."""
        return f"{self.phase.name} (mirrored)" if self.mirrored else str(self.phase.name)

    def at(self, t: Any, interval: int | None = None) -> Any:
        """Evaluate the plan at times [s] within the passage: its own sample in the first period, later a ``Moment``."""
        sample = self.planned.at(np.asarray(t, dtype=float) - (self.t0 - self.planned.t0), interval)
        if self.period == 0 or self.closing is None:
            return sample
        q, v, a, tau = (np.asarray(getattr(sample, name), dtype=float) for name in ("q", "v", "a", "tau"))
        actuation = np.asarray(self.phase.robot.actuation)
        turned = actuation.T @ self.closing.velocities @ actuation
        for _ in range(self.period):
            q, v, a, tau = (
                self.closing.onwards(q),
                v @ self.closing.velocities,
                a @ self.closing.velocities,
                tau @ turned,
            )
        forces = {self.contact(c): self.forces(sample.forces[c.name]) for c in self.phase.bound_contacts}
        return Moment(t, q, v, a, tau, Named("contact", list(forces), list(forces.values())))

    def contact(self, bound: Any) -> str:
        """Name of the contact that holds here where the plan holds ``bound``."""
        if self.closing is None or not self.mirrored:
            return str(bound.name)
        return self.closing.partner(bound.name, bound.frame)

    def points(self, points: Any) -> Array:
        """Points (..., 3) of the plan [m] where they are in this period."""
        moved = np.asarray(points, dtype=float)
        for _ in range(self.period if self.closing is not None else 0):
            moved = self.closing.points_onwards(moved)  # type: ignore[union-attr]
        return moved

    def bounds(self, quantity: str, lower: Array, upper: Array) -> tuple[Array, Array]:
        """Bounds of the plan's ``"q"``, ``"v"`` or ``"tau"`` as they are in this period."""
        if self.closing is None or not len(lower):
            return lower, upper
        actuation = np.asarray(self.phase.robot.actuation)
        matrix, shift = {
            "q": (self.closing.positions, self.closing.shift),
            "v": (self.closing.velocities, np.zeros(len(actuation))),
            "tau": (actuation.T @ self.closing.velocities @ actuation, np.zeros(actuation.shape[1])),
        }[quantity]
        sources = np.abs(matrix).argmax(axis=0)
        flipped = matrix[sources, np.arange(len(sources))] < 0.0
        for _ in range(self.period):
            low, high = (lower - shift)[sources], (upper - shift)[sources]
            lower, upper = np.where(flipped, -high, low), np.where(flipped, -low, high)
        return lower, upper

    def forces(self, forces: Any) -> Array:
        """Give forces or directions (..., 3), or wrenches (..., 6), of the plan as they are in this period."""
        turned = np.asarray(forces, dtype=float)
        for _ in range(self.period if self.closing is not None else 0):
            turned = self.closing.forces_onwards(turned)  # type: ignore[union-attr]
        return turned


@dataclass(frozen=True, eq=False)
class PlannedImpact(OneLine):
    """Impulses of one touchdown.

    Attributes
    ----------
    t : float
        When [s].
    after : Passage
        The passage that starts with it; it need not be among those of the motion, as behind the last period.
    impulses : mapping of str to float
        As planned, ``"impulse.left_foot.z"`` [N s, N m s].
    """

    t: float
    after: Passage
    impulses: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class Unrolled(OneLine):
    """A solution passed through ``periods`` times; read like a solution, but for what ``Passage`` does not say.

    Attributes
    ----------
    solution : Solution
    periods : int
    closing : Return or None
        None where the plan ends elsewhere than it starts; then there is one period.
    """

    solution: Any
    periods: int
    closing: Return | None

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
    def phases(self) -> tuple[Passage, ...]:
        """All phases of all periods, in the order they are passed through."""
        return tuple(self.passage(i, k) for k in range(self.periods) for i in range(len(self.solution.phases)))

    @property
    def impacts(self) -> tuple[PlannedImpact, ...]:
        """Impacts of all periods in time, the one that ends the motion included."""
        phases = self.solution.phases
        links = getattr(getattr(self.solution, "problem", None), "links", ())
        found = []
        for link, impulses in zip(links, getattr(self.solution, "impulses", ()), strict=False):
            if not isinstance(link, Touchdown):
                continue
            first, second = link.first % len(phases), link.second % len(phases)
            for period in range(self.periods):
                after = self.passage(second, period if link.repeat is None else period + 1)
                before = self.passage(first, period)
                found.append(PlannedImpact(before.t0 + before.duration, after, impulses))
        return tuple(sorted(found, key=lambda impact: impact.t))

    def passage(self, index: int, period: int) -> Passage:
        """Give phase ``index`` of a period, which may lie behind the last."""
        planned = self.solution.phases[index]
        return Passage(planned, index, period, float(planned.t0) + period * self.period, self.closing)


def unrolled(solution: Any, periods: int = 1) -> Unrolled:
    """Pass through a plan ``periods`` times.

    Raises
    ------
    InputError
        Not a whole number above 0; several periods of a plan that moves a System, or that no link closes on itself.
    """
    if not isinstance(periods, int) or isinstance(periods, bool) or periods < 1:
        raise InputError(f"periods = {periods!r}; give a whole number, 1 or more.")
    if periods > 1 and any(planned.phase.robot is None for planned in solution.phases):
        raise InputError(
            f"periods = {periods}, but the plan moves an rt.System; only robots are repeated. Leave it out."
        )
    closing = closing_of(solution)
    if closing is None and periods > 1:
        raise InputError(
            f"periods = {periods}, but the plan ends elsewhere than it starts: no rt.Periodic, rt.Mirror or "
            "rt.Touchdown(repeat=...) closes it. Follow it once."
        )
    return Unrolled(solution, periods, closing)


def closing_of(solution: Any) -> Return | None:
    """Find the link from the last phase to the first, and how far the plan gets in a period; None without one."""
    phases = solution.phases
    for link in getattr(getattr(solution, "problem", None), "links", ()):
        if isinstance(link, Periodic | Mirror):
            repeat, first, last = link, link.first, link.last
        elif isinstance(link, Touchdown) and link.repeat is not None:
            repeat, first, last = link.repeat, link.second, link.first
        else:
            continue
        if first % len(phases) == 0 and last % len(phases) == len(phases) - 1 and phases[0].phase.robot is not None:
            return _read(repeat, phases[0], phases[-1])
    return None


def _read(repeat: Periodic | Mirror, opening: Any, closing: Any) -> Return:
    """Write a repetition as matrices."""
    robot = realised(opening)
    nq, nv = robot.nq, robot.nv
    names = [state.name for state in opening.phase.body.states][: nq + nv]
    seen = repeat.of(closing.phase, names, type(repeat).__name__)
    matrix = np.zeros((nq + nv, nq + nv))
    for row, (source, sign) in enumerate(seen.sources[: nq + nv]):
        matrix[row, names.index(source)] = sign
    positions = matrix[:nq, :nq]
    start, end = opening.at(opening.knots[0]), closing.at(closing.knots[-1])
    shift = np.asarray(start.q, dtype=float).ravel() - positions @ np.asarray(end.q, dtype=float).ravel()
    fixed = np.equal(seen.lower[:nq], seen.upper[:nq])
    shift[fixed] = np.asarray(seen.lower[:nq])[fixed]
    if nq > nv:
        shift[QUATERNION] = 0.0
    world, moved = np.diag([1.0, -1.0 if isinstance(repeat, Mirror) else 1.0, 1.0]), np.zeros(3)
    for axis, name in enumerate(("q.root_x", "q.root_y", "q.root_z")):
        if name in names:
            row = names.index(name)
            world[axis, axis], moved[axis] = positions[row, row], shift[row]
    return Return(positions, shift, matrix[nq:, nq:], seen.partners, world, moved)
