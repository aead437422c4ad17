"""A robot's inverse dynamics as unknown numbers r inside the expressions of a stage."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import casadi as ca

from robotraj.dynamics.point import RobotPoint
from robotraj.native.torque_chain import read_tree
from robotraj.symbolic import SymbolicModel

if TYPE_CHECKING:
    from robotraj.native._native import RigidTree


@dataclass(frozen=True, eq=False)
class Torques:
    """r = RNEA(q, w, a) without external forces.

    Attributes
    ----------
    symbols : casadi.SX
        r, (nv,): what stands for the torques in the outputs of a stage [N m, N].
    model : SymbolicModel
    q, w, a : casadi.SX
        Configuration (nq,), velocity and acceleration (nv,), as expressions of the stage's symbols.
    """

    symbols: ca.SX
    model: SymbolicModel
    q: ca.SX
    w: ca.SX
    a: ca.SX

    @property
    def tree(self) -> RigidTree:
        """The robot as the compiled module reads it."""
        return _tree(self.model.text)

    @property
    def arguments(self) -> ca.SX:
        """Q, w and a as one column."""
        return ca.vertcat(self.q, self.w, self.a)

    def are_in(self, expression: Any) -> bool:
        """Whether the expression depends on the torques."""
        return bool(ca.depends_on(expression, self.symbols))

    def written_out(self, expression: ca.SX) -> ca.SX:
        """Put the graph of the inverse dynamics in the place of r."""
        no_force = ca.SX(6, self.model.model.njoints)
        return ca.substitute(expression, self.symbols, self.model.inverse_dynamics(self.q, self.w, self.a, no_force))

    def substituted(self, symbols: ca.SX, expressions: ca.SX) -> Torques:
        """Replace symbols in the arguments."""
        nq, nv = self.q.numel(), self.w.numel()
        q, w, a = ca.vertsplit(ca.substitute(self.arguments, symbols, expressions), [0, nq, nq + nv, nq + 2 * nv])
        return replace(self, q=q, w=w, a=a)


@lru_cache(maxsize=16)
def _tree(text: str) -> RigidTree:
    return read_tree(text)


def torques_apart(point: Any) -> Torques | None:
    """Have the inverse dynamics of a point stand as symbols in every expression that is made of it.

    Returns
    -------
    Torques or None
        None where the point is no robot's, where its model has unknown parameters (``rt.Design``), or where a joint
        neither turns about an axis nor slides along one and is no free-flyer at the root.
    """
    if not isinstance(point, RobotPoint) or not point.moves or not isinstance(point.symbolic, SymbolicModel):
        return None
    model = point.symbolic
    try:
        _tree(model.text)
    except ValueError:
        return None
    point.inverse_dynamics = ca.SX.sym("r", point.robot.nv)
    return Torques(point.inverse_dynamics, model, point.q, point.v, point.a)
