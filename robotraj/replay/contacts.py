"""What holds the robot: contact forces, friction cones, impulses, and when each contact is held."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj.contacts import BoundContact
from robotraj.contacts.flat_foot import BoundFlatFoot
from robotraj.contacts.footing import Footing
from robotraj.contacts.loop_closure import BoundLoopClosure
from robotraj.design import realised
from robotraj.links.touchdown import impulse_names
from robotraj.unrolled import Passage, Unrolled

Array = NDArray[np.float64]
SAMPLES = 120
"""About so many samples of a force per phase, shared among its intervals; each shows at least 3, ends included."""
IMPULSE_TIME = 0.1
"""An impulse is drawn as long as the force that gives it in so many seconds."""


def standing(phase: Any) -> list[BoundContact]:
    """Contacts of a phase with the ground, which alone have a place, a normal and a friction cone."""
    return [contact for contact in phase.bound_contacts if not isinstance(contact, BoundLoopClosure)]


def contact_names(course: Unrolled) -> list[str]:
    """Contacts with the ground of all phases, and those that take their places in mirrored periods."""
    names = (passage.contact(contact) for passage in course.phases for contact in standing(passage.phase))
    return list(dict.fromkeys(names))


def contact_frames(course: Unrolled) -> dict[str, str]:
    """Frame of each contact; those of mirrored periods are the partners' frames, where they have a name."""
    frames: dict[str, str] = {}
    for passage in course.phases:
        for contact in standing(passage.phase):
            swap = passage.closing is not None and passage.mirrored
            frame = passage.closing.partner(contact.frame, contact.name) if swap else contact.frame  # type: ignore[union-attr]
            if frame in passage.phase.robot.frame_names:
                frames.setdefault(passage.contact(contact), frame)
    return frames


@dataclass(frozen=True, eq=False)
class Foothold:
    """One contact over one passage.

    Attributes
    ----------
    name : str
        Of the contact that holds in this period.
    passage : Passage
    contact : BoundContact
        As planned.
    """

    name: str
    passage: Passage
    contact: BoundContact

    @property
    def place(self) -> Array:
        """Where it stands (3,) [m]."""
        return self.passage.points(_numbers(self._where.place(self.passage.parameters)))

    @property
    def normal(self) -> Array:
        """Upward normal of the ground there (3,)."""
        return self.passage.forces(_numbers(self._where.tangents(self.passage.parameters)[1]))

    @property
    def angle(self) -> float:
        """Half the opening of the friction cone, atan(mu) [rad]."""
        return float(np.arctan(self.contact.contact.friction))  # type: ignore[attr-defined]

    @property
    def _where(self) -> Footing:
        return self.contact.where  # type: ignore[attr-defined]

    def normal_force(self, sample: Any) -> Array:
        """Force along the normal (m,) [N] in a sample of the passage."""
        return np.atleast_2d(np.asarray(sample.forces[self.name]))[:, :3] @ self.normal

    def track(self) -> tuple[Array, Array, Array]:
        """Give times (m,) [s], where the force acts (m, 3) [m], and the force (m, 3) [N].

        That of a flat foot acts at its centre of pressure.
        """
        planned = self.passage.planned
        knots = np.asarray(planned.knots, dtype=float)
        count = max(3, int(np.ceil(SAMPLES / max(len(knots) - 1, 1))) + 1)
        grids = [np.linspace(a, b, count) for a, b in zip(knots[:-1], knots[1:], strict=True)]
        samples = [planned.at(grid, interval=k) for k, grid in enumerate(grids)]
        wrench = np.concatenate([np.asarray(sample.forces[self.contact.name]) for sample in samples])
        q = np.concatenate([np.asarray(sample.q) for sample in samples])
        places = self._spots(realised(planned), q)
        if isinstance(self.contact, BoundFlatFoot):
            normal = _numbers(self._where.tangents(self.passage.parameters)[1])
            places = places + _pressure(wrench, normal)
        times = np.concatenate(grids) + (self.passage.t0 - planned.t0)
        return times, self.passage.points(places), self.passage.forces(wrench[:, :3])

    def _spots(self, robot: Any, q: Array) -> Array:
        """Place of the contact's point in configurations (m, nq) [m]."""
        model, data, spot = robot.model, robot.model.createData(), self.contact.spot  # type: ignore[attr-defined]
        frame, offset, places = robot.frame(spot.frame), np.array(spot.offset), np.empty((len(q), 3))
        for k, configuration in enumerate(q):
            pin.framesForwardKinematics(model, data, configuration)
            places[k] = data.oMf[frame].act(offset)
        return places


