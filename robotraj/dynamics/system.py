"""Any ODE or semi-explicit DAE written with CasADi."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field
from typing import NoReturn, TypeAlias

import casadi as ca

from robotraj._util.checks import names
from robotraj._util.errors import InputError, unknown_name
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.expression_values import rows_of
from robotraj.dynamics.point import Point
from robotraj.dynamics.variable import Column, Named, Scalar, Variable

Expression: TypeAlias = "Callable[[Point], Column | Sequence[Scalar] | Scalar]"
"""A function of a point."""


@dataclass(frozen=True, init=False)
class System(OneLine):
    """A system given by its equations: xdot = f, 0 = g.

    Parameters
    ----------
    states, controls, algebraic : sequence of str
        Names of the scalars; ``point.x[name]``, ``point.u[name]``, ``point.z[name]`` read them.
    dynamics : callable
        ``dynamics(point)`` returns the rates of the states, in their order.
    residual : callable, optional
        ``residual(point)`` returns one row per algebraic variable, g = 0. The rows must be solvable for z (index 1).
    units : mapping of str to str, optional
        SI units by name, for reports and plots.
    name : str
        Name for messages and printing.

    Raises
    ------
    InputError
        A name repeats, an argument is of a wrong type, or algebraic variables come without a residual.

    Examples
    --------
    >>> block = System(states=["x", "v"], controls=["u"], dynamics=lambda point: [point.x["v"], point.u["u"]])
    """

    states: tuple[Variable, ...]
    controls: tuple[Variable, ...]
    algebraic: tuple[Variable, ...]
    dynamics: Expression = field(repr=False)
    residual: Expression | None = field(repr=False)
    name: str

    def __init__(
        self,
        states: Sequence[str],
        controls: Sequence[str] = (),
        dynamics: Expression | None = None,
        *,
        algebraic: Sequence[str] = (),
        residual: Expression | None = None,
        units: Mapping[str, str] | None = None,
        name: str = "system",
    ) -> None:
        if dynamics is None:
            raise InputError(f"System {name!r} needs dynamics=: a function of a point that returns the state rates.")
        if not isinstance(name, str):
            raise InputError(f"System(name) is a string, got {name!r}.")
        for function, given in (("dynamics", dynamics), ("residual", residual)):
            if given is not None and not callable(given):
                raise InputError(f"System {name!r}: {function} is a function of a point, got {given!r}.")
        states, controls, algebraic = (
            names(f"System {name!r}: {kind}", given)
            for kind, given in (("states", states), ("controls", controls), ("algebraic", algebraic))
        )
        if units is not None and not isinstance(units, Mapping):
            raise InputError(f'System {name!r}: units is a mapping, such as {{"x": "m"}}; got {units!r}.')
        every = [*states, *controls, *algebraic]
        if not states:
            raise InputError(f"System {name!r} has no states; name at least one in states=.")
        twice = [n for n, count in Counter(every).items() if count > 1]
        if twice:
            raise InputError(f"System {name!r}: the name {twice[0]!r} is used twice; give every variable its own name.")
        if bool(algebraic) != (residual is not None):
            raise InputError(
                f"System {name!r} has {len(algebraic)} algebraic variables, and residual= is "
                f"{'given' if residual else 'missing'}; give both or neither."
            )
        units = dict(units or {})
        for key in units:
            if key not in every:
                raise unknown_name("variable", key, every, "units= names states, controls and algebraic variables.")

        def make(named: Sequence[str], quantity: str) -> tuple[Variable, ...]:
            return tuple(Variable(n, units.get(n, ""), quantity) for n in named)

        object.__setattr__(self, "states", make(states, "state"))
        object.__setattr__(self, "controls", make(controls, "control"))
        object.__setattr__(self, "algebraic", make(algebraic, "algebraic variable"))
        object.__setattr__(self, "dynamics", dynamics)
        object.__setattr__(self, "residual", residual)
        object.__setattr__(self, "name", name)


@dataclass(frozen=True)
class SystemDynamics(OneLine):
    """A System with the DAE protocol."""

    system: System

    @property
    def states(self) -> tuple[Variable, ...]:
        """The entries of x."""
        return self.system.states

    @property
    def algebraic(self) -> tuple[Variable, ...]:
        """The entries of z."""
        return self.system.algebraic

    @property
    def controls(self) -> tuple[Variable, ...]:
        """The entries of u."""
        return self.system.controls

    @property
    def residuals(self) -> tuple[Variable, ...]:
        """The rows of g, one per algebraic variable."""
        return tuple(Variable(f"residual {i}", "", "residual") for i in range(len(self.system.algebraic)))

    @property
    def invariants(self) -> tuple[Variable, ...]:
        """No invariants; a System has only its residual."""
        return ()

    def point(self, t: ca.SX, x: ca.SX, z: ca.SX | None, u: ca.SX | None, p: ca.SX, names: Sequence[str]) -> Point:
        """Wrap columns of symbols as a Point."""
        return Point(
            t,
            Named("state", [s.name for s in self.system.states], x),
            Named("algebraic variable", [s.name for s in self.system.algebraic] if z is not None else [], z),
            Named("control", [s.name for s in self.system.controls] if u is not None else [], u),
            Named("parameter", names, p),
        )

    def rates(self, point: Point) -> ca.SX:
        """Evaluate the state rates f."""
        system = self.system
        return _column(system.dynamics, point, len(system.states), f"dynamics of {system.name!r}", "state")

    def residual(self, point: Point) -> ca.SX:
        """Evaluate the algebraic rows g."""
        rows = self.system.residual
        if rows is None:
            return ca.SX(0, 1)
        count = len(self.system.algebraic)
        return _column(rows, point, count, f"residual of {self.system.name!r}", "algebraic variable")

    def invariant(self, point: Point) -> ca.SX:
        """No invariants."""
        return ca.SX(0, 1)

    def correction(self, point: Point, c: ca.SX) -> ca.SX:
        """Nothing to correct."""
        return ca.SX.zeros(len(self.states))


@dataclass(frozen=True)
class MissingEquations:
    """Placeholder for the equations of a System from a file, which stores no Python functions; a call raises an error.

    Attributes
    ----------
    system : str
        Name of the system.
    """

    system: str

    def __call__(self, point: Point) -> NoReturn:
        """Raise InputError."""
        raise InputError(
            f"The equations of system {self.system!r} are Python functions, which a file does not hold; "
            "load it with rt.load_solution(path, problem=...) to have them."
        )


def _column(function: Expression, point: Point, length: int, what: str, per: str) -> ca.SX:
    """Return the values of a user's function as an SX column of the given length; else raise InputError."""
    rows = rows_of(what, function, point)
    if len(rows) != length:
        raise InputError(f"The {what} returned {len(rows)} values; it must return {length}, one per {per}.")
    return ca.vertcat(*rows) if rows else ca.SX(0, 1)
