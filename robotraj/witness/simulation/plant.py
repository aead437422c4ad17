"""What moves in a phase, alike for robots and Systems: named states, planned states, rates under the plan."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Protocol

import numpy as np
import pinocchio as pin
import scipy
from numpy.typing import NDArray

from robotraj._util.values import dataclass
from robotraj.dynamics.design.binding import realised
from robotraj.robot.tangent import PLACE, difference, floats, normalised, rate_matrix
from robotraj.witness.contacts.stance import Stance, forces_in
from robotraj.witness.numbers import as_numbers
from robotraj.witness.point import system_point
from robotraj.witness.protocols import Array, PhaseSolutionLike, SystemLike
from robotraj.witness.simulation.integration import Settle

Feedback = Callable[[Array], Array]
"""``feedback(times)`` gives gains (m, nu, 2 nv) at times (m,)."""

RATE_UNITS = {"rad": "rad/s", "m": "m/s"}

ALGEBRAIC_TOLERANCE = 1e-9
"""Largest entry of 0 = g that counts as solved, in units of 1 + the largest planned |z|."""


FLYING = ("root_x", "root_y", "root_z", "root_rx", "root_ry", "root_rz")
"""How far a floating root is from its plan: along the world's axes [m], and a rotation vector in its own [rad]."""

VELOCITY_SCALE = 10.0
"""Velocities may drift ten times as far as positions: planned motions change within a tenth of a second."""


@dataclass(frozen=True)
class Landing:
    """Where a simulation set a contact down.

    Attributes
    ----------
    contact, phase : str
    time : float
        Start of the phase [s].
    distance : float
        From the planned place [m].
    moved : float
        How far the simulation let it go from there while it held [m, rad].
    """

    contact: str
    phase: str
    time: float
    distance: float
    moved: float = 0.0


class Plant(Protocol):
    """The states of a phase and how they move under the planned controls.

    Attributes
    ----------
    names : tuple of str
        Of the states x, (n,).
    gap_names, gap_units : tuple of str
        Of the difference of two states, (k,): a floating root is turned by three angles, not by four.
    """

    names: tuple[str, ...]
    gap_names: tuple[str, ...]
    gap_units: tuple[str, ...]

    def states(self, times: Array, interval: int | NDArray[np.int_] | None = None) -> Array:
        """Planned states (m, n) at times (m,)."""
        ...

    def gaps(self, states: Array, planned: Array) -> Array:
        """Differences (m, k) of states and planned states, (m, n) each."""
        ...

    def scales(self, peaks: Array) -> Array:
        """Give the factors of a drift tolerance (k,), from the largest planned magnitudes (n,)."""
        ...

    def sizes(self, states: Array) -> Array:
        """Give what differences from states (m, n) are measured against (m, k): 1 + |x|."""
        ...

    def given(self, times: Array) -> Array:
        """Give what the plan prescribes at times (m,), one row each."""
        ...

    def rate(self, t: float, x: Array, given: Array) -> Array:
        """Rate (n,) of a state under what the plan prescribes."""
        ...

    @property
    def settle(self) -> Settle | None:
        """Puts a state at a knot back on what is held; None where nothing is."""
        ...

    def begin(self, x: Array) -> tuple[Array, tuple[Landing, ...]]:
        """Begin the phase from x: contacts take hold where they are. The state after, and where they stand."""
        ...

    def watched(self, landings: tuple[Landing, ...], states: Array) -> tuple[Landing, ...]:
        """Add to landings how far their contacts moved in simulated states (m, n)."""
        ...


def plant_of(planned: PhaseSolutionLike) -> Plant:
    """Choose what moves in a phase: its robot, or its System."""
    return RobotPlant(planned) if planned.phase.robot is not None else SystemPlant(planned)


