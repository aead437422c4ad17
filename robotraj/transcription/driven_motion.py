"""Contact forces and torques along a planned motion, also between its collocation points.

Collocation gives polynomials q(t), v(t) and a(t). Between the points the torques of motors and the forces of contacts
are not prescribed. They are therefore those that the equations of motion require,

    f = f_p + J_r'^+ (r_r - J_r' f_p),    tau = B' (RNEA(q, v, a) + d(v) - J' f).

Here f_p are the planned forces, polynomials. The index r denotes the joints without motors, such as the root, whose
balance r_r the forces must satisfy. ^+ is the pseudoinverse, so that the forces change by the least amount. At
collocation points both are the planned ones. Forces cannot balance some loads, such as a moment about the line through
two point contacts. These are an error of the motion, as a - dv/dt is.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol
from weakref import WeakKeyDictionary

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.contact_terms import separate_contact_terms
from robotraj.dynamics.rigid_body import InverseRigidBody
from robotraj.dynamics.torque_symbols import separate_torques
from robotraj.problem.augmentation import FRICTIONLESS
from robotraj.problem.phase import Phase
from robotraj.robot.tangent import normalised
from robotraj.transcription.assembly.point_functions import PointFunctions
from robotraj.transcription.exact_motion import is_exact
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.schemes.collocation import Collocation, Scheme

RANK = 1e-9
"""Singular values of J_r' below this share of the largest count as zero."""
FEWEST_PLACES = 8
"""Least number of evaluated points. The number is a power of two, so that few evaluators are made."""


class Inputs(Protocol):
    """Algebraic variables z and controls u of a phase along its motion."""

    def at(self, t: Array, interval: int | Indices | None = None) -> tuple[Array, Array]:
        """Evaluate at times (m,), each on its own interval where these are given: (m, nz), (m, nu)."""
        ...

    def inside(self, tau: Array) -> tuple[Array, Array]:
        """Evaluate every interval at the same places tau in [0, 1], (m,): (K, m, nz), (K, m, nu)."""
        ...


@dataclass(frozen=True, eq=False)
class PlannedInputs(OneLine):
    """Inputs as the polynomials that were collocated."""

    trajectory: PhaseTrajectory

    def at(self, t: Array, interval: int | Indices | None = None) -> tuple[Array, Array]:
        """Evaluate the polynomials."""
        return self.trajectory.z(t, interval), self.trajectory.u(t, interval)

    def inside(self, tau: Array) -> tuple[Array, Array]:
        """Evaluate the polynomials."""
        return self.trajectory.z.inside(tau), self.trajectory.u.inside(tau)


