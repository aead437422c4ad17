"""What the witness reads of a solution: it knows plans by these attributes alone, never by their classes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

Settle = Callable[[Array], Array]
"""Projection of a state on its constraints: rows of contacts that hold, quaternions of length 1."""


class RobotLike(Protocol):
    """A robot: Pinocchio's model, the names of its joints and what drives and brakes them."""

    @property
    def model(self) -> Any:
        """Pinocchio's model: one position and one velocity per joint, but for a free-flyer at the root."""

    @property
    def nv(self) -> int:
        """Number of velocities."""

    @property
    def position_names(self) -> Sequence[str]:
        """Entries of q."""

    @property
    def velocity_names(self) -> Sequence[str]:
        """Entries of v."""

    @property
    def friction_speed(self) -> float:
        """Speed at which the friction reaches 76 % of its value [rad/s, m/s]."""

    @property
    def actuated(self) -> Sequence[str]:
        """Joints in the order of tau."""

    @property
    def actuation(self) -> Any:
        """Selection B (nv, nu) of the actuated joints."""

    @property
    def units(self) -> Sequence[str]:
        """``"rad"`` or ``"m"`` by velocity: what it moves along, per second."""

    @property
    def position_units(self) -> Sequence[str]:
        """Units of q, empty for a quaternion's entries."""

    @property
    def damping(self) -> Any:
        """Viscous damping (nv,) [N m s/rad, N s/m]."""

    @property
    def friction(self) -> Any:
        """Coulomb friction (nv,) [N m, N]."""

    def dissipation(self, v: Any) -> Any:
        """Torque d(v) (nv,) of damping and friction [N m, N]."""

    def frame(self, name: str) -> int:
        """Index of a frame, or an error that names the valid ones."""


class VariableLike(Protocol):
    """A named scalar with a unit."""

    @property
    def name(self) -> str:
        """Unique within its vector."""

    @property
    def unit(self) -> str:
        """SI unit, empty when unknown."""


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
    def dynamics(self) -> Callable[[Any], Any]:
        """Rates of the states."""

    @property
    def residual(self) -> Callable[[Any], Any] | None:
        """Rows that hold z, None where there is no z."""


class PhaseSolutionLike(Protocol):
    """The planned trajectory of a phase."""

    @property
    def phase(self) -> Any:
        """The phase: name, robot or system, limits, bounds and rows, perhaps bound_design."""

    @property
    def knots(self) -> Any:
        """Ends of the intervals (K + 1,) [s]."""

    @property
    def parameters(self) -> Mapping[str, float]:
        """Values of the phase's parameters."""

    def at(self, t: Any, interval: int | NDArray[np.int_] | None = None) -> Any:
        """Evaluate the polynomials of an interval, or of one for each time: q, v, a, tau, forces or x, u, z."""


class SolutionLike(Protocol):
    """A planned motion."""

    @property
    def phases(self) -> Sequence[Any]:
        """Phases in the order they are moved through."""

    @property
    def problem(self) -> Any:
        """The problem that was solved; its ``bound_links`` say which states may jump between phases."""

    @property
    def gains(self) -> Any:
        """Feedback along the plan; ``gains.phases[i].at(times)`` gives K (m, nu, 2 nv)."""

    @property
    def impulses(self) -> Sequence[Mapping[str, float]]:
        """For every link, the impulses of its impact by name; empty where it has none."""
