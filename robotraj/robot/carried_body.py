"""A rigid body that a robot carries at a frame: mass, centre of mass and inertia."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pinocchio as pin

from robotraj._util.checks import is_number
from robotraj._util.errors import InputError, warn
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass, own_fields
from robotraj.robot.loading.other_units import in_other_unit
from robotraj.robot.robot import Robot
from robotraj.robot.size.reach import reach

FAR, HEAVY = 2.0, 5.0
"""Distance and mass of a body, relative to the reach and the mass of its robot, above which the unit is doubtful."""


@dataclass(frozen=True)
class CarriedBody(OneLine):
    """A body fixed to a frame of a robot, for ``rt.robot.carrying`` and ``rt.constraints.PayloadScenarios``.

    Parameters
    ----------
    frame : str
        Frame of the robot.
    mass : float
        Mass [kg], above 0.
    center_of_mass : sequence of 3 float
        Centre of mass in the axes of the frame [m].
    inertia : array (3, 3) or (3,), optional
        Rotational inertia about the centre of mass, in the axes of the frame, or its diagonal [kg m^2]. Zero by
        default.

    Raises
    ------
    InputError
        The mass is not positive, or a value is not finite or has another shape.
    """

    frame: str
    mass: float
    center_of_mass: Sequence[float] = (0.0, 0.0, 0.0)
    inertia: Sequence[float] | Sequence[Sequence[float]] | None = None

    def __post_init__(self) -> None:
        own_fields(self)
        if not (is_number(self.mass) and 0.0 < self.mass < np.inf):
            raise InputError(
                f"The body at {self.frame!r} has the mass {self.mass!r} kg; it must be finite and above 0."
            )
        if not _is_finite(self.center_of_mass, (3,)):
            raise InputError(
                f"The body at {self.frame!r} needs a centre of mass of 3 numbers; got {self.center_of_mass!r}."
            )
        if self.inertia is not None and not _is_finite(self.inertia, (3,), (3, 3)):
            raise InputError(
                f"The inertia of the body at {self.frame!r} is {self.inertia!r}; give finite numbers of shape (3,) or "
                "(3, 3) [kg m^2]."
            )

    @property
    def spatial_inertia(self) -> pin.Inertia:
        """Inertia in the axes of the frame.

        Raises
        ------
        InputError
            No rigid body has this inertia.
        """
        given = np.zeros(3) if self.inertia is None else np.array(self.inertia, dtype=float)
        matrix = np.diag(given) if given.ndim == 1 else given
        low, middle, high = np.linalg.eigvalsh(0.5 * (matrix + matrix.T))
        rounding = 1e-9 * max(1.0, high)
        if not np.allclose(matrix, matrix.T) or low < -rounding or high > low + middle + rounding:
            raise InputError(
                f"The body at {self.frame!r} has the impossible inertia {matrix.tolist()} kg m^2. Its principal "
                "moments must not be negative, and none may exceed the sum of the others."
            )
        return pin.Inertia(float(self.mass), np.array(self.center_of_mass, dtype=float), matrix)


def _is_finite(given: object, *shapes: tuple[int, ...]) -> bool:
    """Whether a value holds finite numbers in one of some shapes."""
    try:
        array = np.array(given, dtype=float)
    except (TypeError, ValueError):
        return False
    return array.shape in shapes and bool(np.isfinite(array).all())


def carrying(robot: Robot, *bodies: CarriedBody) -> Robot:
    """Return a robot that carries bodies; joints, states and limits are the same.

    To grasp or release a body, link a phase of the robot without it and a phase of the robot with it by
    ``rt.Continuity``.

    Raises
    ------
    InputError
        A frame does not exist or does not move, or an inertia is impossible.
    """
    model = robot.model.copy()
    for body in bodies:
        if not isinstance(body, CarriedBody):
            raise InputError(f"{robot.name!r} carries rt.robot.CarriedBody(frame, mass) values; got {body!r}.")
        frame = model.frames[robot.frame(body.frame)]
        if frame.parentJoint == 0:
            raise InputError(
                f"Frame {body.frame!r} of {robot.name!r} does not move, so it carries nothing; name a moving frame."
            )
        _warn_of_units(robot, body)
        model.appendBodyToJoint(frame.parentJoint, body.spatial_inertia, frame.placement)
    return replace(robot, model=model)


def _warn_of_units(robot: Robot, body: CarriedBody) -> None:
    """Warn of a body that is far heavier or farther away than the robot could carry.

    Warns
    -----
    UserWarning
    """
    far, away = reach(robot.model), float(np.linalg.norm(body.center_of_mass))
    if 0.0 < FAR * far < away:
        warn(
            f"The centre of mass of the body at {body.frame!r} is {away:g} m from this frame, and {robot.name!r} "
            f"reaches {far:.2g} m. {in_other_unit(away, 'm')}"
        )
    if 0.0 < HEAVY * robot.mass < body.mass:
        warn(
            f"The body at {body.frame!r} weighs {body.mass:g} kg, and {robot.name!r} {robot.mass:.3g} kg. "
            f"{in_other_unit(body.mass, 'kg')}"
        )