@dataclass(frozen=True, eq=False)
class DrivenInputs(OneLine):
    """Inputs by the equations of motion; variables that an objective adds are polynomials."""

    phase: Phase
    trajectory: PhaseTrajectory

    def at(self, t: Array, interval: int | Indices | None = None) -> tuple[Array, Array]:
        """Evaluate at times."""
        times = np.atleast_1d(t)
        if not len(times):
            # The functions of the equations need a point.
            return PlannedInputs(self.trajectory).at(times)
        curves = (self.trajectory.x, self.trajectory.z, self.trajectory.u)
        z, u = self._solved(times, *(np.reshape(curve(t, interval), (len(times), -1)) for curve in curves))
        return z.reshape(*np.shape(t), -1), u.reshape(*np.shape(t), -1)

    def inside(self, tau: Array) -> tuple[Array, Array]:
        """Evaluate every interval at the same places."""
        breaks = self.trajectory.x.breaks
        times = breaks[:-1, None] + np.diff(breaks)[:, None] * tau
        curves = (self.trajectory.x, self.trajectory.z, self.trajectory.u)
        z, u = self._solved(times.ravel(), *(curve.inside(tau).reshape(times.size, -1) for curve in curves))
        return z.reshape(*times.shape, -1), u.reshape(*times.shape, -1)

    def _solved(self, t: Array, x: Array, z: Array, u: Array) -> tuple[Array, Array]:
        """Replace forces and torques of the planned z and u; one row a time."""
        body, equations = self.phase.body, MotionEquations.of(self.phase)
        assert isinstance(body, InverseRigidBody)
        robot, parameters = body.robot, np.array(list(self.trajectory.parameters.values()), dtype=float)
        nv, forces = robot.nv, len(body.algebraic)
        x, z, u = (np.array(values) for values in (x, z, u))
        x[:, : robot.nq] = normalised(robot.model, x[:, : robot.nq])
        driven = [robot.velocity_names.index(joint) for joint in robot.actuated]
        free = sorted(set(range(nv)) - set(driven))
        left = np.array(equations.rows(t, x, z, u, parameters))
        if body.contacts:
            arms = equations.slopes(t, x, z, u, parameters)[:, :nv, nv:forces]
            change = -np.linalg.pinv(arms[:, free], rcond=RANK) @ left[:, free, None]
            z[:, nv:forces] += change[:, :, 0]
            left[:, :nv] += (arms @ change)[:, :, 0]
        u[:, : len(driven)] += left[:, driven]
        for i, row, joint in self._frictionless:
            z[:, i] += left[:, row] + left[:, joint]
        return z, u

    @cached_property
    def _frictionless(self) -> list[tuple[int, int, int]]:
        return _frictionless(self.phase)


@dataclass(frozen=True, eq=False)
class DefinedInputs(OneLine):
    """Inputs as planned, but for torques without dry friction, which are those of torques that are states."""

    phase: Phase
    trajectory: PhaseTrajectory

    def at(self, t: Array, interval: int | Indices | None = None) -> tuple[Array, Array]:
        """Evaluate at times."""
        times = np.atleast_1d(t)
        curves = (self.trajectory.x, self.trajectory.z, self.trajectory.u)
        x, z, u = (np.reshape(curve(t, interval), (len(times), -1)) for curve in curves)
        return self._defined(times, x, z, u).reshape(*np.shape(t), -1), u.reshape(*np.shape(t), -1)

    def inside(self, tau: Array) -> tuple[Array, Array]:
        """Evaluate every interval at the same places."""
        breaks = self.trajectory.x.breaks
        times = breaks[:-1, None] + np.diff(breaks)[:, None] * tau
        curves = (self.trajectory.x, self.trajectory.z, self.trajectory.u)
        x, z, u = (curve.inside(tau).reshape(times.size, -1) for curve in curves)
        return self._defined(times.ravel(), x, z, u).reshape(*times.shape, -1), u.reshape(*times.shape, -1)

    def _defined(self, t: Array, x: Array, z: Array, u: Array) -> Array:
        parameters = np.array(list(self.trajectory.parameters.values()), dtype=float)
        left, z = MotionEquations.of(self.phase).rows(t, x, z, u, parameters), np.array(z)
        for i, row, _ in _frictionless(self.phase):
            z[:, i] += left[:, row]
        return z


def _frictionless(phase: Phase) -> list[tuple[int, int, int]]:
    """Return columns of z of torques without dry friction, and the rows of their definitions and joints' balances."""
    dae, joints = phase.dae, phase.robot.velocity_names if phase.robot else ()
    rows = [row.name for row in dae.residuals]
    return [
        (i, rows.index(v.name), joints.index(v.joint))
        for i, v in enumerate(dae.algebraic)
        if v.joint is not None and v.quantity == FRICTIONLESS
    ]


