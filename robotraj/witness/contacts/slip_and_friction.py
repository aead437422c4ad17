"""Contacts of a planned phase between collocation points: places, planned forces, and forces of the equations."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.dynamics.contacts.force_measure import FORCE_SAMPLES, GRAVITY, measure
from robotraj.dynamics.design.binding import realised
from robotraj.dynamics.row import Row
from robotraj.dynamics.terrain.function import as_ground
from robotraj.robot.size.reach import reach
from robotraj.solution.violation import Violation
from robotraj.witness.checks.watch import Watch
from robotraj.witness.contacts.stance import Instant, Stance, forces_in
from robotraj.witness.numbers import as_numbers
from robotraj.witness.peak import Peak
from robotraj.witness.planned import robot_sample
from robotraj.witness.protocols import PhaseSolutionLike, RobotLike
from robotraj.witness.sampling import interval_samples

FORCE_NOISE = 1e-6
"""Largest violation, relative to the weight, that counts as the tolerance of a solver and is not listed."""

LIGHT = 0.05
"""Part of the weight below which a contact bears next to nothing; forces are compared with it at least."""


@dataclass(frozen=True)
class Holding(OneLine):
    """Slip, sink, turn and forces of one contact in one phase.

    Attributes
    ----------
    contact, phase : str
    slip : Peak
        Largest distance from the anchor along the ground [m], along the planned polynomials; in any direction for
        contacts without a ground.
    sink : Peak
        Largest distance from the ground, into it or above it [m].
    turn : Peak
        Largest angle from the anchor [rad], 0 for contacts that may turn.
    planned : tuple of Violation
        Limits of normal force, friction and centre of pressure that the planned forces violate.
    solved : tuple of Violation
        Limits that the forces of the equations of motion violate, under the planned q, v and tau. What the equations
        do not determine is as planned.
    difference : Peak or None
        Largest difference of planned and solved force [N], moments divided by the robot's reach; None where the
        contact's forces are not dual to held rows.
    weight : float
        Weight of the robot [N].
    largest : float
        Largest force of the equations [N], moments divided by the reach.
    shared : bool
        Whether the equations determine the contact's forces only together with those of others.
    """

    contact: str
    phase: str
    slip: Peak
    sink: Peak
    turn: Peak
    planned: tuple[Violation, ...]
    solved: tuple[Violation, ...]
    difference: Peak | None
    weight: float
    largest: float = 0.0
    shared: bool = False

    @property
    def force_error(self) -> float:
        """The difference relative to the largest force, or to a part of the weight where that is greater."""
        return 0.0 if self.difference is None else self.difference.value / max(LIGHT * self.weight, self.largest)


def part_of(violation: Violation, weight: float) -> float:
    """Return a violation relative to the weight [N], to its square for rows of squares; moments at 1 m."""
    return violation.amount / measure(violation.unit, weight)


def weight_of(robot: RobotLike) -> float:
    """Return the weight of all moving bodies [N]."""
    return GRAVITY * float(sum(inertia.mass for inertia in list(robot.model.inertias)[1:]))


def holding_of(
    planned: PhaseSolutionLike, samples: int, clock: Callable[[], None] = lambda: None
) -> tuple[Holding, ...]:
    """Evaluate every contact of a phase at ``samples`` points of every interval."""
    phase = planned.phase
    if not phase.bound_contacts:
        return ()
    stance = Stance(realised(planned), phase.bound_contacts, planned.parameters)
    watched = [_Watched(contact, stance, i) for i, contact in enumerate(phase.bound_contacts)]
    actuation = np.asarray(stance.robot.actuation, dtype=float)
    data = stance.robot.model.createData()
    for part in interval_samples(planned, min(samples, FORCE_SAMPLES)):
        clock()
        sample = robot_sample(planned, part.times, part.interval)
        for i, t in enumerate(part.times):
            q, v = sample.q[i], sample.v[i]
            held = stance.rows(q, v)
            gaps = stance.by_contact(held.gap)
            forces = forces_in(sample, phase.bound_contacts, i)
            applied = actuation @ sample.tau[i] - stance.robot.resistance(q, v)
            own = stance.forces(q, v, applied, held, forces)
            solved, unique = (None, False) if own is None else (stance.by_contact(own[0]), own[1])
            instant = Instant(stance.robot, data, q, v)
            for watch in watched:
                name = watch.contact.name
                # Forces of implicit contacts are constant over an interval and are evaluated at its end.
                if watch.contact.holds or (i + 1) % len(part.sites) == 0:
                    own_forces = None if solved is None else solved[name]
                    watch.see(instant, float(t), gaps[name], forces[name], own_forces, unique)
    return tuple(watch.result(phase.name) for watch in watched)


class _Watched:
    """A contact and its values at sampled times."""

    def __init__(self, contact: BoundContact, stance: Stance, index: int) -> None:
        self.contact = contact
        self._weight = weight_of(stance.robot)
        self._anchors = stance.anchors[index]
        self._rows = [Row(r.name, r.unit, r.lower, r.upper, r.joint) for r in contact.limit_rows]
        self._times: list[float] = []
        self._gaps: list[tuple[float, float, float]] = []
        self._planned: list[Array] = []
        self._solved: list[Array] = []
        self._differences: list[float] = []
        size = reach(stance.robot.model) or 1.0
        self._arms = np.array([size if force.unit == "N m" else 1.0 for force in contact.forces])
        self._largest = 0.0
        self._shared = False

    def see(self, instant: Instant, t: float, gap: Array, forces: Array, solved: Array | None, unique: bool) -> None:
        self._times.append(t)
        self._gaps.append(split(self.contact, self._anchors, instant, gap))
        what = f"limits of contact {self.contact.name!r}"
        self._planned.append(as_numbers(self.contact.limits(instant, list(forces), self._anchors), what))
        if solved is not None and len(solved) == len(forces):
            self._solved.append(as_numbers(self.contact.limits(instant, list(solved), self._anchors), what))
            self._differences.append(float(np.max(np.abs(forces - solved) / self._arms, initial=0.0)))
            self._largest = max(self._largest, float(np.max(np.abs(solved) / self._arms, initial=0.0)))
            self._shared = self._shared or not unique

    def result(self, phase: str) -> Holding:
        times = np.array(self._times)
        slip, sink, turn = (
            _peak(name, unit, times, np.array(values), phase)
            for (name, unit), values in zip(
                (("slip", "m"), ("sink", "m"), ("turn", "rad")), zip(*self._gaps, strict=True), strict=True
            )
        )
        known = len(self._differences) == len(times) and self.contact.holds
        force = _peak("force", "N", times, np.array(self._differences), phase) if known else None
        return Holding(
            self.contact.name,
            phase,
            slip,
            sink,
            turn,
            self._broken(times, self._planned, phase, ""),
            self._broken(times, self._solved, phase, ", solved for") if len(self._solved) == len(times) else (),
            force,
            self._weight,
            self._largest,
            self._shared,
        )

    def _broken(self, times: Array, values: list[Array], phase: str, suffix: str) -> tuple[Violation, ...]:
        found = []
        for i, row in enumerate(self._rows):
            watch = Watch(Row(row.name + suffix, row.unit, row.lower, row.upper, row.joint))
            watch.see(times, np.array([value[i] for value in values]))
            violation = watch.worst(phase)
            if violation is not None and part_of(violation, self._weight) > FORCE_NOISE:
                found.append(violation)
        return tuple(sorted(found, key=lambda v: -part_of(v, self._weight)))


def split(
    contact: BoundContact, anchors: Mapping[str, float], instant: Instant, gap: Array
) -> tuple[float, float, float]:
    """Return slip [m], sink [m] and turn [rad] of the gap of a contact's rows; without a ground all of it is slip."""
    axes = {f"{contact.name}.{axis}": i for i, axis in enumerate("xyz")}
    away, turned = np.zeros(3), []
    for row, value in zip(contact.holds, gap, strict=True):
        if row.unit == "m" and row.name in axes:
            away[axes[row.name]] = value
        else:
            turned.append(value)
    turn = float(np.linalg.norm(turned))
    ground = contact.contact.ground
    if ground is None:
        return float(np.linalg.norm(away)), 0.0, turn
    place = instant.frame(contact.frame).position
    where = [anchors.get(f"{contact.name}.{axis}", place[i]) for i, axis in enumerate("xyz")]
    normal = as_numbers(as_ground(ground).normal_at(where), "normal of the ground")
    along = float(away @ normal)
    return float(np.linalg.norm(away - along * normal)), along, turn


def _peak(name: str, unit: str, times: Array, values: Array, phase: str) -> Peak:
    sizes = np.nan_to_num(np.abs(values), nan=np.inf)
    i = int(np.argmax(sizes))
    return Peak(name, unit, float(sizes[i]), float(times[i]), phase)