class RobotPlant:
    """A robot under its planned torques: x = (q, v).

    Parameters
    ----------
    planned : PhaseSolution
    feedback : callable, optional
        ``feedback(times)`` gives gains (m, nu, 2 nv): the torque is tau_plan - K (x - x_plan).
    robot : Robot, optional
        What moves in the place of the planned robot.
    """

    def __init__(self, planned: PhaseSolutionLike, feedback: Feedback | None = None, robot: Any = None) -> None:
        robot = realised(planned) if robot is None else robot
        self._robot, self._feedback = robot, feedback
        self._data = robot.model.createData()
        self._floats = floats(robot.model)
        self._actuation = np.asarray(robot.actuation, dtype=float)
        speeds = tuple(f"v.{name}" for name in robot.velocity_names)
        self.names = (*(f"q.{name}" for name in robot.position_names), *speeds)
        self._model = robot.model
        moved = robot.velocity_names
        if floats(self._model):
            moved = (*FLYING, *moved[len(FLYING) :])
        self.gap_names = (*(f"q.{name}" for name in moved), *speeds)
        self.gap_units = (*robot.units, *(RATE_UNITS[unit] for unit in robot.units))
        self._planned = planned
        contacts = planned.phase.bound_contacts
        self._stance = Stance(robot, contacts, planned.parameters) if contacts else None
        self._loose = [contact for contact in contacts if not contact.holds]

    def states(self, times: Array, interval: int | NDArray[np.int_] | None = None) -> Array:
        """Planned (q, v), (m, nq + nv)."""
        sample = self._planned.at(times, interval=interval)
        return np.hstack([sample.q, sample.v])

    def gaps(self, states: Array, planned: Array) -> Array:
        """Shift of a floating root in the world and its turn in its own axes, then all else, (m, 2 nv)."""
        if not floats(self._model):
            return states - planned
        nq = self._model.nq
        there, here = states[:, :nq], planned[:, :nq]
        moved = np.full((len(states), self._model.nv), np.nan)
        known = np.isfinite(states).all(axis=1) & np.isfinite(planned).all(axis=1)
        moved[known] = difference(self._model, here[known], there[known])
        moved[:, PLACE] = there[:, PLACE] - here[:, PLACE]
        return np.hstack([moved, states[:, nq:] - planned[:, nq:]])

    def scales(self, peaks: Array) -> Array:
        """Give 1 for positions, ``VELOCITY_SCALE`` max(1, peak) for velocities."""
        nq, nv = self._model.nq, self._model.nv
        return np.concatenate([np.ones(nv), VELOCITY_SCALE * np.maximum(1.0, peaks[nq:])])

    def sizes(self, states: Array) -> Array:
        """Give 1 for place and turn of a floating root, 1 + |x| for all else."""
        nq = self._model.nq
        moved = np.abs(states[:, :nq])
        if self._floats:
            root = len(FLYING)
            moved = np.hstack([np.zeros((len(states), root)), moved[:, root + 1 :]])
        return 1.0 + np.hstack([moved, np.abs(states[:, nq:])])

    def given(self, times: Array) -> Array:
        """Give torques on the joints, forces of contacts that come and go, and what the feedback needs of the plan."""
        sample = self._planned.at(times)
        rows = [sample.tau @ self._actuation.T]
        rows += [forces_in(sample, [contact])[contact.name].T for contact in self._loose]
        if self._feedback is not None:
            gains = self._actuation @ self._feedback(times)
            rows += [sample.q, sample.v, gains.reshape(len(times), -1)]
        return np.hstack(rows)

    def rate(self, t: float, x: Array, given: Array) -> Array:
        """Give q' and the acceleration, by ABA, or by constrained dynamics where contacts hold.

        The forces of contacts that hold no rows, but come and go, are the planned ones.
        """
        model, stance, nq, nv = self._model, self._stance, self._model.nq, self._model.nv
        q, v = x[:nq], x[nq:]
        moved = rate_matrix(model, q) @ v if self._floats else v
        q = normalised(model, q)
        applied = given[:nv] - self._robot.dissipation(v)
        start = nv
        if stance is not None and self._loose:
            forces = {}
            for contact in self._loose:
                forces[contact.name] = given[start : start + len(contact.forces)]
                start += len(contact.forces)
            applied = applied + stance.torques(q, forces)
        if self._feedback is not None:
            q_plan, v_plan = given[start : start + nq], given[start + nq : start + nq + nv]
            gains = given[start + nq + nv :].reshape(nv, 2 * nv)
            away = pin.difference(model, q_plan, q) if self._floats else q - q_plan
            applied = applied - gains @ np.concatenate([away, v - v_plan])
        if stance is None:
            return np.concatenate([moved, pin.aba(model, self._data, q, v, applied)])
        return np.concatenate([moved, stance.acceleration(q, v, applied)])

    @property
    def settle(self) -> Settle | None:
        """Projection on the held rows, and of quaternions on length 1."""
        stance, model = self._stance, self._model
        if not floats(model):
            return None if stance is None else stance.settle

        def settle(x: Array) -> Array:
            x = normalised(model, x)
            return x if stance is None else stance.settle(x)

        return settle

    def begin(self, x: Array) -> tuple[Array, tuple[Landing, ...]]:
        """Hold the contacts where they are and bring them to rest by an impact, none where they rest already."""
        stance = self._stance
        x = normalised(self._model, x)
        if stance is None:
            return x, ()
        nq = stance.robot.model.nq
        away = stance.by_contact(stance.stand(x[:nq]))
        after, _ = stance.strike(x[:nq], x[nq:])
        phase, time = self._planned.phase.name, float(self._planned.knots[0])
        landings = tuple(
            Landing(c.name, phase, time, float(np.linalg.norm(away[c.name][[row.unit == "m" for row in c.holds]])))
            for c in stance.contacts
            if c.holds
        )
        return np.concatenate([x[:nq], after]), landings

    def watched(self, landings: tuple[Landing, ...], states: Array) -> tuple[Landing, ...]:
        """Evaluate the held rows on the simulated states."""
        stance = self._stance
        if stance is None:
            return landings
        nq = stance.robot.model.nq
        # What drifts does so over whole intervals: a few looks into each do.
        gaps = stance.by_contact(np.array([stance.rows(x[:nq], x[nq:]).gap for x in states[::5]]))
        return tuple(
            replace(landing, moved=float(np.nan_to_num(np.abs(gaps[landing.contact]), nan=np.inf).max(initial=0.0)))
            for landing in landings
        )


