"""The attributes of a solution on which the witness depends; tests provide them without a planner."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj.dynamics.point import Point
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.feedback.gains import Gains
from robotraj.solution.proof import Proof
from robotraj.solution.sample import Sample

Settle = Callable[[Array], Array]
"""Projection of a state on its constraints: rows of contacts that hold, quaternions of length 1."""


class RobotLike(Protocol):
    """A robot: Pinocchio's model, the names of its joints, its motors and its dissipation."""

    @property
    def model(self) -> pin.Model:
        """Pinocchio's model: joints of one position and one velocity each, and a free-flyer at a floating root."""

    @property
    def nv(self) -> int:
        """Number of velocities."""

    @property
    def position_names(self) -> Sequence[str]:
        """Names of the entries of q."""

    @property
    def velocity_names(self) -> Sequence[str]:
        """Names of the entries of v."""

    @property
    def friction_speed(self) -> float:
        """Speed at which the friction reaches 76 % of its value [rad/s, m/s]."""

    @property
    def actuated(self) -> Sequence[str]:
        """Joints in the order of tau."""

    @property
    def actuation(self) -> Array:
        """Selection B (nv, nu) of the actuated joints."""

    @property
    def units(self) -> Sequence[str]:
        """``"rad"`` or ``"m"`` for every velocity: the unit of its displacement."""

    @property
    def position_units(self) -> Sequence[str]:
        """Units of q, empty for the entries of a quaternion."""

    @property
    def damping(self) -> Array:
        """Viscous damping (nv,) [N m s/rad, N s/m]."""

    @property
    def friction(self) -> Array:
        """Coulomb friction (nv,) [N m, N]."""

    @property
    def springs(self) -> Sequence[tuple[str, float, float]]:
        """Joints with a spring, stiffness [N m/rad, N/m] and position without torque [rad, m]."""

    @property
    def stiffness(self) -> Array:
        """Stiffness of the joints' springs (nv,) [N m/rad, N/m]."""

    def resistance(self, q: Array, v: Array) -> Array:
        """Return the torque of springs, damping and friction (nv,) [N m, N], subtracted from B tau."""

    def spring_energy(self, q: Array) -> float:
        """Return the energy of the springs [J]."""

    def dissipation(self, v: Array) -> Array:
        """Return the torque d(v) (nv,) of damping and friction [N m, N]."""

    def frame(self, name: str) -> int:
        """Return the index of a frame; an unknown name raises an error that lists the valid ones."""


class VariableLike(Protocol):
    """A named scalar with a unit."""

    @property
    def name(self) -> str:
        """Unique within its vector."""

    @property
    def unit(self) -> str:
        """SI unit, empty where it is not known."""


class SystemLike(Protocol):
    """A user's semi-explicit DAE: xdot = dynamics(point), 0 = residual(point)."""

    @property
    def states(self) -> Sequence[VariableLike]:
        """Entries of x."""

    @property
    def controls(self) -> Sequence[VariableLike]:
        """Entries of u."""

    @property
    def algebraic(self) -> Sequence[VariableLike]:
        """Entries of z."""

    @property
    def dynamics(self) -> Callable[[Point], object]:
        """Rates of the states."""

    @property
    def residual(self) -> Callable[[Point], object] | None:
        """Equations of the algebraic variables, None without these."""


class PhaseSolutionLike(Protocol):
    """The planned trajectory of a phase."""

    @property
    def phase(self) -> Phase:
        """The phase: its robot or System, limits, constraints and contacts."""

    @property
    def knots(self) -> Array:
        """Ends of the intervals (K + 1,) [s]."""

    @property
    def parameters(self) -> Mapping[str, float]:
        """Values of the phase's parameters."""

    def at(self, t: float | Array, interval: int | NDArray[np.int_] | None = None) -> Sample[Any]:
        """Evaluate the polynomials of an interval, or of one for each time: q, v, a, tau, forces or x, u, z."""


class SolutionLike(Protocol):
    """A planned motion."""

    @property
    def phases(self) -> Sequence[PhaseSolutionLike]:
        """Phases in the order of the motion."""

    @property
    def objective(self) -> float:
        """The stated objective, the sum over all phases."""

    @property
    def proof(self) -> Proof | None:
        """The planner's measures and goals; None for a plan on a given mesh."""

    @property
    def problem(self) -> Problem:
        """The problem that was solved; its links join the phases."""

    @property
    def gains(self) -> Gains:
        """Feedback along the plan; ``gains.phases[i].at(times)`` returns K (m, nu, 2 nv)."""

    @property
    def impulses(self) -> Sequence[Mapping[str, float]]:
        """For every link, the impulses of its impact by name; empty for links without an impact."""
