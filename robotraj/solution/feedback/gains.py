"""Time-varying linear feedback along a plan, from the linearisation about the plan."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol, TypedDict

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.design.binding import realised
from robotraj.robot.robot import Robot
from robotraj.solution.feedback.linearisation import Linearisation
from robotraj.solution.feedback.riccati import backwards, transition
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.sample import Times

BANDWIDTH = 20.0
"""Bandwidth of the feedback [1/s]: above the rate at which a small robot falls, below the bandwidth of drives."""

LONGEST_PIECE = 0.02
"""Longest time [s] for which the linearised motion and its gain count as constant."""

IDLE = 1e-6
"""Least cost of a torque without motion, relative to that of the motor's torque; it determines internal forces."""


class PlanLike(Protocol):
    """The attributes of a solution that the gains depend on."""

    @property
    def phases(self) -> Sequence[PhaseSolution]:
        """Phases in their order in time."""


class PlainPhase(TypedDict):
    """Gains of one phase in a file; see ``PhaseGains``."""

    times: Array
    matrices: Array
    growth: Array


class PlainGains(TypedDict):
    """Gains in a file; see ``Gains``."""

    joints: list[str]
    coordinates: list[str]
    phases: list[PlainPhase]


@dataclass(frozen=True, eq=False)
class PhaseGains(OneLine):
    """Gains of one phase.

    Attributes
    ----------
    times : ndarray (m,)
        Global times [s], ascending.
    matrices : ndarray (m, nu, 2 nv)
        K at these times: [N m/rad] and [N m s/rad] for joints that turn, [N/m] and [N s/m] for those that slide.
    growth : ndarray (m,)
        Largest factor by which a deviation at the start of the plan has grown without feedback at ``times``. Velocities
        have a weight of a tenth, so that 1 rad is as large as 10 rad/s. It is infinite on overflow.
    """

    times: Array
    matrices: Array
    growth: Array

    def at(self, t: Times) -> Array:
        """Gains (nu, 2 nv), or (m, nu, 2 nv) for m times: linear between ``times``, constant outside of them."""
        where = np.clip(np.asarray(t, dtype=float), self.times[0], self.times[-1])
        after = np.clip(np.searchsorted(self.times, where), 1, max(len(self.times) - 1, 1))
        if len(self.times) == 1:
            return np.asarray(self.matrices[np.zeros_like(after)])
        begin, end = self.times[after - 1], self.times[after]
        share = ((where - begin) / (end - begin))[..., None, None]
        return np.asarray((1.0 - share) * self.matrices[after - 1] + share * self.matrices[after])


@dataclass(frozen=True, eq=False)
class Gains(OneLine):
    """Feedback that stabilises a robot on its plan.

        tau(t) = tau_plan(t) - K(t) e,    e = (difference(q_plan, q), v - v_plan)

    ``difference`` is Pinocchio's: q - q_plan for joints; for a floating root its displacement in the axes of the
    planned root and a rotation vector. e has 2 nv entries in the order of ``robot.velocity_names``, positions first.

    The gains minimise the integral of w^4 |e_q|^2 + w^2 |e_v|^2 + |Y u|^2, where w = 20 / s and Y u is the acceleration
    of the robot with its contacts by a torque u. Every motor therefore corrects in proportion to the inertia that it
    moves. With a motor at every joint, K is about M(q) (w^2, 1.7 w).

    Attributes
    ----------
    phases : tuple of PhaseGains
    joints : tuple of str
        Actuated joints, the rows of K.
    coordinates : tuple of str
        Names of the velocities, the columns of K, for positions and again for velocities.
    """

    phases: tuple[PhaseGains, ...]
    joints: tuple[str, ...]
    coordinates: tuple[str, ...]

    @property
    def times(self) -> Array:
        """Times of all phases (m,) [s]."""
        return np.concatenate([phase.times for phase in self.phases])

    @property
    def matrices(self) -> Array:
        """K (m, nu, 2 nv) at ``times``."""
        return np.concatenate([phase.matrices for phase in self.phases])

    @property
    def growth(self) -> float:
        """Largest factor by which a small deviation grows along the plan without feedback."""
        return float(max(phase.growth.max() for phase in self.phases))

    @property
    def plain(self) -> PlainGains:
        """Return names and arrays for a file; ``Gains.of`` is the inverse."""
        phases = [PlainPhase(times=p.times, matrices=p.matrices, growth=p.growth) for p in self.phases]
        return {"joints": list(self.joints), "coordinates": list(self.coordinates), "phases": phases}

    @classmethod
    def of(cls, plain: PlainGains) -> Gains:
        """Return the gains of the data that ``plain`` returned."""
        phases = tuple(PhaseGains(**phase) for phase in plain["phases"])
        return cls(phases, tuple(plain["joints"]), tuple(plain["coordinates"]))

    def at(self, t: float) -> Array:
        """Return K (nu, 2 nv) at a global time [s]; where two phases meet, that of the later one."""
        starts = [phase.times[0] for phase in self.phases[1:]]
        return self.phases[int(np.searchsorted(starts, t, side="right"))].at(t)


class _Pieces(NamedTuple):
    """A phase cut into pieces: transition matrices (F, G) and roots of the cost of each."""

    times: Array
    moves: list[tuple[Array, Array]]
    weights: list[tuple[Array, Array]]