class MotionEquations:
    """The DAE of a phase at many points: rows g(x, z, u, p, t), slopes dg/dz, and rates f of the states."""

    def __init__(self, phase: Phase) -> None:
        dae = phase.dae
        sizes = (1, len(dae.states), len(dae.controls), len(phase.parameter_names), len(dae.algebraic))
        t, x, u, p, z = (ca.SX.sym(name, size) for name, size in zip("txupz", sizes, strict=True))
        point = dae.point(t, x, z, u, p, phase.parameter_names)
        torques = separate_torques(point) if isinstance(phase.body, InverseRigidBody) else None
        contacts = (
            () if torques is None else separate_contact_terms(phase.body, point, ca.SX.sym("c", len(dae.invariants)))
        )
        self._functions = PointFunctions(z, ca.vertcat(t, x, u, p), dae.residual(point), None, torques, contacts)
        self._shape = len(dae.residuals), sizes[-1]
        self._rates = ca.Function("rates", [t, x, z, u, p], [ca.densify(dae.rates(point))])

    @classmethod
    def of(cls, phase: Phase) -> MotionEquations:
        """Return the equations of a phase, which are built once."""
        if phase not in _EQUATIONS:
            _EQUATIONS[phase] = cls(phase)
        return _EQUATIONS[phase]

    def rows(self, t: Array, x: Array, z: Array, u: Array, p: Array) -> Array:
        """Evaluate g at points, one a row, (m, n_g)."""
        return self._evaluated("function", t, x, z, u, p)

    def slopes(self, t: Array, x: Array, z: Array, u: Array, p: Array) -> Array:
        """Evaluate dg/dz at points, one a row, (m, n_g, n_z)."""
        rows, columns = self._functions.jacobian_pattern
        slopes = np.zeros((len(t), *self._shape))
        slopes[:, rows, columns] = self._evaluated("jacobian", t, x, z, u, p)
        return slopes

    def rates(self, t: Array, x: Array, z: Array, u: Array, p: Array) -> Array:
        """Evaluate the rates f of the states at points, one a row, (m, n_x)."""
        parameters = np.tile(p[:, None], len(t))
        return np.array(self._rates.map(len(t))(t[None, :], x.T, z.T, u.T, parameters)).T

    def _evaluated(self, name: str, t: Array, x: Array, z: Array, u: Array, p: Array) -> Array:
        count = len(t)
        places = max(FEWEST_PLACES, 1 << (count - 1).bit_length())
        given = np.hstack([t[:, None], x, u, np.tile(p, (count, 1))])
        v, c = (np.vstack([part, np.tile(part[-1:], (places - count, 1))]) for part in (z, given))
        return self._functions.evaluate(name, v.T, c.T).T[:count]


_EQUATIONS: WeakKeyDictionary[Phase, MotionEquations] = WeakKeyDictionary()


def is_driven(phase: Phase, schemes: Sequence[Scheme]) -> bool:
    """Whether the inputs of a phase follow from its motion: ``DrivenInputs``.

    The motion is exact (``exact_motion``), or that of a robot with contacts or a free root by inverse dynamics. Neither
    torques nor forces are states, and no path constraint fixes them. Contacts are constraints, not force laws. The
    control sites are the nodes of the scheme.
    """
    body, dae = phase.body, phase.dae
    if phase.path is not None:
        return False
    if is_exact(phase, schemes):
        return True
    if not isinstance(body, InverseRigidBody) or not body.controls or not all(c.holds for c in body.contacts):
        return False
    if body.robot.root == "fixed" and not body.contacts:
        return False
    if dae.controls[: len(body.controls)] != body.controls or dae.algebraic[: len(body.algebraic)] != body.algebraic:
        return False
    if any(row.lower == row.upper for row in phase.rows.of_inputs):
        return False
    return all(
        isinstance(scheme, Collocation) and np.array_equal(scheme.control_sites, scheme.nodes)
        for scheme in dict.fromkeys(schemes)
    )


def inputs_of(phase: Phase, trajectory: PhaseTrajectory, schemes: Sequence[Scheme]) -> Inputs:
    """Return the inputs along a motion: by the equations of motion where possible, else the planned polynomials."""
    if is_driven(phase, schemes):
        return DrivenInputs(phase, trajectory)
    return DefinedInputs(phase, trajectory) if _frictionless(phase) else PlannedInputs(trajectory)