class SystemPlant:
    """A System under its planned controls; algebraic variables are solved for wherever rates are needed."""

    def __init__(self, planned: PhaseSolutionLike) -> None:
        self._system: SystemLike = planned.phase.system
        self.names = tuple(s.name for s in self._system.states)
        self.gap_names = self.names
        self.gap_units = tuple(s.unit for s in self._system.states)
        self._planned = planned

    def states(self, times: Array, interval: int | NDArray[np.int_] | None = None) -> Array:
        """Planned states (m, n)."""
        return columns(self._planned.at(times, interval=interval).x, self.names, len(times))

    def gaps(self, states: Array, planned: Array) -> Array:
        """Differences (m, n), state by state."""
        return states - planned

    def scales(self, peaks: Array) -> Array:
        """Give max(1, peak): the unit of a user's state is not known."""
        return np.maximum(1.0, peaks)

    def sizes(self, states: Array) -> Array:
        """Give 1 + |x|."""
        return 1.0 + np.abs(states)

    settle: Settle | None = None

    def begin(self, x: Array) -> tuple[Array, tuple[Landing, ...]]:
        """Begin from x as it is."""
        return x, ()

    def watched(self, landings: tuple[Landing, ...], states: Array) -> tuple[Landing, ...]:
        """Nothing is held."""
        return landings

    def given(self, times: Array) -> Array:
        """Give controls, and algebraic variables to start solving from."""
        sample = self._planned.at(times)
        controls = columns(sample.u, tuple(c.name for c in self._system.controls), len(times))
        algebraic = columns(sample.z, tuple(z.name for z in self._system.algebraic), len(times))
        return np.hstack([controls, algebraic])

    def rate(self, t: float, x: Array, given: Array) -> Array:
        """Rates by the user's own equations, evaluated on numbers."""
        system, count = self._system, len(self._system.controls)
        u, z = given[:count], given[count:]
        if len(z):
            z = _solve_algebraic(system, t, x, z, u, self._planned.parameters)
        point = system_point(system, t, x, z, u, self._planned.parameters)
        return as_numbers(system.dynamics(point), "dynamics")


def columns(named: Any, names: tuple[str, ...], count: int) -> Array:
    """Stack the entries of a sample into (count, len(names))."""
    if not names:
        return np.empty((count, 0))
    return np.column_stack([np.asarray(named[name], dtype=float) for name in names])


def _solve_algebraic(system: SystemLike, t: float, x: Array, z: Array, u: Array, parameters: Any) -> Array:
    """Solve 0 = g(x, z, u, p, t) for z from the planned z; NaN where there is no root near it."""
    residual = system.residual
    assert residual is not None

    def rows(trial: Array) -> Array:
        return as_numbers(residual(system_point(system, t, x, trial, u, parameters)), "residual")

    # MINPACK stops "without progress" once at round-off, so the rows themselves judge.
    found = scipy.optimize.root(rows, z, method="hybr", tol=1e-14)
    solved = np.max(np.abs(found.fun)) <= ALGEBRAIC_TOLERANCE * (1.0 + np.max(np.abs(z)))
    return found.x if solved else np.full_like(z, np.nan)
