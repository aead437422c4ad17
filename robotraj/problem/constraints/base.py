"""The base class of constraints: named rows with units and bounds, and one expression of a Point.

Transcription evaluates the expression on symbols and the witness on numbers. Printing uses the rows.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import replace
from enum import Enum
from typing import ClassVar

import casadi as ca

from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass, own_fields
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import AnyPoint, Point
from robotraj.dynamics.rigid_body import RigidBody
from robotraj.dynamics.row import Row as Row
from robotraj.problem.scalars import Scalar
from robotraj.robot.robot import Robot


class Where(Enum):
    """When a constraint applies.

    AT_NODES is for rows that define variables added by an objective. They do not restrict the motion, and only the
    transcription imposes them. RATE is for rows that bound the time derivative of their variable at every time. Their
    expression reads it from ``point.extra["rate.<variable>"]``, which only points of the witness have.
    """

    THROUGHOUT = "throughout"
    INTEGRAL = "integral"
    AT_NODES = "collocation points"
    RATE = "time derivative"
    START = "start"
    END = "end"


@dataclass(frozen=True)
class BoundConstraint(OneLine):
    """A constraint bound to the dynamics of a phase, with checked names and a known number of rows.

    Attributes
    ----------
    name : str
    rows : tuple of Row
    expression : callable
        ``expression(point)`` gives len(rows) scalars, symbolic or numeric as the point is.
    where : Where
    source : Constraint or None
        The constraint of the phase; None for rows that contacts or objectives add.
    """

    name: str
    rows: tuple[Row, ...]
    expression: Callable[[AnyPoint], Sequence[Scalar]]
    where: Where = Where.THROUGHOUT
    source: Constraint | None = None


class Constraint(OneLine, ABC):
    """A value that bounds expressions of a Point along a phase. A new kind is one new class.

    Attributes
    ----------
    avoids_collisions : bool
        Whether it bounds distances of shapes, as ``rt.CollisionFree`` does, whose modules are imported only then.
    """

    avoids_collisions: ClassVar[bool] = False

    def __post_init__(self) -> None:
        """Keep copies of the arrays, lists and mappings that were given."""
        own_fields(self)

    @abstractmethod
    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Check names against the dynamics of a phase and return the rows.

        Raises
        ------
        InputError
            A name does not exist, or the bounds are invalid.
        """

    def reduce(self, dynamics: Dynamics) -> Dynamics:
        """Return the equations of motion in fewer variables, where the constraint determines the others."""
        return dynamics

    def augment(self, dynamics: Dynamics) -> Dynamics:
        """Add the variables that the rows need to the dynamics of the phase; most constraints need none.

        These are in ``point.extra`` (``robotraj.problem.augmentation``).
        """
        return dynamics

    def as_data(self, robot: Robot | None) -> Constraint:
        """Return a copy for storage that contains the data the constraint reads from other files."""
        return self


@dataclass(frozen=True)
class AtStart(Constraint):
    """Impose a constraint at the start of the phase only."""

    constraint: Constraint

    def __post_init__(self) -> None:
        _require_constraint(self.constraint, "AtStart")

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Bind the constraint, at the start alone."""
        return replace(self.constraint.bind(dynamics, parameters), where=Where.START)

    def augment(self, dynamics: Dynamics) -> Dynamics:
        """Add the variables of the constraint."""
        return self.constraint.augment(dynamics)

    def as_data(self, robot: Robot | None) -> Constraint:
        """Return the same end of what the constraint returns."""
        return AtStart(self.constraint.as_data(robot))


@dataclass(frozen=True)
class AtEnd(Constraint):
    """Impose a constraint at the end of the phase only."""

    constraint: Constraint

    def __post_init__(self) -> None:
        _require_constraint(self.constraint, "AtEnd")

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Bind the constraint, at the end alone."""
        return replace(self.constraint.bind(dynamics, parameters), where=Where.END)

    def augment(self, dynamics: Dynamics) -> Dynamics:
        """Add the variables of the constraint."""
        return self.constraint.augment(dynamics)

    def as_data(self, robot: Robot | None) -> Constraint:
        """Return the same end of what the constraint returns."""
        return AtEnd(self.constraint.as_data(robot))


def _require_constraint(value: object, what: str) -> None:
    if not isinstance(value, Constraint):
        raise InputError(f"{what} imposes a constraint such as rt.FramePosition(...) at one end; got {value!r}.")


def robot_of(dynamics: Dynamics, what: str) -> Robot:
    """Return the robot of the dynamics; raise an InputError that names ``what`` for a System."""
    if not isinstance(dynamics, RigidBody):
        raise InputError(
            f"{what} needs a robot, but the phase moves a System; use PathConstraint or the phase's states=."
        )
    return dynamics.robot


def symbols_of(dynamics: Dynamics, parameters: Sequence[str]) -> Point:
    """Fresh symbols for a point, to try an expression on."""

    def column(name: str, size: int) -> ca.SX:
        return ca.SX.sym(name, size)

    return dynamics.point(
        ca.SX.sym("t"),
        column("x", len(dynamics.states)),
        column("z", len(dynamics.algebraic)),
        column("u", len(dynamics.controls)),
        column("p", len(parameters)),
        parameters,
    )


def ends_of(dynamics: Dynamics, parameters: Sequence[str], inner: bool = False) -> tuple[Point, Point]:
    """Fresh symbols for the start and the end of a phase, to try an expression on.

    With ``inner`` the points have algebraic variables and controls, too.
    """
    p = ca.SX.sym("p", len(parameters))
    n = len(dynamics.states)

    def point(k: str) -> Point:
        z, u = (
            (ca.SX.sym(f"{name}{k}", len(variables)) if inner else None)
            for name, variables in (("z", dynamics.algebraic), ("u", dynamics.controls))
        )
        return dynamics.point(ca.SX.sym(f"t{k}"), ca.SX.sym(f"x{k}", n), z, u, p, parameters)

    return point("0"), point("1")