def gains_of(solution: PlanLike) -> Gains:
    """Find the gains of a plan.

    Raises
    ------
    InputError
        A phase moves a System, or its robot has no motors or other joints than the phase before. The linearisation is
        not finite; the message names phase and time.
    """
    robots: list[Robot] = []
    for planned in solution.phases:
        robot = planned.phase.robot
        if robot is None:
            raise InputError(f"Phase {planned.phase.name!r} moves an rt.System; gains are found for robots.")
        if not robot.actuated:
            raise InputError(f"The robot of phase {planned.phase.name!r} has no motors; there is nothing to feed back.")
        robots.append(robot)
        if tuple(robot.velocity_names) != tuple(robots[0].velocity_names):
            raise InputError(f"Phase {planned.phase.name!r} has other joints than the first; gains need the same ones.")
    parts = [_pieces(planned) for planned in solution.phases]
    size = 2 * len(robots[0].velocity_names)
    root = np.asarray(np.kron(_endless(), np.eye(size // 2)), dtype=float)
    found: list[Array] = []
    for planned, part in reversed(list(zip(solution.phases, parts, strict=True))):
        root, gains = backwards(root, part.moves, part.weights)
        if not (np.isfinite(root).all() and all(np.isfinite(gain).all() for gain in gains)):
            raise InputError(
                f"The feedback of phase {planned.phase.name!r} is not finite: a deviation that no motor can correct "
                "grows without bound. Plan a shorter motion, or add motors."
            )
        found.append(np.array(gains))
    growth = _growth([part.moves for part in parts], size)
    phases = zip(parts, found[::-1], growth, strict=True)
    return Gains(
        tuple(PhaseGains(part.times, gains, factors) for part, gains, factors in phases),
        tuple(robots[0].actuated),
        tuple(robots[0].velocity_names),
    )


def _pieces(planned: PhaseSolution) -> _Pieces:
    """Cut the intervals of a phase into short pieces and linearise each in its middle."""
    robot = realised(planned)
    linearisation = Linearisation(robot, planned.phase.bound_contacts)
    knots = np.asarray(planned.knots, dtype=float)
    moves: list[tuple[Array, Array]] = []
    weights: list[tuple[Array, Array]] = []
    spans = [(k, a, b) for k, (a, b) in enumerate(zip(knots[:-1], knots[1:], strict=True)) if b > a]
    counts = [max(1, int(np.ceil((b - a) / LONGEST_PIECE))) for _, a, b in spans]
    lengths = np.repeat([(b - a) / n for (_, a, b), n in zip(spans, counts, strict=True)], counts)
    places = [a + (b - a) * (np.arange(n) + 0.5) / n for (_, a, b), n in zip(spans, counts, strict=True)]
    middles = np.concatenate(places)
    sample = planned.at(middles, interval=np.repeat([k for k, _, _ in spans], counts))
    for t, length, q, v, tau in zip(middles, lengths, sample.q, sample.v, sample.tau, strict=True):
        rate, push, consistent = _linear(linearisation, q, v, tau, planned.phase.name, float(t))
        step, inputs = transition(rate, push, length)
        nv = len(v)
        effect = push[nv:]
        sizes = np.sqrt(IDLE) * np.maximum(np.linalg.norm(effect, axis=0), np.finfo(float).tiny ** 0.5)
        moves.append((step @ consistent, inputs))
        weights.append((np.sqrt(length) * _weight(2 * nv), np.sqrt(length) * np.vstack([effect, np.diag(sizes)])))
    return _Pieces(middles, moves, weights)


def _linear(
    linearisation: Linearisation, q: Array, v: Array, tau: Array, phase: str, t: float
) -> tuple[Array, Array, Array]:
    """Linearise; raise an InputError that names the time at which it is not possible."""
    try:
        found = linearisation.at(q, v, tau)
    except np.linalg.LinAlgError as error:
        raise InputError(
            f"The motion of phase {phase!r} cannot be linearised at t = {t:.4g} s: the mass matrix of the robot is not "
            "positive definite there. Give every moving link a mass, or its joint an armature."
        ) from error
    if not all(np.isfinite(part).all() for part in found):
        raise InputError(
            f"The motion of phase {phase!r} cannot be linearised at t = {t:.4g} s: positions, velocities or torques of "
            "the plan are not finite there. Solve the plan first."
        )
    return found


def _weight(size: int) -> Array:
    """Root of the cost of a deviation (size,): w^2 for positions and w for velocities."""
    half = size // 2
    return np.concatenate([np.full(half, BANDWIDTH**2), np.full(half, BANDWIDTH)])


def _endless() -> Array:
    """Return the root (2, 2) of the cost at the end: that of holding one coordinate by its own drive for ever."""
    cost = [[np.sqrt(3.0) * BANDWIDTH**3, BANDWIDTH**2], [BANDWIDTH**2, np.sqrt(3.0) * BANDWIDTH]]
    return np.asarray(np.linalg.cholesky(np.array(cost)).T)


def _growth(phases: Sequence[Sequence[tuple[Array, Array]]], size: int) -> list[Array]:
    """Largest singular value of the transition from the start of the plan to the end of each piece, by phase."""
    scale = np.concatenate([np.ones(size // 2), np.full(size // 2, 0.1)])
    product, exponent = np.eye(size), 0.0
    found = []
    for moves in phases:
        factors = []
        for step, _ in moves:
            product = (scale[:, None] * step / scale) @ product
            norm = float(np.linalg.norm(product, 2))
            # The product is normalised to size 1, so that it does not overflow.
            product, exponent = (product / norm, exponent + np.log(norm)) if norm > 0 else (product, exponent)
            factors.append(np.exp(exponent) if exponent < 700.0 else np.inf)
        found.append(np.array(factors))
    return found
