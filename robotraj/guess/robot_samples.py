"""Samples of a robot's motion, completed: positions on the chart, velocities, accelerations, forces and torques."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError, unknown_name
from robotraj._util.lazy_values import cached_property
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.guess.joint_motion import designed
from robotraj.guess.legs.stance import BalancedStance
from robotraj.guess.legs.support import support
from robotraj.guess.samples import named_samples
from robotraj.problem.initial_guess import Curve
from robotraj.problem.phase import Phase
from robotraj.robot.chart import Chart
from robotraj.robot.configuration import unit_quaternion
from robotraj.robot.robot import Robot
from robotraj.robot.root import QUATERNION

Checked = Array | Mapping[str, Array] | None
"""Samples that ``check_samples`` returned; None where they are not given."""


@dataclass(frozen=True, eq=False)
class RobotSamples:
    """Completion of samples for one phase of a robot.

    Attributes
    ----------
    phase : Phase
    fractions : ndarray (m,)
        Fractions of the phase, ascending from 0 to 1.
    duration : float
        Duration [s].
    parameters : mapping of str to float
    """

    phase: Phase
    fractions: Array
    duration: float
    parameters: Mapping[str, float]

    @cached_property
    def robot(self) -> Robot:
        """The robot, with the design at the guessed parameters."""
        return designed(self.phase, self.parameters)

    def completed(self, given: Mapping[str, Checked], line: Array) -> dict[str, Array]:
        """Return every variable of the robot (m,) by name, such as ``q.elbow``.

        Missing positions are taken from ``line`` (m, nx).

        Raises
        ------
        InputError
            A name is unknown, the number of columns is wrong, or a quaternion's length is not 1.
        """
        robot = self.robot
        q = self._positions(given["q"], line[:, : robot.nq])
        chart, y, rate = self._chart(q)
        v = self._replaced("v", chart.velocities(y, rate / self._pace), given["v"], robot.velocity_names)
        a = self._replaced("a", _rates(self.fractions, v) / self._pace, given["a"], robot.velocity_names)
        forces, torques = self._loads(q, v, a, given["forces"])
        tau = self._replaced("tau", torques, given["tau"], robot.actuated)
        joints = robot.velocity_names
        groups = {"q": (robot.position_names, q), "v": (joints, v), "a": (joints, a), "tau": (robot.actuated, tau)}
        named = {f"{kind}.{n}": values[:, i] for kind, (names, values) in groups.items() for i, n in enumerate(names)}
        return named | forces

    def with_positions(self, states: Curve, known: Mapping[str, Array]) -> Curve:
        """Return the curve of the states with positions on cubics in the chart, whose slopes are the velocities."""
        import scipy

        robot = self.robot
        q, v = (
            np.column_stack([known[f"{kind}.{name}"] for name in names])
            for kind, names in (("q", robot.position_names), ("v", robot.velocity_names))
        )
        chart, y, _ = self._chart(q)
        slopes = np.array([chart.slopes(*row) for row in zip(y, v, strict=True)]) * self._pace
        curve = scipy.interpolate.CubicHermiteSpline(self.fractions, y, slopes)

        def positioned(s: Array) -> Array:
            values = np.array(states(s))
            values[:, : robot.nq] = chart.positions(curve(s))
            return values

        return positioned

    @property
    def _pace(self) -> float:
        return self.duration if self.duration > 0 else 1.0

    def _chart(self, q: Array) -> tuple[Chart, Array, Array]:
        """Return the chart around the first sample, coordinates (m, nv) and their rates per fraction."""
        chart = Chart.around(self.robot.model, q[0])
        y = chart.coordinates(q)
        return chart, y, _rates(self.fractions, y)

    def _positions(self, given: Checked, line: Array) -> Array:
        """Return positions (m, nq), quaternions of length 1 and without changes of sign."""
        q = self._replaced("q", line, given, self.robot.position_names)
        if given is None or self.robot.root != "floating":
            return q
        for i, row in enumerate(q):
            row[QUATERNION] = unit_quaternion(row[QUATERNION], f"q of rt.Guess at index {i}")
        start = self.phase.start_bounds
        if np.array_equal(start.lower[QUATERNION], start.upper[QUATERNION]):
            q[0, QUATERNION] *= 1.0 if q[0, QUATERNION] @ start.lower[QUATERNION] >= 0 else -1.0
        for before, row in zip(q[:-1], q[1:], strict=True):
            row[QUATERNION] *= 1.0 if before[QUATERNION] @ row[QUATERNION] >= 0 else -1.0
        return q

    def _replaced(self, what: str, base: Array, given: Checked, names: tuple[str, ...]) -> Array:
        """Return a copy of ``base`` (m, n) with the columns that are given."""
        table = np.array(base)
        if given is not None:
            found = named_samples(given, names, len(self.fractions), f"{what} of rt.Guess", "joint")
            for name, column in found.items():
                table[:, names.index(name)] = column
        return table

    def _loads(self, q: Array, v: Array, a: Array, given: Checked) -> tuple[dict[str, Array], Array]:
        """Return contact forces by variable name, (m,) each, and torques (m, nu)."""
        contacts, robot = self.phase.bound_contacts, self.robot
        stance = BalancedStance(robot, contacts)
        names = [contact.name for contact in contacts]
        if contacts and not isinstance(given, Mapping):
            rows = [support(stance, names, *row) for row in zip(q, v, a, strict=True)]
            forces, torques = (np.array([row[k] for row in rows]) for k in (0, 1))
        else:
            forces = self._given_forces(contacts, given if isinstance(given, Mapping) else {})
            model, data = robot.model, robot.model.createData()
            needed = np.array(
                [pin.rnea(model, data, *row) + robot.resistance(*row[:2]) for row in zip(q, v, a, strict=True)]
            )
            if contacts:
                needed -= np.array([stance.jacobian(at).T @ force for at, force in zip(q, forces, strict=True)])
            torques = needed @ robot.actuation
        variables = [force.name for contact in contacts for force in contact.forces]
        return {name: forces[:, i] for i, name in enumerate(variables)}, torques

    def _given_forces(self, contacts: tuple[BoundContact, ...], given: Mapping[str, Array]) -> Array:
        """Return the components of the given forces that the contacts have, (m, n)."""
        names = [contact.name for contact in contacts]
        for name in given:
            if name not in names:
                raise unknown_name("contact", name, names, "Correct the name in forces of rt.Guess.")
        parts = [np.zeros((len(self.fractions), 0))]
        for contact in contacts:
            size = len(contact.forces)
            world = np.array([contact.vector(list(unit)) for unit in np.eye(size)], dtype=float)
            values = given.get(contact.name)
            if values is None:
                values = np.zeros((len(self.fractions), world.shape[1]))
            elif values.ndim != 2 or values.shape[1] != world.shape[1]:
                raise InputError(
                    f"forces of rt.Guess of contact {contact.name!r} has shape {values.shape}; it needs "
                    f"({len(self.fractions)}, {world.shape[1]}), in world axes."
                )
            parts.append(values @ np.linalg.pinv(world))
        return np.hstack(parts)


def _rates(fractions: Array, values: Array) -> Array:
    """Return the rates per fraction (m, n) of samples, by central differences of second order."""
    return np.asarray(np.gradient(values, fractions, axis=0, edge_order=2 if len(fractions) > 2 else 1))