def footholds(passage: Passage) -> list[Foothold]:
    """Contacts with the ground that hold in a passage."""
    return [Foothold(passage.contact(contact), passage, contact) for contact in standing(passage.phase)]


def weight_of(robot: Any) -> float:
    """Weight of what moves [N]."""
    model = robot.model
    mass = sum(float(inertia.mass) for inertia in model.inertias[1:])
    return mass * float(np.linalg.norm(model.gravity.linear))


def contact_scene(course: Unrolled, robot: Any, stature: float) -> dict[str, Any] | None:
    """Write forces, cones and impulses for the page's script; None without contacts with the ground.

    Parameters
    ----------
    course : Unrolled
    robot : Robot
    stature : float
        Size of the robot [m]: its weight is drawn a third as long.
    """
    names = contact_names(course)
    if not names:
        return None
    holds = [hold for passage in course.phases for hold in footholds(passage)]
    tracks = [hold.track() for hold in holds]
    greatest = max((float(np.linalg.norm(force, axis=1).max()) for *_, force in tracks), default=0.0)
    unit = weight_of(robot) or greatest or 1.0
    return {
        "names": names,
        "unit": unit,
        "weight": weight_of(robot) > 0.0,
        "length": round(stature / 3.0, 4),
        "impulseTime": IMPULSE_TIME,
        "forces": [
            {"foot": names.index(hold.name), "t": _rounded(t, 8), "p": _rounded(p, 5), "f": _rounded(f, 5)}
            for hold, (t, p, f) in zip(holds, tracks, strict=True)
        ],
        "cones": [
            {
                "foot": names.index(hold.name),
                "start": hold.passage.t0,
                "end": hold.passage.t0 + hold.passage.duration,
                "apex": _rounded(hold.place, 6),
                "normal": _rounded(hold.normal, 6),
                "angle": hold.angle,
            }
            for hold in holds
        ],
        "impacts": impacts_of(course, names),
    }


def impacts_of(course: Unrolled, names: list[str]) -> list[dict[str, Any]]:
    """Impulses with their times, places [m] and world components [N s]."""
    found = []
    for impact in course.impacts:
        for hold in footholds(impact.after):
            entries = hold.contact.vector([float(impact.impulses[name]) for name in impulse_names(hold.contact)])
            if hold.name in names:
                found.append(
                    {
                        "foot": names.index(hold.name),
                        "t": impact.t,
                        "p": _rounded(hold.place, 6),
                        "impulse": _rounded(hold.passage.forces(_numbers(entries)[:3]), 5),
                    }
                )
    return found


def held(course: Unrolled) -> list[dict[str, Any]]:
    """When each contact is held: its name and spans [start, end] [s], joined where one follows another."""
    spans: dict[str, list[list[float]]] = {name: [] for name in contact_names(course)}
    for passage in course.phases:
        for hold in footholds(passage):
            row, end = spans[hold.name], passage.t0 + passage.duration
            if row and abs(row[-1][1] - passage.t0) < 1e-9 * max(1.0, course.duration):
                row[-1][1] = end
            else:
                row.append([passage.t0, end])
    return [{"label": name, "spans": row} for name, row in spans.items()]


def _pressure(wrench: Array, normal: Array) -> Array:
    """From the sole's point to the centre of pressure (m, 3) [m]: n x m / f_n, where the foot is pressed down."""
    force = wrench[:, :3] @ normal
    pressed = force > 1e-3 * max(float(np.abs(force).max()), 1e-9)
    return np.cross(normal, wrench[:, 3:]) * np.where(pressed, 1.0 / np.where(pressed, force, 1.0), 0.0)[:, None]


def _numbers(entries: Any) -> Array:
    return np.array([float(entry) for entry in entries])


def _rounded(values: Array, digits: int) -> list[float]:
    """Round to significant digits, rows one after the other."""
    return [float(f"{value:.{digits}g}") for value in np.ravel(values)]
