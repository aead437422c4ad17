"""Arguments of ``Phase``: their types by name, and checks of their kinds."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import TypedDict, TypeVar

from robotraj._util.errors import InputError, warn
from robotraj._util.printing import brief
from robotraj._util.values import own
from robotraj.dynamics.contacts.base import BoundContact, Contact
from robotraj.dynamics.design.quantity import Quantity
from robotraj.dynamics.kinematics import Kinematics
from robotraj.dynamics.obstacles.base import Obstacle
from robotraj.dynamics.rigid_body_forms import ForwardDynamics, InverseDynamics
from robotraj.dynamics.system import System
from robotraj.problem.constraints.base import Constraint
from robotraj.problem.constraints.bounds import Between, Interval
from robotraj.problem.objectives.base import Integral, Objective
from robotraj.problem.objectives.expressions import Lagrange
from robotraj.problem.state import State
from robotraj.robot.limits import Limits
from robotraj.robot.robot import Robot

T = TypeVar("T")


class PhaseChanges(TypedDict, total=False):
    """Fields of ``rt.Phase``, any of them, as ``Phase.with_`` takes them."""

    subject: Robot | System
    duration: float | Sequence[float] | Between
    start: State | None
    end: State | None
    objective: Objective | None
    constraints: Sequence[Constraint]
    contacts: Sequence[Contact]
    parameters: Mapping[str, Interval]
    design: Mapping[str, Quantity | Sequence[Quantity]]
    states: Mapping[str, Interval]
    controls: Mapping[str, Interval]
    algebraic: Mapping[str, Interval]
    limits: Limits | None
    dynamics: InverseDynamics | ForwardDynamics | Kinematics
    name: str
    self_collision: bool


def check_kinds(phase: str, subject: object, start: object, end: object, objective: object, dynamics: object) -> None:
    """Check the subject, both ends, the objective and the form of the dynamics of a phase.

    Raises
    ------
    InputError
        The subject is neither a robot nor a System, an end is no State, or the objective is no objective.
        The dynamics are no form of a robot's equations of motion.

    Warns
    -----
    UserWarning
        An integral such as the effort has a negative weight.
    """
    if not isinstance(subject, Robot | System):
        robot = f"rt.load({subject!r})" if isinstance(subject, str) else "robot"
        raise InputError(
            f"A phase moves a robot of rt.load(...) or an rt.System; got {type(subject).__name__} {brief(subject)}. "
            f"Write rt.Phase({robot}, duration, ...)."
        )
    for which, given in (("start", start), ("end", end)):
        if not isinstance(given, State | None):
            raise InputError(
                f"The {which} of phase {phase!r} must be an rt.State or None, such as rt.State(q=..., v=0); "
                f"got {given!r}."
            )
    if objective is not None and not isinstance(objective, Objective):
        advice = ""
        if isinstance(objective, list | tuple):
            advice = " Add its terms with +."
        elif isinstance(objective, type):
            advice = f" Call it: rt.{objective.__name__}()."
        elif callable(objective):
            advice = " Give a function to rt.Lagrange or rt.Mayer."
        raise InputError(
            f"The objective of phase {phase!r} must be an objective such as rt.Effort(); got {objective!r}.{advice}"
        )
    if isinstance(dynamics, type) or not callable(getattr(dynamics, "of", None)):
        raise InputError(
            f"dynamics= of phase {phase!r} is {dynamics!r}; give a form of the equations of motion, such as "
            "rt.dynamics.ForwardDynamics(). Forces on the robot go into contacts=."
        )
    for weight, term in objective.terms if objective is not None else ():
        if weight < 0.0 and isinstance(term, Integral) and not isinstance(term, Lagrange):
            warn(
                f"Phase {phase!r}: the weight {weight:g} of {term} is negative, so the motion with the most is sought."
            )


def as_mapping(phase: str, which: str, given: object) -> object:
    """Return a copy of a mapping by name.

    Raises
    ------
    InputError
        The field ``which`` of the phase is no mapping.
    """
    if not isinstance(given, Mapping):
        raise InputError(
            f"{which}= of phase {phase!r} must be a mapping by name, {{}} for none; got {type(given).__name__}."
        )
    return own(given)


def as_constraints(phase: str, given: object) -> tuple[Constraint, ...]:
    """Return one constraint or several as a tuple.

    Raises
    ------
    InputError
        The value is neither a list nor a constraint, or an entry is no constraint.
    """
    every = _several(phase, "constraints", given, Constraint)
    for constraint in every:
        entry: object = constraint
        if not isinstance(entry, Constraint):
            advice = " rt.CollisionFree([...]) keeps the robot off obstacles." if isinstance(entry, Obstacle) else ""
            advice = " It is minimised: objective= takes it." if isinstance(entry, Objective) else advice
            raise InputError(
                f"{entry!r} in the constraints of phase {phase!r} is not a constraint such as "
                f"rt.PathConstraint(...).{advice}"
            )
    return every


def as_contacts(phase: str, given: object) -> tuple[Contact, ...]:
    """Return one contact or several as a tuple; ``Phase.bound_contacts`` refuses entries that are no contacts.

    Raises
    ------
    InputError
        The value is neither a list nor a contact.
    """
    return _several(phase, "contacts", given, Contact)


def bind_contacts(phase: str, contacts: Sequence[Contact], robot: Robot | None) -> tuple[BoundContact, ...]:
    """Bind the contacts of a phase to its robot.

    Raises
    ------
    InputError
        The phase moves a System, an entry is no contact, or two contacts have one name.
    """
    if not contacts:
        return ()
    if robot is None:
        raise InputError(f"Phase {phase!r} has contacts, which are for robots, but moves an rt.System; remove them.")
    for contact in contacts:
        if not isinstance(contact, Contact):
            raise InputError(
                f"{contact!r} in the contacts of phase {phase!r} is not a contact such as rt.PointContact('foot')."
            )
    bound = tuple(contact.bound_to(robot) for contact in contacts)
    twice = [name for name, count in Counter(contact.name for contact in bound).items() if count > 1]
    if twice:
        raise InputError(f"Phase {phase!r} has two contacts named {twice[0]!r}; give one of them name=.")
    return bound


def _several(phase: str, which: str, given: object, kind: type[T]) -> tuple[T, ...]:
    # Lists first: the first isinstance check of a type against an abstract class is slow.
    if isinstance(given, tuple | list):
        return tuple(given)
    if isinstance(given, kind):
        return (given,)
    if not isinstance(given, Iterable):
        raise InputError(
            f"{which}= of phase {phase!r} must be a list of {which}, [] for none; got {type(given).__name__}."
        )
    return tuple(given)
