"""Contacts with the ground in each phase of a motion: their places and their forces."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.dynamics.contacts.flat_foot import BoundFlatFoot
from robotraj.dynamics.design.binding import realised
from robotraj.dynamics.variable import Scalar
from robotraj.robot.robot import Robot
from robotraj.solution.cycles.gait_cycles import CyclePhase, CycleSample, GaitCycles
from robotraj.solution.sample import Sample

SAMPLES = 120
"""Approximate number of samples of a force per phase. Each of its intervals has at least 3, ends included."""
TOUCH = 0.01
"""An implicit contact counts as held while its force exceeds this share of its largest force."""


@dataclass(frozen=True, eq=False)
class Foothold(OneLine):
    """One contact that is held throughout one phase of a period.

    Attributes
    ----------
    name : str
        Name of the contact that is held in this period.
    cycle_phase : CyclePhase
    contact : BoundContact
        The contact in the planned phase.
    """

    name: str
    cycle_phase: CyclePhase
    contact: BoundContact

    @property
    def place(self) -> Array:
        """Place of the contact (3,) [m]."""
        return self.cycle_phase.points(numbers(self.contact.place(self.cycle_phase.parameters) or ()))

    @property
    def spans(self) -> list[tuple[float, float]]:
        """Times at which it is held, (start, end) each [s]."""
        return [(self.cycle_phase.t0, self.cycle_phase.t0 + self.cycle_phase.duration)]

    @property
    def stays(self) -> bool:
        """Whether it stands at one place."""
        return True

    @cached_property
    def normal(self) -> Array:
        """Upward normal of the ground there (3,)."""
        return self.cycle_phase.forces(self._planned_normal)

    @property
    def sole(self) -> Array:
        """Corners (4, 3) [m] of a flat foot's sole at touchdown; an empty array (0, 3) for other contacts."""
        contact = self.contact
        if not isinstance(contact, BoundFlatFoot):
            return np.empty((0, 3))
        planned = self.cycle_phase.planned
        place, rotation = contact.spot.placed(realised(planned), np.ravel(np.asarray(planned.at(planned.t0).q)))
        ahead, left = (rotation @ np.array(axis) for axis in (contact.feet.forward, contact.feet.left))
        if len(contact.about) == 1:
            # In a plane the sole is measured along left x up, with left out of the plane.
            left = np.eye(3)[contact.about[0]]
            ahead = np.cross(left, rotation @ np.array(contact.feet.up))
        shape = contact.shape
        corners = ((-shape.back, -shape.half), (shape.front, -shape.half), (shape.front, shape.half))
        return self.cycle_phase.points([place + x * ahead + y * left for x, y in (*corners, (-shape.back, shape.half))])

    @property
    def angle(self) -> float:
        """Half the opening of the friction cone, atan(mu) [rad]; 0 without a cone."""
        friction = self.contact.contact.friction
        return float(np.arctan(friction)) if np.isfinite(friction) else 0.0

    def normal_force(self, sample: Sample[Any] | CycleSample) -> Array:
        """Return the force along the normal (m,) [N] in a sample of the phase."""
        return np.asarray(np.atleast_2d(sample.forces[self.name])[:, :3] @ self.normal)

    @cached_property
    def track(self) -> tuple[Array, Array, Array]:
        """Times (m,) [s], points of application (m, 3) [m] and forces (m, 3) [N].

        The force of a flat foot acts at its centre of pressure.
        """
        planned = self.cycle_phase.planned
        knots = np.asarray(planned.knots, dtype=float)
        count = max(3, int(np.ceil(SAMPLES / max(len(knots) - 1, 1))) + 1)
        grids = [np.linspace(a, b, count) for a, b in zip(knots[:-1], knots[1:], strict=True)]
        samples = [planned.at(grid, interval=k) for k, grid in enumerate(grids)]
        wrench = np.concatenate([np.asarray(sample.forces[self.contact.name]) for sample in samples])
        q = np.concatenate([np.asarray(sample.q) for sample in samples])
        places = self._spots(realised(planned), q)
        if isinstance(self.contact, BoundFlatFoot):
            places = places + _pressure(wrench, self._planned_normal)
        times = np.concatenate(grids) + (self.cycle_phase.t0 - planned.t0)
        return times, self.cycle_phase.points(places), self.cycle_phase.forces(wrench[:, :3])

    @property
    def _planned_normal(self) -> Array:
        return numbers(self.contact.normal_at(self.cycle_phase.parameters))

    def _spots(self, robot: Robot, q: Array) -> Array:
        """Return the places (m, 3) [m] of the contact's point in configurations (m, nq)."""
        return np.array([self.contact.touched(robot, configuration) for configuration in q])


class FoundContact(Foothold):
    """A contact that may slide: it is held while its force is positive."""

    @property
    def place(self) -> Array:
        """Place of the first positive force (3,) [m]; the place at the start if there is none."""
        return np.asarray(self.track[1][np.argmax(self._pushes)])

    @property
    def spans(self) -> list[tuple[float, float]]:
        """Times at which the force is positive, (start, end) each [s]."""
        times, pushes = self.track[0], np.concatenate([[False], self._pushes, [False]])
        edges = np.flatnonzero(np.diff(pushes.astype(int)))
        return [
            (float(times[a]), float(times[b - 1])) for a, b in zip(edges[::2], edges[1::2], strict=True) if b - a > 1
        ]

    @property
    def stays(self) -> bool:
        """Whether it stands at one place."""
        return False

    @cached_property
    def _pushes(self) -> NDArray[np.bool_]:
        force = self.track[2] @ self.normal
        return np.asarray(force > max(TOUCH * float(force.max()), 1e-9))


def footholds(cycle_phase: CyclePhase) -> list[Foothold]:
    """Return the contacts with the ground in a phase of a period.

    Contacts without a ground, such as loop closures, have no normal or friction cone.
    """
    found = []
    for contact in cycle_phase.phase.bound_contacts:
        if contact.contact.ground is not None:
            kind = FoundContact if contact.place(cycle_phase.parameters) is None else Foothold
            found.append(kind(cycle_phase.contact(contact), cycle_phase, contact))
    return found


def contact_names(cycles: GaitCycles) -> list[str]:
    """Return the names of the contacts with the ground in all phases, mirrored periods included."""
    return list(dict.fromkeys(hold.name for cycle_phase in cycles.phases for hold in footholds(cycle_phase)))


def contact_frames(cycles: GaitCycles) -> dict[str, str]:
    """Return the frame of each contact; in a mirrored period it is the frame of the partner, if that is named."""
    frames: dict[str, str] = {}
    for cycle_phase in cycles.phases:
        for hold in footholds(cycle_phase):
            frame = hold.contact.frame
            if cycle_phase.cycle_map is not None and cycle_phase.mirrored:
                frame = cycle_phase.cycle_map.partner(frame, hold.contact.name)
            if frame in cycle_phase.robot.frame_names:
                frames.setdefault(hold.name, frame)
    return frames


def numbers(entries: Iterable[Scalar]) -> Array:
    """Convert floats and CasADi constants to an array."""
    return np.array([float(entry) for entry in entries])


def _pressure(wrench: Array, normal: Array) -> Array:
    """Return the vector (m, 3) [m] from the sole's point to the centre of pressure, n x m / f_n.

    It is zero where the normal force vanishes.
    """
    force = wrench[:, :3] @ normal
    pressed = force > 1e-3 * max(float(np.abs(force).max()), 1e-9)
    return np.cross(normal, wrench[:, 3:]) * np.where(pressed, 1.0 / np.where(pressed, force, 1.0), 0.0)[:, None]
