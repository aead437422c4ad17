"""A robot on a given path of its joints, as a DAE of the path parameter alone.

With q = p(s), the joints' motion and the torques of the motors are functions of s, its speed s' and s'':

    v = p' s',    a = p'' s'^2 + p' s'',    B tau = RNEA(q, v, a) + d(v)

The state is (s, s') and the control s''; there is nothing to solve for. With the rate s''' of the control, jerks and
the rates of torques are

    j = p''' s'^3 + 3 p'' s' s'' + p' s''',    dtau/dt = d/dt tau(q, v, a) along (v, a, j).

Source: Bobrow, Dubowsky and Gibson, International Journal of Robotics Research 4 (1985).
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj._util.errors import InputError
from robotraj._util.lazy_values import cached_property
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import TimeOrders
from robotraj.dynamics.motors_and_friction import joint_forces
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.rigid_body import InverseRigidBody, RigidBody
from robotraj.dynamics.variable import Named, Scalar, Variable

PARAMETER, SPEED, ACCELERATION = "path.s", "path.speed", "path.acceleration"
"""Names of the states and of the control."""
PLACES = np.linspace(0.0, 1.0, 17)
"""Places of every piece of a path at which its extent is measured."""
RESTING, BENDING = 1e-9, 1e-3
"""Largest p' at an end at which joints rest, and least p'' there with which s' is free.

