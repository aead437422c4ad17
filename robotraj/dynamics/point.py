"""The Point: the variables at one instant, the argument of every user expression.

In the NLP a point holds CasADi symbols (this file). In the witness it holds numbers from plain Pinocchio. Both evaluate
the same user expression.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

import casadi as ca

from robotraj._util.errors import InputError
from robotraj._util.lazy_values import cached_property
from robotraj.dynamics.variable import Column, Named, Scalar
from robotraj.robot.per_robot import PerRobot

if TYPE_CHECKING:
    from robotraj.dynamics.design.model import DesignedModel
    from robotraj.robot.robot import Robot
    from robotraj.symbolic import SymbolicModel

_models: PerRobot[SymbolicModel] = PerRobot()


def symbolic_model(robot: Robot) -> SymbolicModel:
    """Return Pinocchio's algorithms on the robot's planning model as CasADi functions, built once a robot."""

    def make() -> SymbolicModel:
        from robotraj.symbolic import SymbolicModel  # imported on use: it loads the compiled module

        return SymbolicModel(robot.model)

    return _models.get(robot, None, make)


AnyPoint: TypeAlias = Any
"""A Point, or the subclass that the dynamics of a phase make. Functions of a point name the class that they read."""


class FrameMotion(Protocol):
    """Pose and motion of a frame in world axes; see ``FrameView``."""

    @property
    def position(self) -> Column:
        """Origin (3,) [m]."""

    @property
    def rotation(self) -> Column:
        """Rotation matrix (3, 3) from frame to world."""

    @property
    def velocity(self) -> Column:
        """Linear then angular velocity (6,) [m/s, rad/s]."""

    @property
    def acceleration(self) -> Column:
        """Classical acceleration (6,) [m/s^2, rad/s^2]."""


class FramePoint(Protocol):
    """A point with the frames of its robot: symbolic or numeric."""

    def frame(self, name: str) -> FrameMotion:
        """Return the pose and motion of a frame."""


class ContactTerms(Protocol):
    """The terms that one contact adds to the equations: its reaction and its held rows."""

    @property
    def reaction(self) -> ca.SX:
        """Generalised force -J' f (nv,) [N m, N]."""

    @property
    def places(self) -> Sequence[Scalar]:
        """Position rows [m, rad]."""

    @property
    def rates(self) -> Sequence[Scalar]:
        """Velocity rows [m/s, rad/s]."""

    @property
    def accelerations(self) -> Sequence[Scalar]:
        """Acceleration rows [m/s^2, rad/s^2]."""


class SymbolicContactTerms(ContactTerms, Protocol):
    """The terms of a contact as symbols."""

    @property
    def corrected(self) -> ca.SX:
        """Rates (nq + nv,) of the state along the corrections."""


class Point:
    """The variables at one instant of a phase.

    Attributes
    ----------
    t : scalar
        Time [s].
    x, z, u, p : Named
        States, algebraic variables, controls and parameters by name. At the ends of a phase (Mayer terms and
        links) only ``t``, ``x`` and ``p`` exist.
    extra : dict of str
        Variables that the phase's objective adds (``robotraj.problem.augmentation``), by name.
    """

    def __init__(self, t: Scalar, x: Named[Scalar], z: Named[Scalar], u: Named[Scalar], p: Named[Scalar]) -> None:
        self.t = t
        self.x = x
        self.z = z
        self.u = u
        self.p = p
        self.extra: dict[str, Scalar] = {}


