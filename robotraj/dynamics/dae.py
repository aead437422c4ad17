"""The protocol between dynamics and transcription: a phase is a semi-explicit DAE.

    xdot = f(x, z, u, p, t),    0 = g(x, z, u, p, t)

with x the state, z the algebraic variables, u the controls, p parameters and t time. An ordinary ODE has no z. Schemes,
meshes, objectives and solvers use only this protocol and do not depend on robots.

A DAE may have invariants: rows I(x, p, t) = 0 that its exact solution satisfies at all times if it does so at one.
Examples are unit quaternions, and the position and velocity of a contact whose acceleration is a row of g. A
discretised solution drifts from them. Collocation therefore projects the state onto them at every collocation point,

    x_j = x_0 + h sum_k A_jk f_k + W(x_j, p) c_j,    I(x_j) = 0,

with one correction c_j, of the size of the scheme's error, for every invariant; dI/dx W is nonsingular.
Source: Hairer and Wanner, Solving Ordinary Differential Equations II (1996), section VII.2 (projection); Posa,
Kuindersma and Tedrake, Optimization and stabilization of trajectories for constrained dynamical systems, ICRA 2016.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import casadi as ca

from robotraj.dynamics.point import AnyPoint, Point
from robotraj.dynamics.variable import Variable


class TimeOrders(NamedTuple):
    """Time order k of each variable: a variable w becomes w / s^k in a motion that takes s times as long.

    Attributes
    ----------
    states, algebraic, controls : tuple of int
        k of every entry of x, z and u: 1 for a velocity, 2 for an acceleration, 0 for a torque, 1 for its rate.
    """

    states: tuple[int, ...]
    algebraic: tuple[int, ...]
    controls: tuple[int, ...]


class Dynamics(Protocol):
    """A semi-explicit DAE with named variables.

    Its functions take the points that its ``point`` returns; those of a robot are RobotPoints.

    Attributes
    ----------
    states, algebraic, controls : tuple of Variable
        The entries of x, z and u.
    residuals : tuple of Variable
        The rows of g, named for reports. Each determines one algebraic variable; constraints determine the others.
    invariants : tuple of Variable
        The rows of I, named for reports; none for most systems.
    """

    @property
    def states(self) -> tuple[Variable, ...]:
        """The entries of x."""
        ...

    @property
    def algebraic(self) -> tuple[Variable, ...]:
        """The entries of z."""
        ...

    @property
    def controls(self) -> tuple[Variable, ...]:
        """The entries of u."""
        ...

    @property
    def residuals(self) -> tuple[Variable, ...]:
        """The rows of g."""
        ...

    @property
    def invariants(self) -> tuple[Variable, ...]:
        """The rows of I."""
        ...

    def point(self, t: ca.SX, x: ca.SX, z: ca.SX | None, u: ca.SX | None, p: ca.SX, names: Sequence[str]) -> Point:
        """Wrap columns of symbols as the Point of user expressions; ``names`` are the parameters' names.

        ``z`` and ``u`` are None at the ends of a phase.
        """
        ...

    def rates(self, point: AnyPoint) -> ca.SX:
        """Evaluate f(x, z, u, p, t), a column of len(states)."""
        ...

    def residual(self, point: AnyPoint) -> ca.SX:
        """Evaluate g(x, z, u, p, t), a column of len(residuals)."""
        ...

    def invariant(self, point: AnyPoint) -> ca.SX:
        """Evaluate I(x, p, t), a column of len(invariants)."""
        ...

    def correction(self, point: AnyPoint, c: ca.SX) -> ca.SX:
        """Evaluate W(x, p) c, a column of len(states), for c of len(invariants)."""
        ...
