"""Joints along curves of the tool: inverse kinematics with two derivatives, as piecewise polynomials."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.curves.polynomials import basis
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj._util.errors import InputError
from robotraj._util.lazy_values import cached_property
from robotraj._util.values import dataclass
from robotraj.applications.programs.tool_curves import ToolCurve, twist_rates
from robotraj.robot.robot import Robot

OFF = 1e-6
"""Largest distance of the tool from its curve between the configurations that are exact [m, rad]."""
SOLVED, STEPS = 1e-12, 30
"""Largest error of an exact configuration [m, rad], and largest number of Newton steps to it."""
LARGEST_STEP = 1.0
"""Largest Newton step [rad, m]; a longer one leads to another branch."""
HALVINGS = 10
"""Largest number of times that a piece is halved."""
BETWEEN = np.array([0.2, 0.5, 0.8])
"""Places of a piece where the tool is compared with its curve."""
WORLD = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
SITES = np.linspace(0.0, 1.0, 6)
"""Places of the values of a polynomial in its interval."""
_POWERS = np.vander(SITES, increasing=True)
_ENDS = np.array([[1.0, 1.0, 1.0], [3.0, 4.0, 5.0], [6.0, 12.0, 20.0]])
"""Value and two derivatives at 1 of x^3, x^4 and x^5."""


@dataclass(frozen=True, eq=False)
class ToolJoints:
    """Joints as a function of the tool's pose, on the branch of one configuration.

    With N the null space of the tool's Jacobian J at that configuration q0, q solves

        pose(q) = pose,    N' (q - q0) = 0,

    which gives a redundant arm one posture for every pose. Along a curve with the twist V,

        J q' = V,    J q'' = V' - J' q',    N' q' = N' q'' = 0.

    Attributes
    ----------
    robot : Robot
    tool : int
        Number of the frame.
    near : ndarray (nq,)
        q0 [rad, m].
    """

    robot: Robot
    tool: int
    near: Array

    @cached_property
    def _data(self) -> pin.Data:
        return self.robot.model.createData()

    @cached_property
    def _postures(self) -> Array:
        """N' (nq - 6, nq)."""
        jacobian = pin.computeFrameJacobian(self.robot.model, self._data, self.near, self.tool, WORLD)
        return np.asarray(np.linalg.svd(jacobian)[2][6:])

    def pose(self, q: Array) -> pin.SE3:
        """Return the pose of the tool."""
        pin.framesForwardKinematics(self.robot.model, self._data, q)
        return pin.SE3(self._data.oMf[self.tool])

    def at(self, curve: ToolCurve, s: float, last: bool, near: Array, what: str) -> Array:
        """Return q and its two derivatives by s at a place of a curve (3, nq); Newton's method starts at ``near``.

        Raises
        ------
        InputError
            The arm does not reach the place on this branch.
        """
        pose, twist, rate = twist_rates(curve.rotation(last), curve.state(s, last))
        q, size = near, np.inf
        for _ in range(STEPS):
            here = self.pose(q)
            off = np.concatenate([pose.translation - here.translation, pin.log3(pose.rotation @ here.rotation.T)])
            size = float(np.abs(off).max())
            matrix = np.concatenate([self._jacobian(q), self._postures])
            step = _solved(matrix, np.concatenate([off, self._postures @ (self.near - q)]))
            if size < SOLVED or step is None or np.abs(step).max() > LARGEST_STEP:
                break
            q = q + step
        first = _solved(matrix, np.concatenate([twist, np.zeros(len(self._postures))]))
        if size > 1e3 * SOLVED or first is None:
            raise InputError(
                f"{what}: the arm does not reach the way of its tool at {np.round(pose.translation, 6).tolist()}, or "
                "is singular there. Move the target, start in another posture, or use MoveJ."
            )
        pin.forwardKinematics(self.robot.model, self._data, q, first, np.zeros_like(q))
        bend = pin.getFrameClassicalAcceleration(self.robot.model, self._data, self.tool, WORLD).vector
        second = _solved(matrix, np.concatenate([rate - bend, np.zeros(len(self._postures))]))
        assert second is not None
        return np.array([q, first, second])

    def along(self, curve: ToolCurve, start: float, end: float, near: Array, what: str) -> PiecewisePolynomial:
        """Return q over s in [start, end] with a continuous second derivative; the tool is on the curve within 1e-6.

        Pieces are halved until it is, in metres and radians.

        Raises
        ------
        InputError
            The arm cannot follow the curve on this branch.
        """
        breaks, values = [start], list[Array]()
        here = self.at(curve, start, False, near, what)
        # A stack of ends, the next one last, with the number of halvings that led to it.
        ends = [(end, 1), (0.5 * (start + end), 1)]
        while ends:
            to, halvings = ends[-1]
            there = self.at(curve, to, False, here[0], what)
            length = to - breaks[-1]
            piece = hermite(here, there, length)
            if self._off(curve, breaks[-1] + length * BETWEEN, basis(SITES, BETWEEN) @ piece) > OFF:
                if halvings >= HALVINGS:
                    raise InputError(
                        f"{what}: the joints jump at {np.round(curve.state(to, False)[0, :3], 6).tolist()}, where the "
                        "arm is singular. Move the target, start in another posture, or use MoveJ."
                    )
                ends[-1] = (to, halvings + 1)
                ends.append((0.5 * (breaks[-1] + to), halvings + 1))
                continue
            ends.pop()
            breaks.append(to)
            values.append(piece)
            here = there
        return PiecewisePolynomial(np.array(breaks), [SITES] * len(values), values)

    def _off(self, curve: ToolCurve, places: Array, configurations: Array) -> float:
        """Return the largest distance of the tool from the curve [m, rad]."""
        largest = 0.0
        for s, q in zip(places, configurations, strict=True):
            wanted = twist_rates(curve.rotation(False), curve.state(float(s), False))[0]
            here = self.pose(q)
            gaps = wanted.translation - here.translation, pin.log3(wanted.rotation.T @ here.rotation)
            largest = max(largest, *(float(np.linalg.norm(gap)) for gap in gaps))
        return largest

    def _jacobian(self, q: Array) -> Array:
        return np.asarray(pin.computeFrameJacobian(self.robot.model, self._data, q, self.tool, WORLD))


def _solved(matrix: Array, right: Array) -> Array | None:
    try:
        return np.asarray(np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError:
        return None


def hermite(first: Array, last: Array, length: float) -> Array:
    """Return the values (6, n) at ``SITES`` of the polynomial with given ends.

    Where the second derivatives vanish, its Bezier points are p0, p0 + h p0', p0 + 2 h p0' and p1 - 2 h p1',
    p1 - h p1', p1 with h = length / 5. The curve lies in their convex hull.

    Parameters
    ----------
    first, last : ndarray (3, n)
        Value, first and second derivative at both ends.
    length : float
        Of the interval.
    """
    scale = length ** np.arange(3.0)[:, None]
    low = scale * first / np.array([[1.0], [1.0], [2.0]])
    ahead = np.array([low.sum(axis=0), low[1] + 2.0 * low[2], 2.0 * low[2]])
    return np.asarray(_POWERS @ np.concatenate([low, np.linalg.solve(_ENDS, scale * last - ahead)]))
