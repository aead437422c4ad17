"""The motion that MuJoCo follows: a plan repeated over several periods.

Every period is displaced from the last, and mirrored if the plan is half a gait; ``robotraj.solution.gait_cycles``
defines how.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.checks import whole
from robotraj._util.errors import InputError
from robotraj.dynamics.contacts.implicit import BoundImplicitContact
from robotraj.dynamics.design.binding import realised
from robotraj.solution.cycles.cycle_map import CycleMap, cycle_map_of
from robotraj.solution.cycles.gait_cycles import MOST
from robotraj.witness.mujoco.roots import QUATERNION, RootCoordinates
from robotraj.witness.planned import limits_of, robot_sample
from robotraj.witness.protocols import SolutionLike

AXES = ("x", "y", "z")

LEAST_PUSH = 0.2
"""Force [N] per kilogram of the robot above which a contact carries load: a fiftieth of its weight."""


class PeriodPhase(NamedTuple):
    """One phase of one period.

    Attributes
    ----------
    phase : int
    period : int
    begin : float
        Start since the start of the first period [s].
    """

    phase: int
    period: int
    begin: float


class Reference(NamedTuple):
    """The plan at some times, in the coordinates of the plan: q (m, nq), v (m, nv), tau (m, nu)."""

    q: Array
    v: Array
    tau: Array


class ReferenceMotion:
    """A plan over several periods.

    Parameters
    ----------
    solution : Solution
        A plan of a robot.
    periods : int or None
        Number of periods; None means three for a periodic plan, else one.

    Attributes
    ----------
    robot : Robot
        The robot, without symbolic design parameters.
    phases : tuple of PhaseSolution
    periods : int
    closing : CycleMap or None
        Map from a period to the next, None for a plan that is not periodic.

    Raises
    ------
    InputError
        The solution moves a System, or robots that differ between phases. Several periods are given for a plan that is
        not periodic.
    """

    def __init__(self, solution: SolutionLike, periods: int | None = None) -> None:
        self.phases = tuple(solution.phases)
        robots = [planned.phase.robot for planned in self.phases if planned.phase.robot is not None]
        if not robots or len(robots) < len(self.phases):
            raise InputError("The solution moves a System, and second_opinion() simulates robots: use rt.validate.")
        self.robot = realised(self.phases[0])
        names = list(self.robot.model.names)
        if any(list(robot.model.names) != names for robot in robots):
            raise InputError("The phases move different robots, and second_opinion() follows one: use rt.validate.")
        self.closing = cycle_map_of(solution)
        self._impulses = _impulses(solution)
        self.periods = _count(periods, self.closing)
        self.root = RootCoordinates(self.robot.model)

    @property
    def nu(self) -> int:
        """Number of motors."""
        return len(self.robot.actuated)

    def efforts(self, phase: int) -> Array:
        """Lower and upper limits of the motors in a phase (2, nu) [N m, N], infinite where there are none."""
        limits = limits_of(self.phases[phase])
        if limits is None:
            return np.array([np.full(self.nu, -np.inf), np.full(self.nu, np.inf)])
        chosen = [list(self.robot.velocity_names).index(joint) for joint in self.robot.actuated]
        return np.array(limits.sides("effort"))[:, chosen]

    @property
    def starts(self) -> tuple[float, ...]:
        """Start of each phase [s]."""
        return tuple(float(planned.knots[0]) for planned in self.phases)

    @property
    def durations(self) -> tuple[float, ...]:
        """Duration of each phase [s]."""
        return tuple(float(planned.knots[-1] - planned.knots[0]) for planned in self.phases)

    def pushing(self, phase: int, times: Array) -> list[set[str]]:
        """Return the contacts that carry load at times (m,) since the start of a phase, as planned."""
        forces = self.phases[phase].at(self.starts[phase] + times).forces
        carried = {name: np.linalg.norm(np.asarray(forces[name])[:, :3], axis=1) for name in forces}
        least = LEAST_PUSH * sum(inertia.mass for inertia in self.robot.model.inertias)
        return [{name for name, force in carried.items() if force[i] > least} for i in range(len(times))]

    def stands(self, phase: int) -> tuple[str, ...]:
        """Return the contacts with the ground that hold throughout a phase."""
        held = getattr(self.phases[phase].phase, "bound_contacts", ())
        return tuple(b.name for b in held if b.contact.ground is not None and not isinstance(b, BoundImplicitContact))

    def lands(self, phase: int) -> tuple[str, ...]:
        """Return the contacts that touch down at the start of a phase, none at the start of a plan without period."""
        if phase > 0:
            before = self.stands(phase - 1)
        elif self.closing is None:
            return ()
        else:
            before = tuple(self.closing.partners.get(name, name) for name in self.stands(len(self.phases) - 1))
        return tuple(name for name in self.stands(phase) if name not in before)

    def strikes(self, phase: int) -> Mapping[str, Array]:
        """Return planned impulses (3,) [N s] of the touchdowns at the start of a phase, world axes."""
        return self._impulses.get(phase, {})

    @property
    def passages(self) -> Iterator[PeriodPhase]:
        """All phases of all periods in their order."""
        begin = 0.0
        for period in range(self.periods):
            for phase, duration in enumerate(self.durations):
                yield PeriodPhase(phase, period, begin)
                begin += duration

    def grid(self, phase: int, step: float) -> Array:
        """Return times since the start of a phase (m,) [s], at most a step apart, with all knots."""
        knots = np.asarray(self.phases[phase].knots, dtype=float) - self.starts[phase]
        knots = knots[np.concatenate([[True], np.diff(knots) > 0])]
        parts = [
            np.linspace(begin, end, max(1, int(np.ceil((end - begin) / step - 1e-9))), endpoint=False)
            for begin, end in zip(knots[:-1], knots[1:], strict=True)
        ]
        return np.concatenate([*parts, knots[-1:]])

    def reference(self, phase: int, times: Array) -> Reference:
        """Sample a phase at times (m,) since its start [s]."""
        planned, start, duration = self.phases[phase], self.starts[phase], self.durations[phase]
        sample = robot_sample(planned, start + np.clip(times, 0.0, duration))
        return Reference(self._unit(sample.q), sample.v, sample.tau)

    def onwards(self, q: Array, v: Array, periods: int) -> tuple[Array, Array]:
        """Return positions (..., nq) and velocities (..., nv) of the plan ``periods`` later."""
        for _ in range(periods):
            q, v = self._return.onwards(q), v @ self._return.velocities
        return self._unit(q), v

    def torques_onwards(self, tau: Array, periods: int) -> Array:
        """Return torques (..., nu) of the plan ``periods`` later."""
        return tau @ self._torques(periods)

    def gains_onwards(self, gains: Array, periods: int) -> Array:
        """Return gains (..., nu, 2 nv) of the plan ``periods`` later."""
        if periods == 0:
            return gains
        moved = np.linalg.matrix_power(self._return.velocities, periods)
        return np.asarray(self._torques(periods).T @ gains @ np.kron(np.eye(2), moved))

    def foot_onwards(self, name: str, periods: int) -> tuple[str, Array]:
        """Return the contact in the place of another one ``periods`` later, and the signs (3,) of its force."""
        if not self.mirrored(periods):
            return name, np.ones(3)
        return self._return.partners.get(name, name), np.array([1.0, -1.0, 1.0])

    def _torques(self, periods: int) -> Array:
        """Return the matrix (nu, nu) from torques (rows) of the plan to those ``periods`` later."""
        actuation = np.asarray(self.robot.actuation, dtype=float)
        once = np.eye(actuation.shape[1]) if periods == 0 else actuation.T @ self._return.velocities @ actuation
        return np.linalg.matrix_power(once, periods)

    def mirrored(self, periods: int) -> bool:
        """Return whether left and right are swapped after so many periods."""
        return (
            bool(periods % 2)
            and self.closing is not None
            and not np.array_equal(self.closing.velocities, np.eye(self.robot.model.nv))
        )

    @property
    def _return(self) -> CycleMap:
        assert self.closing is not None, "a plan that is not periodic is followed once"
        return self.closing

    def _unit(self, q: Array) -> Array:
        q = np.array(q, dtype=float)
        if self.root.floating:
            q[..., QUATERNION] /= np.linalg.norm(q[..., QUATERNION], axis=-1, keepdims=True)
        return q


def _impulses(solution: SolutionLike) -> dict[int, dict[str, Array]]:
    """Return the impulses of all touchdowns by the phase that starts with them."""
    read: dict[int, dict[str, Array]] = {}
    links, found = getattr(solution.problem, "links", ()), getattr(solution, "impulses", ())
    for link, impulses in zip(links, found, strict=False):
        for name, value in impulses.items():
            contact, axis = name.removeprefix("impulse.").rsplit(".", 1)
            if axis in AXES:
                by_contact = read.setdefault(link.second % len(solution.phases), {})
                by_contact.setdefault(contact, np.zeros(3))[AXES.index(axis)] = value
    return read


def _count(periods: int | None, closing: CycleMap | None) -> int:
    if periods is None:
        return 1 if closing is None else 3
    whole("periods", periods, 1, MOST)
    if periods > 1 and closing is None:
        raise InputError(
            f"periods = {periods}, but the plan does not end as it starts: no rt.Periodic, rt.Mirror or "
            "rt.Touchdown(repeat=...) closes it. Give periods=1."
        )
    return periods
