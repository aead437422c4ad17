"""Symbols r that represent the inverse dynamics of a robot in the expressions of a stage."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import casadi as ca
import numpy as np
import pinocchio as pin

from robotraj._util.values import dataclass
from robotraj.dynamics.point import Point, RobotPoint
from robotraj.native.rigid_tree import rigid_tree
from robotraj.robot.coupling.coupled_model import uncoupled
from robotraj.robot.per_robot import PerRobot
from robotraj.symbolic import SymbolicModel
from robotraj.symbolic.followers import coordinates

if TYPE_CHECKING:
    from robotraj.native._native import RigidTree
    from robotraj.robot.robot import Robot


@dataclass(frozen=True, eq=False)
class Torques:
    """r = RNEA(q, w, a) without external forces.

    Attributes
    ----------
    symbols : casadi.SX
        r (nv,), which represents the torques in the outputs of a stage [N m, N].
    model : SymbolicModel
        Of all joints; those that follow others are independent in it.
    arguments : casadi.SX
        q, w and a of all joints as one column, (nq + 2 nv,): configuration, velocity and acceleration as expressions of
        the stage's symbols.
    """

    symbols: ca.SX
    model: SymbolicModel
    arguments: ca.SX

    @property
    def tree(self) -> RigidTree:
        """The robot in the format of the compiled module."""
        return _tree(self.model)

    def are_in(self, expression: ca.SX) -> bool:
        """Whether the expression depends on the torques."""
        return bool(ca.depends_on(expression, self.symbols))

    def with_graph(self, expression: ca.SX) -> ca.SX:
        """Substitute the graph of the inverse dynamics for r."""
        nv = self.symbols.numel()
        nq = self.arguments.numel() - 2 * nv
        q, w, a = ca.vertsplit(self.arguments, [0, nq, nq + nv, nq + 2 * nv])
        no_force = ca.SX(6, self.model.model.njoints)
        return ca.substitute(expression, self.symbols, self.model.inverse_dynamics(q, w, a, no_force))

    def substituted(self, symbols: ca.SX, expressions: ca.SX) -> Torques:
        """Replace symbols in the arguments."""
        return replace(self, arguments=ca.substitute(self.arguments, symbols, expressions))


_TREES: WeakKeyDictionary[SymbolicModel, RigidTree] = WeakKeyDictionary()


def _tree(model: SymbolicModel) -> RigidTree:
    if model not in _TREES:
        _TREES[model] = rigid_tree(model.model)
    return _TREES[model]


def separate_torques(point: Point) -> Torques | None:
    """Represent the inverse dynamics of a point by symbols in every expression built from it.

    Returns
    -------
    Torques or None
        None where the point does not belong to a robot or its model has unknown parameters (``rt.design.Design``).
        None where a joint is neither revolute, prismatic nor a free-flyer at the root. None where all joints are
        prismatic: the expressions then contain the graph of M a + g, which is small.
    """
    if not isinstance(point, RobotPoint) or not point.moves or not isinstance(point.symbolic, SymbolicModel):
        return None
    model = point.symbolic
    if point.robot.root == "fixed" and set(point.robot.units) == {"m"}:
        point.__dict__["inverse_dynamics"] = _sliding(point.robot.model, point.a)
        return None
    whole = _of_all_joints(point.robot) if point.robot.followers else model
    try:
        _tree(whole)
    except ValueError:
        return None
    if whole is model:
        torques = ca.SX.sym("r", point.robot.nv)
        point.__dict__["inverse_dynamics"] = torques
        return Torques(torques, model, ca.vertcat(point.q, point.v, point.a))
    places, offsets, rates = coordinates(point.robot.model)
    shares, positions, symbols = ca.sparsify(ca.DM(rates)), ca.sparsify(ca.DM(places)), ca.SX.sym("r", len(rates))
    point.__dict__["inverse_dynamics"] = ca.mtimes(shares.T, symbols)
    every = (ca.mtimes(positions, point.q) + offsets, ca.mtimes(shares, point.v), ca.mtimes(shares, point.a))
    return Torques(symbols, whole, ca.vertcat(*every))


_WHOLE: PerRobot[SymbolicModel] = PerRobot()


def _of_all_joints(robot: Robot) -> SymbolicModel:
    """Return the model of a robot whose followers are independent."""
    return _WHOLE.get(robot, None, lambda: SymbolicModel(uncoupled(robot.model)))


def _sliding(model: pin.Model, a: ca.SX) -> ca.SX:
    """M a + g of a robot with a fixed root and prismatic joints only; M and g are constant, no term depends on v."""
    data, q, still = model.createData(), pin.neutral(model), np.zeros(model.nv)
    gravity = pin.rnea(model, data, q, still, still).copy()
    columns = [pin.rnea(model, data, q, still, unit) - gravity for unit in np.eye(model.nv)]
    mass = ca.sparsify(ca.DM(np.column_stack(columns)), 1e-14 * float(np.abs(columns).max()))
    return ca.mtimes(mass, a) + gravity
