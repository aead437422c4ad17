"""The protocol that carries the transcriber: a phase is a semi-explicit DAE.

    xdot = f(x, z, u, p, t),    0 = g(x, z, u, p, t)

with x the state, z the algebraic variables, u the controls, p parameters and t time. An ordinary ODE has no z. Schemes,
meshes, objectives and solvers see nothing but this protocol, and know nothing of robots.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import casadi as ca

from robotraj.dynamics.point import Point
from robotraj.dynamics.variable import Variable


class Dynamics(Protocol):
    """A semi-explicit DAE with named variables.

    Attributes
    ----------
    states, algebraic, controls : tuple of Variable
        The entries of x, z and u.
    residuals : tuple of Variable
        The rows of g, named for reports; as many as there are algebraic variables it determines.
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

    def point(self, t: ca.SX, x: ca.SX, z: ca.SX | None, u: ca.SX | None, p: ca.SX, names: Sequence[str]) -> Point:
        """Wrap columns of symbols as the Point user expressions read; ``names`` are the parameters'.

        ``z`` and ``u`` are None at the end points of a phase, where they are not known.
        """
        ...

    def rates(self, point: Any) -> ca.SX:
        """Evaluate f(x, z, u, p, t), a column of len(states)."""
        ...

    def residual(self, point: Any) -> ca.SX:
        """Evaluate g(x, z, u, p, t), a column of len(residuals)."""
        ...
