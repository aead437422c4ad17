"""A Point of numbers: frames, centre of mass and momentum by plain double-precision Pinocchio."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import casadi as ca
import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from robotraj._util.arrays import Array
from robotraj._util.lazy_values import cached_property
from robotraj.dynamics.point import Point
from robotraj.dynamics.variable import Column, Named
from robotraj.witness.protocols import RobotLike, SystemLike


class NumericPoint(Point):
    """The state of a robot at one time, in numbers.

    It has the attributes of the symbolic point of the NLP, which are computed at first use.

    Parameters
    ----------
    robot : Robot
    t : float
        Time [s].
    q, v, a : array_like (nq,), (nv,), (nv,)
        Positions [rad, m], velocities and accelerations.
    tau : array_like (nu,)
        Torques of the actuated joints [N m, N].
    parameters : mapping of str to float, optional
    forces : mapping of str to array_like, optional
        Contact forces [N], with moments [N m] for contacts that transmit them, by contact name, in world axes.
    algebraic : mapping of str to float, optional
        Algebraic variables besides the accelerations: the components ``force.<contact>.<axis>`` of the contacts.
    columns : bool
        Return vectors as CasADi columns (n, 1) instead of NumPy arrays (n,). Expressions for the symbols of the NLP,
        such as ``ca.mtimes(point.q.T, point.q)``, then accept the numbers.

    Attributes
    ----------
    t, x, z, u, p
        As in the symbolic point; x is named ``q.<joint>``, ``v.<joint>``, z ``a.<joint>``, u ``tau.<joint>``.
    q, v, a, tau, forces
    """

    def __init__(
        self,
        robot: RobotLike,
        t: float,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        tau: ArrayLike,
        *,
        parameters: Mapping[str, float] | None = None,
        forces: Mapping[str, ArrayLike] | None = None,
        algebraic: Mapping[str, float] | None = None,
        columns: bool = False,
    ) -> None:
        self._robot = robot
        self._q, self._v, self._a = (np.array(s, dtype=float) for s in (q, v, a))
        self._vector: Callable[[Array], Array | ca.DM] = ca.DM if columns else np.asarray
        tau = np.array(tau, dtype=float)
        moved = robot.velocity_names
        parameters = parameters or {}
        forces = forces or {}
        algebraic = algebraic or {}
        super().__init__(
            float(t),
            Named(
                "state",
                [f"q.{name}" for name in robot.position_names] + [f"v.{name}" for name in moved],
                [*self._q, *self._v],
            ),
            Named(
                "algebraic variable",
                [f"a.{name}" for name in moved] + list(algebraic),
                [*self._a, *(float(value) for value in algebraic.values())],
            ),
            Named("control", [f"tau.{j}" for j in robot.actuated], list(tau)),
            Named("parameter", list(parameters), [float(p) for p in parameters.values()]),
        )
        self.q = self._vector(self._q)
        self.v = self._vector(self._v)
        self.a = self._vector(self._a)
        self.tau = self._vector(tau)
        pushes = [self._vector(np.array(force, dtype=float)) for force in forces.values()]
        self.forces: Named[Column] = Named("contact", list(forces), pushes)
        self._frames: dict[str, NumericFrame] = {}

    @cached_property
    def _data(self) -> pin.Data:
        """Kinematics of every frame; ``forwardKinematics`` alone does not update frames."""
        data = self._robot.model.createData()
        pin.forwardKinematics(self._robot.model, data, self._q, self._v, self._a)
        pin.updateFramePlacements(self._robot.model, data)
        return data

    def frame(self, name: str) -> NumericFrame:
        """Return pose and motion of a frame of the robot, in world axes.

        Raises
        ------
        UnknownName
            The robot has no frame of that name.
        """
        if name not in self._frames:
            self._frames[name] = NumericFrame(self, self._robot.frame(name))
        return self._frames[name]

    @cached_property
    def mass(self) -> float:
        """Mass of all bodies that move [kg]."""
        return float(sum(inertia.mass for inertia in list(self._robot.model.inertias)[1:]))

    @cached_property
    def com(self) -> Array | ca.DM:
        """Centre of mass (3,) [m] in the world."""
        model = self._robot.model
        return self._vector(pin.centerOfMass(model, model.createData(), self._q).copy())

    @cached_property
    def gravity(self) -> Array | ca.DM:
        """Generalised force (nv,) that holds the robot against gravity [N m, N]."""
        model = self._robot.model
        return self._vector(pin.computeGeneralizedGravity(model, model.createData(), self._q).copy())

    @cached_property
    def momentum(self) -> Array | ca.DM:
        """Centroidal momentum (6,): linear [kg m/s], angular [kg m^2/s]."""
        model = self._robot.model
        momentum = pin.computeCentroidalMomentum(model, model.createData(), self._q, self._v)
        return self._vector(momentum.vector.copy())


class NumericFrame:
    """Pose and motion of one frame, in numbers."""

    def __init__(self, point: NumericPoint, index: int) -> None:
        self._point = point
        self._index = index

    @cached_property
    def position(self) -> Array | ca.DM:
        """Origin of the frame in the world (3,) [m]."""
        return self._point._vector(self._point._data.oMf[self._index].translation.copy())

    @cached_property
    def rotation(self) -> Array | ca.DM:
        """Rotation matrix from frame to world (3, 3)."""
        return self._point._vector(self._point._data.oMf[self._index].rotation.copy())

    @property
    def velocity(self) -> Array | ca.DM:
        """Linear then angular velocity (6,) [m/s, rad/s], local-world-aligned."""
        return self._motion(pin.getFrameVelocity)

    @property
    def acceleration(self) -> Array | ca.DM:
        """Classical acceleration (6,) [m/s^2, rad/s^2], local-world-aligned."""
        return self._motion(pin.getFrameClassicalAcceleration)

    def _motion(self, read: Callable[[pin.Model, pin.Data, int, pin.ReferenceFrame], pin.Motion]) -> Array | ca.DM:
        point = self._point
        motion = read(point._robot.model, point._data, self._index, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
        return point._vector(motion.vector.copy())


def system_point(system: SystemLike, t: float, x: Array, z: Array, u: Array, parameters: Mapping[str, float]) -> Point:
    """Return the point that a System's equations take, in numbers.

    Entries are NumPy scalars. The square root of a negative trial value is then NaN, which shortens the step. That of a
    Python float would be complex or raise an error.

    Parameters
    ----------
    x, z, u : ndarray
        States, algebraic variables and controls, in the system's order.
    """
    return Point(
        float(t),
        Named("state", [s.name for s in system.states], list(x)),
        Named("algebraic variable", [s.name for s in system.algebraic], list(z)),
        Named("control", [s.name for s in system.controls], list(u)),
        Named("parameter", list(parameters), [float(p) for p in parameters.values()]),
    )
