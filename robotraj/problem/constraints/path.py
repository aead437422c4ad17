"""Any expression of a Point, bounded along the phase."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.printing import brief
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.expression_values import rows_of
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.row import Row
from robotraj.problem.constraints.base import BoundConstraint, Constraint, symbols_of
from robotraj.problem.constraints.bounds import SideLike
from robotraj.problem.scalars import PointExpression, Scalar, Scalars


@dataclass(frozen=True)
class PathConstraint(Constraint):
    """lower <= expression(point) <= upper at every collocation point.

    An equation (lower = upper) of positions is imposed differently: at every knot together with its rate, and inside
    intervals as the scheme's order requires. Examples are a tool that points down, or one that follows a curve in time.
    See ``robotraj.transcription.collocation.index_reduction``.

    Parameters
    ----------
    expression : callable
        ``expression(point)`` returns a scalar or a vector.
    lower, upper : float or sequence, optional
        Bounds in the unit of the expression; None leaves the side open.
    name, unit : str
        Label and SI unit, for reports.

    Raises
    ------
    InputError
        On binding: bounds have a wrong length, are NaN, crossed or both open, or the expression fails on a point.

    Notes
    -----
    A point holds the variables at one instant. The expressions of ``rt.PathConstraint``,
    ``rt.constraints.IntegralConstraint`` and ``rt.Lagrange`` are functions of a point, and so are the equations of
    ``rt.System``.

    ================================  ======================================================================
    point.t                           time [s]
    point.x[name], point.z[name]      states, algebraic variables: "q.elbow", "v.elbow", "a.elbow"
    point.u[name], point.p[name]      controls such as "tau.elbow", parameters of the phase
    point.q, point.v                  positions (nq,), velocities (nv,) of a robot [rad, m; rad/s, m/s]
    point.a, point.tau                accelerations (nv,) [rad/s^2, m/s^2], torques (nu,) [N m, N]
    point.forces[contact]             force of a contact (3,) [N], with a moment (6,)
    point.frame(name).position        origin of a frame in the world (3,) [m]
    point.frame(name).rotation        rotation (3, 3) from the frame to the world
    point.frame(name).velocity        linear, then angular (6,) [m/s, rad/s], in world axes
    point.frame(name).acceleration    the same of the acceleration [m/s^2, rad/s^2]
    point.com, point.momentum         centre of mass (3,) [m], centroidal momentum (6,) [kg m/s, kg m^2/s]
    point.mass, point.damping         mass of all bodies [kg], damping (nv,) [N m s/rad, N s/m]
    point.gravity                     generalised force (nv,) against gravity [N m, N]
    point.robot, point.symbolic       the Robot, Pinocchio's algorithms on symbols
    point.extra, point.contact_terms  variables of the objective, terms of contacts (for new classes)
    ================================  ======================================================================

    Entries are CasADi symbols while a problem is built, and numbers when a plan is checked. Use functions such as
    ``casadi.sqrt(...)``, which take both. The two points of ``rt.Mayer`` have neither z, u, a, tau nor forces.
    """

    expression: PointExpression
    lower: SideLike = None
    upper: SideLike = None
    name: str = "path constraint"
    unit: str = ""

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Try the expression on symbols, count its rows and pair them with bounds."""
        what = f"expression of constraint {self.name!r}"
        count = len(rows_of(what, self.expression, symbols_of(dynamics, parameters)))
        lower = side(self.lower, -np.inf, count, self.name)
        upper = side(self.upper, np.inf, count, self.name)
        for i in range(count):
            if not lower[i] <= upper[i]:
                raise InputError(
                    f"{self.name!r}: row {i} has lower bound {lower[i]:g} above its upper bound {upper[i]:g}; "
                    "exchange them."
                )
            if np.isinf(lower[i]) and np.isinf(upper[i]):
                raise InputError(f"{self.name!r} has no bound in row {i}; give lower= or upper=.")
        names = [self.name] if count == 1 else [f"{self.name}[{i}]" for i in range(count)]
        rows = tuple(Row(n, self.unit, lo, up) for n, lo, up in zip(names, lower, upper, strict=True))
        user = self.expression

        def expression(point: RobotPoint) -> list[Scalar]:
            return flat(user(point))

        return BoundConstraint(self.name, rows, expression)


def side(value: SideLike, default: float, count: int, name: str) -> list[float]:
    """Broadcast one side of the bounds to the rows of an expression."""
    try:
        array = np.asarray(default if value is None else value, dtype=float).ravel()
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(
            f"{name!r} has a bound that is {brief(value)}; give a number, or one for each of {count} rows."
        ) from error
    if array.size not in (1, count):
        raise InputError(f"{name!r} has {count} rows but a bound of {array.size} values; give 1 or {count}.")
    if np.isnan(array).any():
        raise InputError(f"{name!r} has a bound that is NaN; use None for an open side.")
    return [float(b) for b in np.broadcast_to(array, (count,))]


def flat(values: Scalars) -> list[Scalar]:
    """Entries of a scalar, list or column, symbolic or numeric, without conversion."""
    if isinstance(values, ca.SX | ca.DM | ca.MX):
        return [values[i] for i in range(values.numel())]
    if isinstance(values, Sequence) or (hasattr(values, "ravel") and np.ndim(values) > 0):
        parts = values.ravel() if hasattr(values, "ravel") else values
        return [entry for part in parts for entry in flat(part)]
    return [values]
