"""Impacts of a plan: M (v+ - v-) = J' L, J v+ = 0 and L in the friction cones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import of_impulses
from robotraj.dynamics.design.binding import realised
from robotraj.dynamics.row import Row
from robotraj.problem.links.base import BoundLink
from robotraj.solution.violation import Violation
from robotraj.witness.checks.watch import Watch
from robotraj.witness.contacts.constrained import mass_and_bias
from robotraj.witness.contacts.slip_and_friction import FORCE_NOISE, part_of, weight_of
from robotraj.witness.contacts.stance import Instant, Stance
from robotraj.witness.numbers import as_numbers
from robotraj.witness.peak import Peak
from robotraj.witness.plants.of_phase import plant_of
from robotraj.witness.protocols import PhaseSolutionLike, SolutionLike

IMPULSE_UNITS = {"N": "N s", "N m": "N m s", "N^2": "N^2 s^2"}

LEAST_IMPULSE = 1e-4
"""Least scale of an impulse, in seconds of the robot's weight."""


@dataclass(frozen=True)
class Impact(OneLine):
    """One impact of a plan.

    Attributes
    ----------
    link : str
    time : float
        Time of the impact, at the end of the phase before it [s].
    impulses : mapping of str to float
        Planned impulses by name [N s, N m s].
    solved : mapping of str to float or None
        Impulses of the equations of impact at the planned q and v-; None where they are not unique.
    momentum : Peak
        Largest |M (v+ - v-) - J' L| of the plan [N s, N m s], by velocity.
    rest : Peak
        Largest |J v+| of the plan [m/s, rad/s], by held row.
    lost : float
        Kinetic energy lost in the impact [J].
    broken : tuple of Violation
        Limits of normal impulse and friction that the planned impulses violate.
    scale : float
        Norm of the planned impulses [N s], the scale of ``broken``.
    """

    link: str
    time: float
    impulses: Mapping[str, float]
    solved: Mapping[str, float] | None
    momentum: Peak
    rest: Peak
    lost: float
    broken: tuple[Violation, ...]
    scale: float


def impacts_of(solution: SolutionLike) -> tuple[Impact, ...]:
    """Check every link that has an impact."""
    links = enumerate(solution.problem.bound_links)
    return tuple(_check(solution, k, link) for k, link in links if any(row.name == "impact" for row in link.rows))


def _check(solution: SolutionLike, index: int, link: BoundLink) -> Impact:
    before, after = (solution.phases[i] for i in link.phases)
    robot, contacts = realised(after), after.phase.bound_contacts
    stance = Stance(robot, contacts, after.parameters)
    ending, starting = (np.asarray(planned.knots, dtype=float) for planned in (before, after))
    ended = plant_of(before).states(ending[-1:], len(ending) - 2)[0]
    started = plant_of(after).states(starting[:1], 0)[0]
    nq = robot.model.nq
    seen = _image(solution, index, before, ended)
    q, v_after, v_before = started[:nq], started[nq:], seen[nq:]

    planned = dict(solution.impulses[index])
    held = stance.rows(q, v_after)
    mass, _ = mass_and_bias(robot.model, robot.model.createData(), q, v_after)
    names = [f"impulse.{c.name}.{force.name.rsplit('.', 1)[-1]}" for c in contacts for force in c.forces]
    impulse = np.array([planned[name] for name in names])
    known = np.isfinite(held.jacobian).all()
    unique = known and np.linalg.matrix_rank(held.jacobian) == len(names)
    ends = np.cumsum([len(contact.forces) for contact in contacts])[:-1]
    parts = {c.name: part for c, part in zip(contacts, np.split(impulse, ends), strict=True)}
    own = stance.strike(q, v_before)[1]
    momentum = mass @ (v_after - v_before) - stance.torques(q, parts)
    scale = max(float(np.linalg.norm(impulse)), LEAST_IMPULSE * weight_of(robot))
    where = f"{before.phase.name} to {after.phase.name}"
    rows = [row for contact in contacts for row in contact.holds]
    return Impact(
        link.name,
        float(ending[-1]),
        dict(zip(names, impulse.tolist(), strict=True)),
        dict(zip(names, own.tolist(), strict=True)) if unique else None,
        _largest(plant_of(after).names[nq:], ["N s"] * len(momentum), momentum, ending[-1], where),
        _largest([r.name for r in rows], [f"{r.unit}/s" for r in rows], held.jacobian @ v_after, ending[-1], where),
        0.5 * float(v_before @ mass @ v_before - v_after @ mass @ v_after),
        _broken(stance, q, v_after, parts, float(ending[-1]), where, scale),
        scale,
    )


def _image(solution: SolutionLike, index: int, before: PhaseSolutionLike, ended: Array) -> Array:
    """Return the state before the impact, displaced or mirrored as the link repeats."""
    repeat = getattr(solution.problem.links[index], "repeat", None)
    if repeat is None:
        return ended
    names = list(plant_of(before).names)
    values = dict(zip(names, ended, strict=True))
    sources = repeat.of(before.phase, names, "impact").sources
    return np.array([sign * values[name] for name, sign in sources])


def _broken(
    stance: Stance, q: Array, v: Array, parts: Mapping[str, Array], time: float, where: str, scale: float
) -> tuple[Violation, ...]:
    """Return the limits of contacts that impulses violate, of those that apply to impulses."""
    instant = Instant(stance.robot, stance.robot.model.createData(), q, v)
    found = []
    for contact, anchors in zip(stance.contacts, stance.anchors, strict=True):
        values = as_numbers(contact.limits(instant, list(parts[contact.name]), anchors), f"limits of {contact.name!r}")
        for row, value in zip(map(of_impulses, contact.limit_rows), values, strict=True):
            if row is None:
                continue
            unit = IMPULSE_UNITS.get(row.unit, row.unit)
            watch = Watch(Row(f"impulse {row.name}", unit, row.lower, row.upper, row.joint))
            watch.see(np.array([time]), np.array([value]))
            violation = watch.worst(where)
            if violation is not None and part_of(violation, scale) > FORCE_NOISE:
                found.append(violation)
    return tuple(sorted(found, key=lambda v: -part_of(v, scale)))


def _largest(names: Sequence[str], units: Sequence[str], values: Array, time: float, phase: str) -> Peak:
    sizes = np.nan_to_num(np.abs(values), nan=np.inf)
    i = int(np.argmax(sizes))
    return Peak(names[i], units[i], float(sizes[i]), float(time), phase)
