"""The schedule of contacts: the stances of every foot over time, in a problem and in its neighbouring periods."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from robotraj._util.precision import SAME
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import BoundContact, copied
from robotraj.guess.ends import guessed_duration
from robotraj.problem.constraints.bounds import as_bounds
from robotraj.problem.links.base import Link
from robotraj.problem.links.periodic import Mirror, Periodic
from robotraj.problem.problem import Problem

PERIODS = 2
"""Number of periods before and after the problem in which its stances may begin or end."""


@dataclass(frozen=True)
class StanceTime:
    """Start and end of a stance [s]; infinite if they lie outside a motion that does not repeat."""

    foot: str
    start: float
    end: float


@dataclass(frozen=True, eq=False)
class Schedule:
    """The contacts of all phases over time.

    Attributes
    ----------
    times : tuple of float
        Start of every phase and end of the last one [s].
    held : tuple of frozenset of str
        Names of the contacts of every phase.
    repeat : Mirror, Periodic or None
        Repetition of the motion.
    displacement : dict of str to float
        Displacement in a period, by state.
    contacts : tuple of BoundContact
        Contacts of all phases and their mirror images.
    """

    times: tuple[float, ...]
    held: tuple[frozenset[str], ...]
    repeat: Mirror | Periodic | None
    displacement: Mapping[str, float]
    contacts: tuple[BoundContact, ...]

    @property
    def sign(self) -> float:
        """Return the factor of world y from one period to the next."""
        return -1.0 if isinstance(self.repeat, Mirror) else 1.0

    def stands(self, foot: str) -> list[StanceTime]:
        """Return the stances of a foot in the order of time, with those of the neighbouring periods."""
        length = self.times[-1]
        found: list[StanceTime] = []
        for k in range(-PERIODS, PERIODS + 1) if self.repeat is not None else (0,):
            name = self.partner(foot) if k % 2 else foot
            for held, start, end in zip(self.held, self.times[:-1], self.times[1:], strict=True):
                if name not in held:
                    continue
                start, end = start + k * length, end + k * length
                if found and abs(found[-1].end - start) < SAME:
                    found[-1] = replace(found[-1], end=end)
                else:
                    found.append(StanceTime(foot, start, end))
        if self.repeat is not None:
            return found
        # Without repetition, a stance at an end of the motion has no limit there.
        return [
            StanceTime(foot, -np.inf if s.start == 0.0 else s.start, np.inf if s.end == length else s.end)
            for s in found
        ]

    def partner(self, foot: str) -> str:
        """Return the mirror image of a foot, or the foot itself if the motion is not mirrored."""
        return self.repeat.partner_of.get(foot, foot) if isinstance(self.repeat, Mirror) else foot


def schedule_of(problem: Problem, durations: Mapping[int, float] | None = None) -> Schedule:
    """Return the schedule of a problem whose phases follow one another."""
    lengths = [guessed_duration(phase, (durations or {}).get(i)) for i, phase in enumerate(problem.phases)]
    repeat = next((r for r in map(_repeat_of, problem.links) if r is not None), None)
    names = [state.name for state in problem.phases[0].body.states]
    displacement = {}
    if repeat is not None:
        bounds = as_bounds({name: 0.0 for name in names} | dict(repeat.displacement), names, "displacement", "state")
        for name, low, high in zip(names, bounds.lower, bounds.upper, strict=True):
            finite = [v for v in (low, high) if np.isfinite(v)]
            displacement[name] = float(np.mean(finite)) if finite else 0.0
    return Schedule(
        tuple(float(t) for t in np.cumsum([0.0, *lengths])),
        tuple(frozenset(contact.name for contact in phase.bound_contacts) for phase in problem.phases),
        repeat,
        displacement,
        _contacts(problem, repeat),
    )


def _repeat_of(link: Link) -> Mirror | Periodic | None:
    return link if isinstance(link, Mirror | Periodic) else getattr(link, "repeat", None)


def _contacts(problem: Problem, repeat: Mirror | Periodic | None) -> tuple[BoundContact, ...]:
    """Return the contacts of all phases and their mirror images."""
    every: dict[str, BoundContact] = {}
    for phase in problem.phases:
        for contact in phase.bound_contacts:
            every.setdefault(contact.name, contact)
    robot = problem.phases[0].robot
    assert robot is not None
    partners = repeat.partner_of if isinstance(repeat, Mirror) else {}
    for name, contact in list(every.items()):
        other = partners.get(name, name)
        frame = partners.get(contact.frame, other if other in robot.frame_names else contact.frame)
        if other not in every and frame != contact.frame and hasattr(contact.contact, "frame"):
            every[other] = copied(contact.contact, frame=frame, name=other).bound_to(robot)
    return tuple(every.values())