The first is relative to the largest p', the second to that over the length of the path.
"""


class PathPoint(RobotPoint):
    """A point on the path. Names are those of a robot without a path; s, s' and s'' are in ``point.extra``.

    Attributes
    ----------
    slopes : sequence of SX
        p', p'' and p''' at s, (nq,) each.
    softening : float
        Of the dry friction, see ``motors_and_friction``.
    """

    slopes: Sequence[ca.SX]
    softening: float

    @property
    def u(self) -> Named[Scalar]:
        """The torques by name; they depend on ``inverse_dynamics``, which may become symbols later."""
        if not self.moves:
            return Named("control", [], None)
        return Named("control", [f"tau.{joint}" for joint in self.robot.actuated], self.tau)

    @u.setter
    def u(self, value: Named[Scalar]) -> None:
        """Ignore the value of the base class."""

    @property
    def tau(self) -> ca.SX:
        """Torques of the motors (nu,) [N m, N].

        Raises
        ------
        InputError
            The point is an end of a phase, where accelerations are not known.
        """
        robot = self.robot
        still = ca.SX.zeros(robot.nu)
        force = self.inverse_dynamics - joint_forces(robot, self.q, self.v, still, self.damping, self.softening)
        return ca.vertcat(*(force[robot.velocity_names.index(joint)] for joint in robot.actuated))


@dataclass(frozen=True)
class PathBody(RigidBody):
    """x = (s, s'), u = s''; a robot with a fixed root and a motor at every joint.

    Attributes
    ----------
    path : PiecewisePolynomial
        p from s to q (nq,) [rad, m], with a continuous second derivative.
    start_speed, end_speed : float or None
        s' at both ends; None leaves it free. With 0 the joints rest. Where p' vanishes they rest at any s', which is
        then free: accelerations p'' s'^2 bound it. With s' = 0 they could not accelerate there at all.
    whole : bool
        Whether the motion ends at the end of the path; otherwise s is free there.
    start_acceleration : float or None
        s'' at the start, where it is a state; None leaves it free, except at rest.
    """

    path: PiecewisePolynomial | None = None
    start_speed: float | None = 0.0
    end_speed: float | None = 0.0
    whole: bool = True
    start_acceleration: float | None = None
    states: tuple[Variable, ...] = (
        Variable(PARAMETER, "", "path parameter"),
        Variable(SPEED, "1/s", "path speed"),
    )
    algebraic: tuple[Variable, ...] = ()
    controls: tuple[Variable, ...] = (Variable(ACCELERATION, "1/s^2", "path acceleration"),)
    residuals: tuple[Variable, ...] = ()
    invariants: tuple[Variable, ...] = ()

    def __post_init__(self) -> None:
        robot = self.robot
        if robot.root != "fixed" or not robot.nq == robot.nv == robot.nu:
            raise InputError(
                f"A path needs a robot with a fixed root and a motor at every joint; {robot.name!r} has "
                f"{robot.nv} velocities and {robot.nu} motors. Load it with root='fixed', or lock joints."
            )
        if self.curve.size != robot.nq:
            raise InputError(
                f"The path has {self.curve.size} joints, but {robot.name!r} has {robot.nq}; give a path of all joints."
            )

    @property
    def curve(self) -> PiecewisePolynomial:
        """The path."""
        assert self.path is not None
        return self.path

    @property
    def position_count(self) -> int:
        """One: s."""
        return 1

    @property
    def time_orders(self) -> TimeOrders:
        """0 for s, 1 for s', 2 for s''."""
        return TimeOrders((0, 1), (), (2,))

    @cached_property
    def free(self) -> InverseRigidBody:
        """The robot without the path; its variables are the functions of s that points have by name."""
        return InverseRigidBody(self.robot, self.design, softening=self.softening)

    def ends(self, last: bool) -> tuple[Array, Array]:
        """Return lower and upper bounds of (s, s') at the start or at the end, (2,) each."""
        s, speed = self._end(last)
        anywhere = last and not self.whole
        is_free = speed is None or (speed == 0.0 and not anywhere and self._rests_at(s))
        low, high = (0.0, np.inf) if is_free else (speed, speed)
        first = float(self.curve.breaks[0]) if anywhere else s
        return np.array([first, low]), np.array([s, high])

    def joint_ends(self, last: bool) -> tuple[Array, Array]:
        """Return lower and upper bounds of (q, v) at the start or at the end, (nq + nv,) each."""
        s, speed = self._end(last)
        free = np.full(self.curve.size, np.inf)
        if last and not self.whole:
            inside = self.curve.inside(PLACES)
            bound = free if speed is None else np.where(speed == 0.0, 0.0, free)
            low, high = inside.min(axis=(0, 1)), inside.max(axis=(0, 1))
            return np.concatenate([low, -bound]), np.concatenate([high, bound])
        q, slope = self.curve(s), self.curve.derivative()(s)
        low, high = (-free, free) if speed is None else (slope * speed, slope * speed)
        return np.concatenate([q, low]), np.concatenate([q, high])

    def _rests_at(self, s: float) -> bool:
        """Whether p' vanishes at an end and p'' does not."""
        slope = self.curve.derivative()
        largest = max(float(np.abs(values).max()) for values in slope.values)
        bend = float(np.abs(slope.derivative()(s)).max()) * float(self.curve.breaks[-1] - self.curve.breaks[0])
        return float(np.abs(slope(s)).max()) < RESTING * largest and bend > BENDING * largest

    def _end(self, last: bool) -> tuple[float, float | None]:
        speed = self.end_speed if last else self.start_speed
        return float(self.curve.breaks[-1 if last else 0]), None if speed is None else float(speed)

    def point(self, t: ca.SX, x: ca.SX, z: ca.SX | None, u: ca.SX | None, p: ca.SX, names: Sequence[str]) -> PathPoint:
        """Wrap columns of symbols as a PathPoint."""
        s, speed = x[0], x[1]
        q, *slopes = values_on(self.curve, s)
        a = None if u is None else slopes[1] * speed**2 + slopes[0] * u[0]
        point = self._moving(t, q, slopes[0] * speed, a, p, names)
        point.slopes = slopes
        point.extra = {PARAMETER: s, SPEED: speed} | ({} if u is None else {ACCELERATION: u[0]})
        return point

    def _moving(self, t: ca.SX, q: ca.SX, v: ca.SX, a: ca.SX | None, p: ca.SX, names: Sequence[str]) -> PathPoint:
        states, accelerations = ([v.name for v in kind] for kind in (self.free.states, self.free.algebraic))
        point = PathPoint(
            t,
            Named("state", states, ca.vertcat(q, v)),
            Named("algebraic variable", accelerations if a is not None else [], a),
            Named("control", [], None),
            Named("parameter", names, p),
            self.robot,
            q,
            v,
            a,
            None,
            *self._numbers(p, names),
        )
        point.softening = self.softening
        return point

    def rates(self, point: RobotPoint) -> ca.SX:
        """Return s' and s''."""
        return ca.vertcat(point.extra[SPEED], point.extra[ACCELERATION])

    def residual(self, point: RobotPoint) -> ca.SX:
        """No algebraic rows."""
        return ca.SX(0, 1)

    def invariant(self, point: RobotPoint) -> ca.SX:
        """No invariants."""
        return ca.SX(0, 1)

    def correction(self, point: RobotPoint, c: ca.SX) -> ca.SX:
        """Nothing to correct."""
        return ca.SX.zeros(len(self.states))

    def jerk(self, point: PathPoint, rate: Scalar) -> ca.SX:
        """Jerks (nv,) [rad/s^3, m/s^3] where s'' changes at a rate s'''."""
        first, second, third = point.slopes
        speed = point.extra[SPEED]
        return third * speed**3 + 3.0 * second * speed * point.extra[ACCELERATION] + first * rate

    def torque_rate(self, point: PathPoint, rate: Scalar) -> ca.SX:
        """Rates of the torques without dry friction (nu,) [N m/s, N/s] where s'' changes at a rate s'''."""
        nv, names = self.robot.nv, list(point.p)
        q, v, a, j = (ca.SX.sym(name, nv) for name in "qvaj")
        p = ca.SX.sym("p", len(names))
        moving = self._moving(ca.SX(0), q, v, a, p, names)
        friction = self.dry_friction(moving)
        driven = [self.robot.velocity_names.index(joint) for joint in self.robot.actuated]
        along = ca.jtimes(moving.tau - friction[driven], ca.vertcat(q, v, a), ca.vertcat(v, a, j))
        made = ca.Function("torque_rate", [q, v, a, j, p], [along])
        return made(point.q, point.v, point.a, self.jerk(point, rate), ca.vertcat(ca.SX(0, 1), *point.p.values()))


def values_on(path: PiecewisePolynomial, s: ca.SX) -> list[ca.SX]:
    """Return the values of a path and of its first three derivatives at a symbol s, (n,) each.

    With [s >= b_k] = 1 beyond the break b_k, the coefficients of the piece that s lies in are
    c_0 + sum_k [s >= b_k] (c_k - c_{k-1}). The first and the last piece extend beyond the ends.
    """
    degree = max(len(sites) for sites in path.sites)
    rows = []
    for start, end, sites, values in zip(path.breaks, path.breaks[1:], path.sites, path.values, strict=False):
        powers = np.linalg.solve(np.vander(np.asarray(sites), increasing=True), np.asarray(values))
        powers = powers / ((end - start) ** np.arange(len(powers)))[:, None]
        rows.append(np.concatenate([[start], np.pad(powers, ((0, degree - len(powers)), (0, 0))).ravel()]))
    chosen = ca.SX(ca.DM(rows[0]))
    for before, row in zip(rows[:-1], rows[1:], strict=True):
        chosen += (s >= row[0]) * ca.SX(ca.DM(row - before))
    along, n = s - chosen[0], path.size
    coefficients = [chosen[1 + d * n : 1 + (d + 1) * n] for d in range(degree)]
    found = []
    for _ in range(4):
        value = ca.SX.zeros(n)
        for c in reversed(coefficients):
            value = value * along + c
        found.append(value)
        coefficients = [float(d) * c for d, c in enumerate(coefficients)][1:]
    return found
