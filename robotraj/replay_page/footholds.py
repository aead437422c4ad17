"""Contacts with the ground over the passages of a motion: where they stand, and the forces that act there."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.dynamics.contacts.flat_foot import BoundFlatFoot
from robotraj.dynamics.contacts.footing import Footing
from robotraj.dynamics.contacts.implicit import BoundImplicitContact
from robotraj.dynamics.contacts.loop_closure import BoundLoopClosure
from robotraj.dynamics.design.binding import realised
from robotraj.solution.cycles.gait_cycles import CyclePhase, GaitCycles

Array = NDArray[np.float64]
SAMPLES = 120
"""About so many samples of a force per phase, shared among its intervals; each shows at least 3, ends included."""
TOUCH = 0.01
"""A contact that the optimum finds counts as held while it pushes with this share of its greatest force."""


@dataclass(frozen=True, eq=False)
class Foothold(OneLine):
    """One contact over one cycle_phase, held throughout.

    Attributes
    ----------
    name : str
        Of the contact that holds in this period.
    cycle_phase : CyclePhase
    contact : BoundContact
        As planned.
    """

    name: str
    cycle_phase: CyclePhase
    contact: BoundContact

    @property
    def place(self) -> Array:
        """Where it stands (3,) [m]."""
        return self.cycle_phase.points(numbers(self._where.place(self.cycle_phase.parameters)))

    @property
    def spans(self) -> list[tuple[float, float]]:
        """When it is held [s]."""
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
        """Corners (4, 3) [m] of a flat foot's sole on the ground as it is put down; none (0, 3) of other contacts."""
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
        """Half the opening of the friction cone, atan(mu) [rad]."""
        return float(np.arctan(self.contact.contact.friction))  # type: ignore[attr-defined]

    def normal_force(self, sample: Any) -> Array:
        """Force along the normal (m,) [N] in a sample of the cycle_phase."""
        return np.asarray(np.atleast_2d(sample.forces[self.name])[:, :3] @ self.normal)

    @cached_property
    def track(self) -> tuple[Array, Array, Array]:
        """Times (m,) [s], where the force acts (m, 3) [m], and the force (m, 3) [N].

        That of a flat foot acts at its centre of pressure.
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
    def _where(self) -> Footing:
        return self.contact.where  # type: ignore[attr-defined]

    @property
    def _planned_normal(self) -> Array:
        return numbers(self._where.tangents(self.cycle_phase.parameters)[1])

    def _spots(self, robot: Any, q: Array) -> Array:
        """Place of the contact's point in configurations (m, nq) [m]."""
        model, data, spot = robot.model, robot.model.createData(), self.contact.spot  # type: ignore[attr-defined]
        frame, offset, places = robot.frame(spot.frame), np.array(spot.offset), np.empty((len(q), 3))
        for k, configuration in enumerate(q):
            pin.framesForwardKinematics(model, data, configuration)
            places[k] = data.oMf[frame].act(offset)
        return places


class FoundContact(Foothold):
    """A contact that comes and goes as the optimum has it: held while it pushes, wherever it is then."""

    @property
    def place(self) -> Array:
        """Where it first pushes (3,) [m]; where it starts, if it never does."""
        return np.asarray(self.track[1][np.argmax(self._pushes)])

    @property
    def spans(self) -> list[tuple[float, float]]:
        """When it pushes [s]."""
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

    @property
    def _planned_normal(self) -> Array:
        return np.array(self.contact.normal)  # type: ignore[attr-defined]


def footholds(cycle_phase: CyclePhase) -> list[Foothold]:
    """Contacts with the ground in a cycle_phase; they alone have a place, a normal and a friction cone."""
    found = []
    for contact in cycle_phase.phase.bound_contacts:
        if not isinstance(contact, BoundLoopClosure):
            kind = FoundContact if isinstance(contact, BoundImplicitContact) else Foothold
            found.append(kind(cycle_phase.contact(contact), cycle_phase, contact))
    return found


def contact_names(cycles: GaitCycles) -> list[str]:
    """Contacts with the ground of all phases, and those that take their places in mirrored periods."""
    return list(dict.fromkeys(hold.name for cycle_phase in cycles.phases for hold in footholds(cycle_phase)))


def contact_frames(cycles: GaitCycles) -> dict[str, str]:
    """Frame of each contact; those of mirrored periods are the partners' frames, where they have a name."""
    frames: dict[str, str] = {}
    for cycle_phase in cycles.phases:
        for hold in footholds(cycle_phase):
            frame = hold.contact.frame
            if cycle_phase.cycle_map is not None and cycle_phase.mirrored:
                frame = cycle_phase.cycle_map.partner(frame, hold.contact.name)
            if frame in cycle_phase.robot.frame_names:
                frames.setdefault(hold.name, frame)
    return frames


def numbers(entries: Any) -> Array:
    """Write entries of floats and CasADi's constants as an array."""
    return np.array([float(entry) for entry in entries])


def _pressure(wrench: Array, normal: Array) -> Array:
    """From the sole's point to the centre of pressure (m, 3) [m]: n x m / f_n, where the foot is pressed down."""
    force = wrench[:, :3] @ normal
    pressed = force > 1e-3 * max(float(np.abs(force).max()), 1e-9)
    return np.cross(normal, wrench[:, 3:]) * np.where(pressed, 1.0 / np.where(pressed, force, 1.0), 0.0)[:, None]
