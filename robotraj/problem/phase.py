"""Phases: frozen values with checks and with a printed table of all rows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, fields, replace
from functools import reduce
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.errors import FailedExpression, InputError, unknown_name, warn
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine, plain
from robotraj._util.values import dataclass, own
from robotraj.dynamics.contacts.base import BoundContact, Contact
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.path_body import PathBody
from robotraj.dynamics.rigid_body_forms import ForwardDynamics, InverseDynamics
from robotraj.dynamics.row import Row
from robotraj.dynamics.system import System, SystemDynamics
from robotraj.problem.augmentation import free_of, with_fixed
from robotraj.problem.constraints.base import BoundConstraint, Constraint, Where
from robotraj.problem.constraints.bounds import Between, Bounds, Interval, as_bounds, as_duration
from robotraj.problem.constraints.contact_limits import contact_limits
from robotraj.problem.constraints.joint_limits import OwnLimits
from robotraj.problem.constraints.motors.end_accelerations import end_accelerations
from robotraj.problem.constraints.motors.own_limits import own_limits
from robotraj.problem.constraints.variable_bounds import VariableBounds
from robotraj.problem.feasibility import Ends, check_equations, check_limits, check_masses, check_rows
from robotraj.problem.footing_checks import check_contacts
from robotraj.problem.objectives.base import EndCost, Integral, Objective
from robotraj.problem.phase_fields import as_constraints, as_contacts, as_mapping, bind_contacts, check_kinds
from robotraj.problem.printing import PhaseTable, duration_text, parameter_rows, phase_table
from robotraj.problem.rows import RowTable
from robotraj.problem.state import State, far_turns, near_turns
from robotraj.problem.travel.least_durations import check_durations
from robotraj.problem.travel.tool_travel import check_tool_travel
from robotraj.robot.limits import Limits
from robotraj.robot.loading.geometry import NoGeometry
from robotraj.robot.robot import Robot

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from robotraj.dynamics.design.binding import Design
    from robotraj.dynamics.design.quantity import Quantity
    from robotraj.dynamics.kinematics import Kinematics
    from robotraj.problem.phase_fields import PhaseChanges


@dataclass(frozen=True, eq=False)
class Phase(OneLine):
    """A part of a motion with one set of dynamics and constraints.

    Arrays, lists and mappings are copied, so later changes to them have no effect.

    Parameters
    ----------
    subject : Robot or System
        The robot or system that moves.
    duration : float, (float, float) or Between
        Fixed or bounded duration [s].
    start, end : State, optional
        The state at both ends; None leaves it free.
    objective : Objective, optional
        The function to minimise; with None, any feasible motion is a solution.
    constraints : sequence of Constraint
        Imposed at every collocation point, or at one end with ``AtStart`` and ``AtEnd``.
    contacts : sequence of Contact
        Contacts of the robot during the whole phase, ``rt.PointContact("foot")``. A foothold is a parameter of the
        phase such as ``"foot.x"`` [m], an unknown by default.
    parameters : mapping of str to number, Between or None
        Unknown or fixed constants, ``point.p[name]``. Footholds may be fixed or bounded here.
    design : mapping of str to Quantity or sequence of Quantity
        Parameters that set physical quantities of the robot: ``{"m": rt.design.BodyMass("forearm")}``.
    states, controls, algebraic : mapping of str to number, Between or None
        Bounds by variable name, throughout the phase.
    limits : Limits or None
        Joint limits; those of the robot by default, None for none.
    dynamics : InverseDynamics, ForwardDynamics or Kinematics
        Form of a robot's equations of motion. Inverse and forward dynamics have the same solutions.
    name : str
        Name for messages, reports and plots.
    self_collision : bool
        Whether the robot's links must not overlap, by their exact shapes; ``rt.CollisionFree`` keeps a margin.
        With False, ``rt.validate`` does not judge it either.

    Raises
    ------
    InputError
        An end violates a limit, bounds are crossed, the duration is too short, a number is NaN or a name unknown.
    """

    subject: Robot | System
    duration: float | Sequence[float] | Between
    start: State | None = None
    end: State | None = None
    objective: Objective | None = None
    constraints: Sequence[Constraint] = ()
    contacts: Sequence[Contact] = ()
    parameters: Mapping[str, Interval] = field(default_factory=dict)
    design: Mapping[str, Quantity | Sequence[Quantity]] = field(default_factory=dict)
    states: Mapping[str, Interval] = field(default_factory=dict)
    controls: Mapping[str, Interval] = field(default_factory=dict)
    algebraic: Mapping[str, Interval] = field(default_factory=dict)
    limits: Limits | OwnLimits | None = field(default_factory=OwnLimits)
    dynamics: InverseDynamics | ForwardDynamics | Kinematics = field(default_factory=InverseDynamics)
    name: str = "phase"
    self_collision: bool = True

    def __post_init__(self) -> None:
        check_kinds(self.name, self.subject, self.start, self.end, self.objective, self.dynamics)
        object.__setattr__(self, "duration", own(self.duration))
        for which in ("parameters", "design", "states", "controls", "algebraic"):
            object.__setattr__(self, which, as_mapping(self.name, which, getattr(self, which)))
        if not isinstance(self.self_collision, bool):
            raise InputError(f"self_collision= of phase {self.name!r} is {self.self_collision!r}; give True or False.")
        object.__setattr__(self, "constraints", as_constraints(self.name, self.constraints))
        object.__setattr__(self, "contacts", as_contacts(self.name, self.contacts))
        if isinstance(self.limits, OwnLimits):
            object.__setattr__(self, "limits", self.robot.limits if self.robot else None)
        if self.limits is not None and (self.robot is None or not isinstance(self.limits, Limits)):
            raise InputError(
                f"limits= of phase {self.name!r} must be None or Limits of the robot, such as "
                f"robot.limits.with_(velocity=2.0); Systems use states= and controls=."
            )
        if self.robot is not None:
            limits, (start, end) = self.limits, (self.start, self.end)
            object.__setattr__(self, "start", near_turns(start, end, self.robot, limits, "start"))
            object.__setattr__(self, "end", near_turns(end, start, self.robot, limits, "end"))
        if self.bound_design is not None:
            self.bound_design.check(self.parameter_names, self.parameter_bounds.lower)
        try:
            for _, term in self.objective.terms if self.objective else ():
                term.check(free_of(self.body), self.parameter_names)
            self._check()
        except FailedExpression as error:
            raise FailedExpression(f"Phase {self.name!r}: {error}") from error.__cause__

    def _check(self) -> None:
        """Raise an InputError if rows, ends, contacts and duration contradict each other."""
        if isinstance(self.limits, Limits) and self.robot is not None:
            check_limits(self.name, self.limits, self.robot)
        known, durations = self.parameter_bounds, self.duration_bounds
        if self.system is not None:
            check_equations(self.rows, self.system)
        check_rows(self.rows, self._ends, self.constraints)
        if self.robot is None:
            return
        ends = self.joint_ends
        far = far_turns(ends, self.robot, self.limits) if self.path is None else ""  # type: ignore[arg-type]  # resolved
        if far:
            warn(f"Phase {self.name!r}: {far}")
        if any(each.avoids_collisions for each in self.constraints):
            from robotraj.problem.clearance.end_checks import check_ends, check_path

            check_ends(self.name, self.constraints, self.robot, ends)
            if self.path is not None:
                check_path(self.name, self.constraints, self.robot, self.path.curve)
        if self.bound_design is None:
            check_masses(self.name, self.robot, self.body, ends)
            check_contacts(self.rows, self.robot, self.bound_contacts, known, ends, durations)
        check_durations(self.rows, self.robot, self.limits, durations, ends)  # type: ignore[arg-type]  # resolved
        check_tool_travel(self.rows, self.robot, self.constraints, durations, ends)

    @property
    def robot(self) -> Robot | None:
        """The robot that moves, or None for a System."""
        return self.subject if isinstance(self.subject, Robot) else None

    @property
    def system(self) -> System | None:
        """The System that moves, or None for a robot."""
        return self.subject if isinstance(self.subject, System) else None

    @property
    def path(self) -> PathBody | None:
        """The robot's dynamics along the path of ``rt.constraints.FollowPath``, or None without one."""
        return self.body if isinstance(self.body, PathBody) else None

    @property
    def state_robot(self) -> Robot | None:
        """The robot whose positions and velocities are the first states; None for a System and on a path."""
        return self.robot if self.path is None else None

    @cached_property
    def bound_design(self) -> Design | None:
        """The design bound to the robot; None without one."""
        if not self.design:
            return None
        if self.robot is None:
            raise InputError(
                f"Phase {self.name!r} has a design, which is for robots, but moves an rt.System; "
                "read the parameter in its equations as point.p[name]."
            )
        from robotraj.dynamics.design.binding import Design

        return Design(self.robot, self.design)

    @cached_property
    def bound_contacts(self) -> tuple[BoundContact, ...]:
        """The contacts bound to the robot."""
        return bind_contacts(self.name, self.contacts, self.robot)

    @cached_property
    def body(self) -> Dynamics:
        """The dynamics as a semi-explicit DAE, without variables that the objective adds."""
        if isinstance(self.subject, System):
            _ = self.bound_contacts
            return SystemDynamics(self.subject)
        body: Dynamics = self.dynamics.of(self.subject, self.bound_design, self.bound_contacts)
        return reduce(lambda known, each: each.reduce(known), self.constraints, body)

    @cached_property
    def dae(self) -> Dynamics:
        """The phase's dynamics as a semi-explicit DAE, variables of the objective and the constraints included."""
        terms = [term for _, term in self.objective.terms] if self.objective is not None else []
        return reduce(lambda known, each: each.augment(known), (*terms, *self._imposed), self.body)

    @cached_property
    def parameter_names(self) -> tuple[str, ...]:
        """Names of the parameters, in order: those given, then the footholds of the contacts."""
        footholds = [anchor.name for contact in self.bound_contacts for anchor in contact.anchors]
        return tuple(dict.fromkeys((*self.parameters, *footholds)))

    @cached_property
    def parameter_bounds(self) -> Bounds:
        """Bounds of the parameters; footholds that are not named are free."""
        return as_bounds(dict(self.parameters), self.parameter_names, "parameters", "parameter")

    @cached_property
    def duration_bounds(self) -> tuple[float, float]:
        """Least and greatest duration [s]."""
        return as_duration(self.duration, self.name)

    @cached_property
    def start_bounds(self) -> Bounds:
        """Bounds on the first state, (nx,) each."""
        return with_fixed(self.dae, (self.start or State()).bounds(self.dae, "start"), "start")

    @cached_property
    def end_bounds(self) -> Bounds:
        """Bounds on the last state, (nx,) each."""
        return with_fixed(self.dae, (self.end or State()).bounds(self.dae, "end"), "end")

    @property
    def _ends(self) -> Ends:
        return {Where.START: self.start_bounds, Where.END: self.end_bounds}

    @property
    def joint_ends(self) -> Ends:
        """Bounds on the state of a robot at both ends, (q, v) first; on a path those that it determines."""
        if self.path is None:
            return self._ends
        return {where: Bounds(*self.path.joint_ends(where is Where.END)) for where in (Where.START, Where.END)}

    @cached_property
    def _imposed(self) -> tuple[Constraint, ...]:
        """Constraints of the limits and of bounds of variables, then those given."""
        every: list[Constraint] = []
        if self.robot is not None and isinstance(self.limits, Limits):
            every += own_limits(self.limits, self.robot.actuated)
        variables = (("state", self.states), ("control", self.controls), ("algebraic variable", self.algebraic))
        every += [VariableBounds(kind, mapping) for kind, mapping in variables if mapping]
        return (*every, *self.constraints)

    @cached_property
    def _at_ends(self) -> tuple[Constraint, ...]:
        """Constraints on accelerations at the ends."""
        pairs = ((Where.START, self.start, self.start_bounds), (Where.END, self.end, self.end_bounds))
        given = [(where, state.a if state is not None else None, bounds) for where, state, bounds in pairs]
        return end_accelerations(self.body, self._imposed, given)

    @cached_property
    def bound_constraints(self) -> tuple[BoundConstraint, ...]:
        """Every constraint bound to the dynamics: limits, bounds of variables, those given, those of the objective."""
        every = (*self._imposed, *self._at_ends)
        bound = [replace(each.bind(self.body, self.parameter_names), source=each) for each in every]
        bound += [limits for contact in self.bound_contacts for limits in contact_limits(contact)]
        terms = self.objective.terms if self.objective is not None else ()
        # Two terms may define the same slacks.
        needed = {b.name: b for _, term in terms for b in term.definitions(self.dae)}
        return tuple(b for b in (*bound, *needed.values()) if b.rows)

    @cached_property
    def rows(self) -> RowTable:
        """Every row that the constraints impose, with its kind, bounds, unit and expression."""
        return RowTable(self.name, self.body, self.dae, self.parameter_names, self.bound_constraints)

    @property
    def integrals(self) -> tuple[tuple[float, Integral], ...]:
        """Weights and Lagrange terms of the objective."""
        terms = self.objective.terms if self.objective is not None else ()
        return tuple((weight, term) for weight, term in terms if isinstance(term, Integral))

    @property
    def end_costs(self) -> tuple[tuple[float, EndCost], ...]:
        """Weights and Mayer terms of the objective."""
        terms = self.objective.terms if self.objective is not None else ()
        return tuple((weight, term) for weight, term in terms if isinstance(term, EndCost))

    def with_(self, **changes: Unpack[PhaseChanges]) -> Phase:
        """Return the phase with other fields, ``phase.with_(end=rt.State(q=...))``.

        If only the ends and values of fixed parameters change, both phases share the equations and the table of rows.

        Raises
        ------
        InputError
            An unknown field, or a value that ``Phase`` refuses.
        """
        unknown = set(changes) - {entry.name for entry in fields(self)}
        if unknown:
            raise unknown_name("field of a phase", sorted(unknown)[0], [entry.name for entry in fields(self)])
        changed = replace(self, **changes)
        numbers = {"start", "end"} if self.design else {"start", "end", "parameters"}
        same_names = changed.parameter_names == self.parameter_names
        alike = changed.parameter_bounds.alike(self.parameter_bounds) and changed._at_ends == self._at_ends
        if set(changes) <= numbers and same_names and alike:
            own = {entry.name for entry in fields(self)} | {"start_bounds", "end_bounds", "parameter_bounds"}
            changed.__dict__.update({name: value for name, value in self.__dict__.items() if name not in own})
        return changed

    @property
    def _table(self) -> PhaseTable:
        objective = str(self.objective or "none: any feasible motion")
        more = parameter_rows(self.parameter_names, self.parameter_bounds, self.bound_design)
        if any(each.avoids_collisions for each in self.constraints):
            from robotraj.problem.clearance.end_checks import clearance_summary

            more += clearance_summary(self.constraints, self.robot)
        if self.robot is not None and not isinstance(self.robot.geometry, NoGeometry):
            more.append(Row("clearance", "m", 0.0 if self.self_collision else -np.inf, np.inf, "own links"))
        return phase_table(self.rows, self.subject.name, objective, self.duration_bounds, self._ends, more)

    def __repr__(self) -> str:
        duration, count = duration_text(*self.duration_bounds), len(self.rows.rows)
        return f"<Phase {self.name!r} of {self.subject.name}: {duration}, {count} constraint{'s' * (count != 1)}>"

    @property
    def grouped(self) -> str:
        """The text of ``print(phase)`` in which rows of one quantity, time and bounds share a line."""
        return self._table.grouped

    def __str__(self) -> str:
        return plain(str(self._table))

    def _repr_html_(self) -> str:
        return self._table.html