class RobotPoint(Point):
    """A point of a robot: adds joint vectors, frames and the centre of mass.

    Attributes
    ----------
    robot : Robot
    symbolic : SymbolicModel or DesignedModel
        Pinocchio's algorithms, with the phase's design if it has one.
    damping : array or column (nv,)
        Viscous damping, of the design if there is one [N m s/rad, N s/m].
    q : column (nq,)
        Positions [rad, m]; see ``Robot`` for a moving root.
    v, a : column (nv,)
        Velocities [rad/s, m/s] and accelerations [rad/s^2, m/s^2].
    tau : column (nu,)
        Torques of the actuated joints [N m, N].
    forces : Named
        Contact forces by contact name [N].
    contact_terms : dict of str
        Terms of the contacts as symbols, by contact name (``dynamics.contact_terms``).
    """

    def __init__(
        self,
        t: Scalar,
        x: Named[Scalar],
        z: Named[Scalar],
        u: Named[Scalar],
        p: Named[Scalar],
        robot: Robot,
        q: ca.SX,
        v: ca.SX,
        a: ca.SX | None,
        tau: ca.SX | None,
        symbolic: SymbolicModel | DesignedModel | None = None,
        damping: Column | None = None,
    ) -> None:
        super().__init__(t, x, z, u, p)
        self.robot = robot
        self.symbolic = symbolic_model(robot) if symbolic is None else symbolic
        self.damping = robot.damping if damping is None else damping
        self._a = a
        self._tau = tau
        self._frames: dict[str, FrameView] = {}
        self.q = q
        self.v = v
        self.forces: Named[Column] = Named("contact", (), ())
        self.contact_terms: dict[str, SymbolicContactTerms] = {}

    @property
    def a(self) -> ca.SX:
        """Joint accelerations (nv,) [rad/s^2, m/s^2]."""
        if self._a is None:
            raise InputError("Accelerations are not known at the end points of a phase; use a path constraint there.")
        return self._a

    @property
    def moves(self) -> bool:
        """Whether accelerations are known."""
        return self._a is not None

    @cached_property
    def inverse_dynamics(self) -> ca.SX:
        """RNEA(q, v, a), the generalised force (nv,) of the motion without contacts, damping or friction [N m, N].

        ``dynamics.torque_symbols`` replaces it by symbols before it is first read.
        """
        no_force = ca.SX(6, self.robot.model.njoints)
        return self.symbolic.inverse_dynamics(self.q, self.v, self.a, no_force)

    @property
    def gravity(self) -> ca.SX:
        """RNEA(q, 0, 0), the generalised force (nv,) that holds the robot against gravity [N m, N]."""
        still = ca.SX.zeros(self.robot.nv)
        return self.symbolic.inverse_dynamics(self.q, still, still, ca.SX(6, self.robot.model.njoints))

    @property
    def tau(self) -> ca.SX:
        """Torques of the actuated joints (nu,) [N m, N]."""
        if self._tau is None:
            raise InputError("Torques are not known at the end points of a phase; use a path constraint there.")
        return self._tau

    def frame(self, name: str) -> FrameView:
        """Pose and motion of a frame of the robot, in world axes."""
        self.robot.frame(name)
        if name not in self._frames:
            self._frames[name] = FrameView(self, name)
        return self._frames[name]

    @property
    def mass(self) -> Scalar:
        """Mass of all bodies that move [kg], the design's included."""
        return self.symbolic.mass

    @cached_property
    def _center_of_mass(self) -> ca.SX:
        still = ca.SX.zeros(self.robot.nv)
        return self.symbolic.center_of_mass(self.q, self.v, still if self._a is None else self._a)

    @property
    def com(self) -> ca.SX:
        """Centre of mass (3,) [m] in the world."""
        return self._center_of_mass[0]

    @cached_property
    def momentum(self) -> ca.SX:
        """Centroidal momentum (6,): linear [kg m/s], angular [kg m^2/s]."""
        return self.symbolic.centroidal_momentum(self.q, self.v)


class FrameView:
    """Pose and motion of one frame, symbolic; every property is built when first read."""

    def __init__(self, point: RobotPoint, name: str) -> None:
        self._point = point
        self._name = name
        self._symbolic = point.symbolic

    @cached_property
    def _placement(self) -> ca.SX:
        return self._symbolic.frame_placement(self._name)(self._point.q)

    @property
    def position(self) -> ca.SX:
        """Origin of the frame in the world (3,) [m]."""
        return self._placement[0]

    @property
    def rotation(self) -> ca.SX:
        """Rotation matrix from frame to world (3, 3)."""
        return self._placement[1]

    @cached_property
    def velocity(self) -> ca.SX:
        """Linear then angular velocity (6,) [m/s, rad/s], local-world-aligned."""
        return self._symbolic.frame_velocity(self._name)(self._point.q, self._point.v)

    @cached_property
    def acceleration(self) -> ca.SX:
        """Classical acceleration (6,) [m/s^2, rad/s^2], local-world-aligned."""
        return self._symbolic.frame_acceleration(self._name)(self._point.q, self._point.v, self._point.a)
