"""The robot: a frozen planning model with limits, motors, damping and friction."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from html import escape

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError, unknown_name
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import brief, plain, wrapped
from robotraj._util.values import dataclass
from robotraj.robot.configuration import as_vector, unit_quaternion
from robotraj.robot.coupling.mimics import Mimic, mimics_of
from robotraj.robot.coupling.pickling import PickledModel
from robotraj.robot.joint_table import Joints, joint_html, joint_table, number
from robotraj.robot.limits import Limits
from robotraj.robot.loading.geometry import Geometry, NoGeometry
from robotraj.robot.loading.planning_model import independent_names
from robotraj.robot.root import QUATERNION, root_of, units_of
from robotraj.robot.springs.joint_springs import Spring, springs_note


@dataclass(frozen=True, eq=False, repr=False)
class Robot(PickledModel):
    """A robot ready for planning: M(q) a + h(q, v) = B tau - K (q - rest) - D v - F tanh(v / friction_speed).

    ``rt.load`` makes it. Every moving joint has one position and one velocity; the position of a continuous joint is
    its angle. The root is fixed, or first in q and v:

    - ``"planar"``: q and v start with root_x [m] and root_z [m] along the world's axes and root_pitch [rad] about +y.
    - ``"floating"``: q starts with the position of the root link's origin in the world root_x, root_y, root_z [m].
      The unit quaternion root_qx, root_qy, root_qz, root_qw (x, y, z, w) follows: the rotation from the root link's
      axes to the world's. v starts with the root link's linear velocity root_vx, root_vy, root_vz [m/s]. Its angular
      velocity root_wx, root_wy, root_wz [rad/s] follows; both are in the root link's axes. So nq = nv + 1 and q'
      differs from v: ``pin.integrate(robot.model, q, v * time)`` moves q. Source: Pinocchio's free-flyer.

    Arrays are read-only and independent of the caller's model.

    Attributes
    ----------
    name : str
        Its name.
    model : pinocchio.Model
        The planning model; treat it as read-only.
    limits : Limits
        Position, velocity, acceleration and effort limits.
    actuated : tuple of str
        Joints with a motor, in the order of v; tau has their order.
    damping : (nv,) array
        Viscous damping [N m s/rad, N s/m].
    friction : (nv,) array
        Coulomb friction [N m, N].
    neutral : (nq,) array
        A configuration inside the position limits [rad, m]; the root is at the origin unless the
        SRDF's reference places it.
    friction_speed : float
        Speed at which the smoothed friction reaches 76 % of its value [rad/s, m/s]. ``rt.load`` takes a 640th of the
        URDF's highest speed limit of joints with friction, from 0.005 to 0.5; for a free root a 64th, from 0.05 on. A
        joint of a free root without a limit counts as infinitely fast, and one of an arm does not count.
        Another one is set by ``dataclasses.replace(robot, friction_speed=...)``.
    geometry : Geometry
        Source of the shapes.
    origin : str
        Source of the robot, for printing.
    end_effector : str or None
        Frame whose path replays draw, if known.
    notes : tuple of str
        Decisions and findings of loading, such as joints that follow others, rotors, impossible inertias.
    root : str
        ``"fixed"``, ``"planar"`` or ``"floating"``.
    springs : tuple of (str, float, float)
        Joints with a spring: stiffness [N m/rad, N/m] and position without torque [rad, m]; see ``rt.load(springs=)``.
    """

    name: str
    model: pin.Model
    limits: Limits
    actuated: tuple[str, ...]
    damping: Array
    friction: Array
    neutral: Array
    friction_speed: float = 0.005
    geometry: Geometry = field(default_factory=NoGeometry)
    origin: str = ""
    end_effector: str | None = None
    notes: tuple[str, ...] = ()
    root: str = "fixed"
    springs: tuple[Spring, ...] = ()

    def __post_init__(self) -> None:
        for name in ("damping", "friction", "neutral"):
            values = np.array(getattr(self, name), dtype=float)
            values.setflags(write=False)
            object.__setattr__(self, name, values)
        if not self.friction_speed > 0:
            raise InputError(f"friction_speed is {self.friction_speed}; it must be a positive speed [rad/s, m/s].")
        nq, nv = self.model.nq, self.model.nv
        given = {"damping": (self.damping, nv), "friction": (self.friction, nv), "neutral": (self.neutral, nq)}
        for name, (values, size) in given.items():
            if values.shape != (size,):
                raise InputError(f"{name} of robot {brief(self.name)} has the shape {values.shape}; give ({size},).")
        if len(self.limits.joints) != nv:
            raise InputError(
                f"Robot {brief(self.name)} has limits of {len(self.limits.joints)} joints; give limits of {nv}."
            )
        if len(set(self.actuated)) != len(self.actuated) or not set(self.actuated) <= set(self.velocity_names):
            raise InputError(f"actuated of robot {brief(self.name)} is {self.actuated!r}; name its joints once each.")

    def __repr__(self) -> str:
        joints = self.nv - self.limits.free
        moving = f"{self.root} root, {joints} joint{'s' if joints != 1 else ''}"
        return f"<Robot {brief(self.name)}: {moving}, {self.nu} actuated, {self.mass:.4g} kg>"

    def __str__(self) -> str:
        """Tabulate the joints, with the decisions and findings of loading as notes."""
        placed = wrapped(self._placed) if self._placed else []
        notes = [line for note in self._notes for line in wrapped(f"note: {note}")]
        return plain("\n".join([*wrapped(self._title), *joint_table(self._joints), *placed, *notes]))

    def _repr_html_(self) -> str:
        """Return the title, the joints and the notes for a notebook."""
        notes = "".join(f"<li>{escape(note)}</li>" for note in filter(None, (self._placed, *self._notes)))
        return f"<div><b>{escape(self._title)}</b>{joint_html(self._joints)}<ul>{notes}</ul></div>"

    @property
    def _title(self) -> str:
        root = "" if self.root == "fixed" else f"{self.root} root, "
        moving = self.nv - self.limits.free
        return (
            f"{self.name}: {root}{moving} moving joint{'s' if moving != 1 else ''}, {self.nu} actuated, "
            f"{self.mass:.4g} kg moving, from {self.origin}"
        )

    @property
    def _joints(self) -> Joints:
        quaternion, limits = self.nq - self.nv, self.limits
        # The positions of a floating root do not correspond to velocities; ``_placed`` prints them.
        neutral = np.where(np.arange(self.nv) < limits.free if quaternion else False, np.nan, self.neutral[quaternion:])
        motors = [joint in self.actuated for joint in self.velocity_names]
        return Joints(self.velocity_names, self.units, limits, motors, self.damping, self.friction, neutral)

    @property
    def _placed(self) -> str:
        """The neutral placement of a floating root; empty for the others."""
        if self.nq == self.nv:
            return ""
        place = list(zip(self.position_names, self.neutral, self.position_units, strict=True))[: self.limits.free + 1]
        stands = ", ".join(f"{name} {number(value, unit)}" for name, value, unit in place)
        return f"neutral root: {stands}; velocities in the root link's own axes"

    @property
    def _notes(self) -> tuple[str, ...]:
        springs = springs_note(self.springs, dict(zip(self.velocity_names, self.units, strict=True)))
        return (*self.notes, *filter(None, [springs]), *self.limits.warnings(self.actuated))

    @property
    def nq(self) -> int:
        """Number of positions."""
        return int(self.model.nq)

    @property
    def nv(self) -> int:
        """Number of velocities: nq, or nq - 1 with a floating root."""
        return int(self.model.nv)

    @property
    def nu(self) -> int:
        """Number of motors."""
        return len(self.actuated)

    @cached_property
    def mass(self) -> float:
        """Mass of the moving links [kg]."""
        return float(sum(inertia.mass for inertia in list(self.model.inertias)[1:]))

    @cached_property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints with entries in v, in its order, without followers; a floating root is ``root_joint``."""
        return tuple(independent_names(self.model))

    @cached_property
    def followers(self) -> tuple[Mimic, ...]:
        """Joints without entries in q and v, each at multiplier * leader + offset."""
        return mimics_of(self.model)

    @cached_property
    def position_names(self) -> tuple[str, ...]:
        """Names of the entries of q, (nq): those of the root, then the joints'."""
        about = root_of(self.root)
        return (*about.positions, *self.joint_names[len(about.joints) :])

    @cached_property
    def velocity_names(self) -> tuple[str, ...]:
        """Names of the entries of v and a, (nv): those of the root, then the joints'."""
        about = root_of(self.root)
        return (*about.velocities, *self.joint_names[len(about.joints) :])

    @cached_property
    def frame_names(self) -> tuple[str, ...]:
        """Names of all frames: links, joints, locked and fixed joints."""
        return tuple(frame.name for frame in self.model.frames)

    @cached_property
    def units(self) -> tuple[str, ...]:
        """``"rad"`` or ``"m"``: units of the entries of v times seconds, and of the positions of joints."""
        return units_of(self.model, self.root)

    @cached_property
    def position_units(self) -> tuple[str, ...]:
        """Unit of each entry of q, ``"rad"`` or ``"m"``; empty for a quaternion's."""
        about = root_of(self.root)
        return (*about.position_units, *self.units[len(about.units) :])

    @cached_property
    def actuation(self) -> Array:
        """Selection matrix B, nv x nu: B tau are the joint torques of the motors' torques tau."""
        selection = np.zeros((self.nv, self.nu))
        for column, joint in enumerate(self.actuated):
            selection[self.velocity_names.index(joint), column] = 1.0
        selection.setflags(write=False)
        return selection

    @cached_property
    def visual_model(self) -> pin.GeometryModel:
        """Visual shapes, read on first use; missing and unreadable meshes are skipped with a warning."""
        return self.geometry.build(self.model, pin.GeometryType.VISUAL)

    @cached_property
    def collision_model(self) -> pin.GeometryModel:
        """Collision shapes, read on first use as those of ``visual_model``."""
        return self.geometry.build(self.model, pin.GeometryType.COLLISION)

    def frame(self, name: str) -> int:
        """Id of a frame in the model.

        Raises
        ------
        UnknownName
            There is no frame of that name (Pinocchio's ``getFrameId`` would return the number of frames).
        """
        if not isinstance(name, str) or not self.model.existFrame(name):
            raise unknown_name("frame", name, self.frame_names, f"print(robot.frame_names) lists those of {self.name}.")
        return self.frame_names.index(name)

    def joint(self, name: str) -> int:
        """Index into v and a of a moving joint, or of one of the root's velocities.

        Without a floating root it is the index into q as well.

        Raises
        ------
        UnknownName
            There is no moving joint of that name.
        """
        if name not in self.velocity_names:
            raise unknown_name("moving joint", name, self.velocity_names)
        return self.velocity_names.index(name)

    def configuration(self, value: npt.ArrayLike | Mapping[str, float], what: str = "q") -> Array:
        """Coerce to an (nq,) float array: from a list, (n, 1), float32, a number for all, or a dict by name.

        Entries missing in a dict are neutral. The quaternion of a floating root must have length 1.

        Raises
        ------
        InputError
            A value is not finite, the size is wrong, a name is unknown, or a quaternion has another length. ``what``
            is the label of the value in the message.
        """
        q = as_vector(value, self.position_names, what, self.neutral)
        if self.root == "floating":
            q[QUATERNION] = unit_quaternion(q[QUATERNION], what)
        return q

    def velocity(self, value: npt.ArrayLike | Mapping[str, float], what: str = "v") -> Array:
        """Coerce to an (nv,) float array, as ``configuration`` does; entries missing in a dict are 0.

        Raises
        ------
        InputError
            A value is not finite, the size is wrong, or a name is unknown.
        """
        return as_vector(value, self.velocity_names, what, np.zeros(self.nv))

    def dissipation(self, v: npt.ArrayLike) -> Array:
        """Return the torque of damping and smoothed Coulomb friction (nv,) [N m, N].

        d(v) = damping v + friction tanh(v / friction_speed), subtracted from B tau.
        """
        speed = np.asarray(v, dtype=float)
        return self.damping * speed + self.friction * np.tanh(speed / self.friction_speed)

    @cached_property
    def stiffness(self) -> Array:
        """Stiffness of the joints' springs (nv,) [N m/rad, N/m]; 0 where there is none."""
        return self._of_springs(1)

    @cached_property
    def _rest(self) -> Array:
        return self._of_springs(2)

    def _of_springs(self, entry: int) -> Array:
        values = np.zeros(self.nv)
        for spring in self.springs:
            values[self.velocity_names.index(spring[0])] = spring[entry]
        values.setflags(write=False)
        return values

    def resistance(self, q: npt.ArrayLike, v: npt.ArrayLike) -> Array:
        """Return the torque of springs, damping and friction (nv,) [N m, N], subtracted from B tau.

        K (q - rest) + d(v), with ``dissipation`` d.
        """
        if not self.springs:
            return self.dissipation(v)
        return self._stretched(q) + self.dissipation(v)

    def spring_energy(self, q: npt.ArrayLike) -> float:
        """Return the energy of the springs, (q - rest)' K (q - rest) / 2 [J]."""
        if not self.springs:
            return 0.0
        places = np.asarray(q, dtype=float)[self.nq - self.nv :] - self._rest
        return float(0.5 * self.stiffness @ places**2)

    def _stretched(self, q: npt.ArrayLike) -> Array:
        # A floating root has one position more than velocities; all other joints have one of each.
        return self.stiffness * (np.asarray(q, dtype=float)[self.nq - self.nv :] - self._rest)
