"""The energy balance of a plan: work of the motors = change of energy + dissipation."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.design.binding import realised
from robotraj.robot.coupling.dynamics import kinetic_energy, potential_energy
from robotraj.witness.contacts.stance import Stance, forces_in
from robotraj.witness.planned import robot_sample
from robotraj.witness.protocols import PhaseSolutionLike, RobotLike
from robotraj.witness.sampling import interval_samples

QUADRATURE_POINTS = 16
"""Gauss-Legendre points of an interval, exact for a power of degree 31 in time."""


@dataclass(frozen=True)
class Energy(OneLine):
    """The energy balance along the planned polynomials.

    Attributes
    ----------
    work : float
        Work of the actuators, integral of (B tau)'v [J].
    dissipated : float
        Energy dissipated by damping and friction, integral of d(v)'v, and by sliding contacts, of -(J' f)'v [J].
    change : float
        Change of kinetic plus potential energy over the intervals [J].
    scale : float
        Scale of the energies: the largest of the integral of |(B tau)'v|, ``dissipated`` and the range of the kinetic
        energy [J].
    worst : float
        Largest imbalance of one interval [J].
    time : float
        Beginning of that interval [s].
    """

    work: float
    dissipated: float
    change: float
    scale: float
    worst: float
    time: float

    @property
    def imbalance(self) -> float:
        """Work minus dissipated energy minus change of energy [J]; zero along an exact motion."""
        return self.work - self.dissipated - self.change

    @property
    def relative(self) -> float:
        """|imbalance| / scale."""
        return abs(self.imbalance) / self.scale if self.scale > 0 else 0.0


def energy_of(
    planned: PhaseSolutionLike, samples: int = QUADRATURE_POINTS, clock: Callable[[], None] = lambda: None
) -> Energy:
    """Return the energy balance of a robot's phase: power, integrated over every interval, and change of energy."""
    robot: RobotLike = realised(planned)
    actuation = np.asarray(robot.actuation, dtype=float)
    nodes, weights = np.polynomial.legendre.leggauss(samples)
    data = robot.model.createData()
    sliding = [contact for contact in planned.phase.bound_contacts if not contact.holds]
    stance = Stance(robot, sliding, planned.parameters)
    work = dissipated = change = moved = 0.0
    worst, time = 0.0, float(planned.knots[0])
    kinetic: list[float] = []
    for part in interval_samples(planned, samples, 0.5 * (nodes + 1.0)):
        clock()
        half, shape = 0.5 * (part.ends - part.begins), (len(part.intervals), samples)
        sample = robot_sample(planned, part.times, part.interval)
        power = np.einsum("mi,mi->m", sample.tau @ actuation.T, sample.v).reshape(shape)
        loss = np.array([robot.dissipation(v) @ v for v in sample.v])
        if sliding:
            pushes = [stance.torques(q, forces_in(sample, sliding, i)) for i, q in enumerate(sample.q)]
            loss -= np.einsum("mi,mi->m", np.array(pushes), sample.v)
        inside = zip(sample.q, sample.v, strict=True)
        kinetic += [kinetic_energy(robot.model, data, q, v) for q, v in inside]
        ends = part._replace(sites=np.array([0.0, 1.0]))
        there = robot_sample(planned, ends.times, ends.interval)
        totals = np.array([_total(robot, data, q, v) for q, v in zip(there.q, there.v, strict=True)])
        terms = half * (power @ weights), half * (loss.reshape(shape) @ weights), totals[1::2] - totals[::2]
        work, dissipated, change = work + terms[0].sum(), dissipated + terms[1].sum(), change + terms[2].sum()
        moved += np.sum(half * (np.abs(power) @ weights))
        imbalances = np.nan_to_num(np.abs(terms[0] - terms[1] - terms[2]), nan=np.inf)
        if (largest := np.max(imbalances)) > worst:
            worst, time = float(largest), float(part.begins[np.argmax(imbalances)])
    scale = max(moved, abs(dissipated), max(kinetic, default=0.0) - min(kinetic, default=0.0))
    return Energy(float(work), float(dissipated), float(change), float(scale), float(worst), time)


def add(parts: Sequence[Energy]) -> Energy | None:
    """Return the sum of the balances of several phases, None without phases."""
    if not parts:
        return None
    worst = max(parts, key=lambda part: part.worst)
    return Energy(
        work=sum(part.work for part in parts),
        dissipated=sum(part.dissipated for part in parts),
        change=sum(part.change for part in parts),
        scale=sum(part.scale for part in parts),
        worst=worst.worst,
        time=worst.time,
    )


def _total(robot: RobotLike, data: object, q: Array, v: Array) -> float:
    """Return kinetic (armature included) plus potential energy, springs included [J]."""
    stored = potential_energy(robot.model, data, q) + robot.spring_energy(q)
    return kinetic_energy(robot.model, data, q, v) + stored
