"""The choice of a robot's equations of motion: the inverse or the forward form."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.checks import is_number
from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import BoundContact, refuse_contacts
from robotraj.dynamics.design.binding import Design
from robotraj.dynamics.rigid_body import ForwardRigidBody, InverseRigidBody
from robotraj.robot.robot import Robot


@dataclass(frozen=True)
class RigidBodyForm(OneLine):
    """Base class of the forms.

    Attributes
    ----------
    softening : float
        c of the dry friction (``robotraj.dynamics.motors_and_friction``); 0 for the robot's own.
    """

    softening: float = 0.0

    def __post_init__(self) -> None:
        if not (is_number(self.softening) and 0.0 <= float(self.softening) < np.inf):
            raise InputError(f"softening={self.softening!r} must be a number from 0.")


@dataclass(frozen=True)
class InverseDynamics(RigidBodyForm):
    """Choose RNEA with the accelerations as unknowns: the default, with fewer operations; it supports contacts.

    Parameters
    ----------
    softening : float
        c of the dry friction (``robotraj.dynamics.motors_and_friction``); 0 for the robot's own.
    averaging : float
        e, half the time over which soft friction is averaged [s].

    Raises
    ------
    InputError
        ``softening`` or ``averaging`` is negative or not finite.
    """

    averaging: float = 0.0

    def __post_init__(self) -> None:
        RigidBodyForm.__post_init__(self)
        if not (is_number(self.averaging) and 0.0 <= float(self.averaging) < np.inf):
            raise InputError(f"averaging={self.averaging!r} must be a time from 0.")

    def of(self, robot: Robot, design: Design | None = None, contacts: Sequence[BoundContact] = ()) -> InverseRigidBody:
        """Bind to a robot."""
        return InverseRigidBody(robot, design, tuple(contacts), self.softening, self.averaging)


@dataclass(frozen=True)
class ForwardDynamics(RigidBodyForm):
    """Choose ABA: no algebraic unknowns, a denser and larger derivative.

    Parameters
    ----------
    softening : float
        c of the dry friction (``robotraj.dynamics.motors_and_friction``); 0 for the robot's own.

    Raises
    ------
    InputError
        ``softening`` is negative or not finite.
    """

    def of(self, robot: Robot, design: Design | None = None, contacts: Sequence[BoundContact] = ()) -> ForwardRigidBody:
        """Bind to a robot.

        Raises
        ------
        InputError
            Contacts are given: their forces are algebraic variables, and this form has none.
        """
        refuse_contacts(contacts, "ForwardDynamics")
        return ForwardRigidBody(robot, design, softening=self.softening)
