"""Methods that enforce rows of states and controls between the collocation points.

A row is satisfied where it is imposed; between these points the polynomial may violate it. There are two methods:

- ``ConstraintGeneration`` imposes the row also where a solution violates it, and solves again;
- ``BernsteinBounds`` imposes it, from the start, on the Bernstein coefficients of the polynomial on every interval. A
  polynomial lies in the convex hull of these, so the row holds everywhere. The coefficients exceed the polynomial by an
  amount that decreases with the square of the interval's length, so the method is slightly conservative.

Source: Farouki, The Bernstein polynomial basis: a centennial retrospective, Computer Aided Geometric Design 29 (2012).
"""

from __future__ import annotations

from weakref import WeakKeyDictionary

import casadi as ca
import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.rigid_body import InverseRigidBody
from robotraj.dynamics.variable import Variable
from robotraj.problem.augmentation import inputs_of
from robotraj.problem.constraints.base import symbols_of
from robotraj.problem.phase import Phase


@dataclass(frozen=True)
class ConstraintGeneration(OneLine):
    """Impose rows where a solution violates them and solve again, until no violation exceeds the tolerance.

    Parameters
    ----------
    tolerance : float
        Violation of a row of the state between collocation points above which it is imposed there [its SI unit].
        For bounds below 1 SI unit, such as 0.05 rad/s, it is relative, and so for rows of a smaller size: it is then
        relative to half of the range, or to a few times what the motion changes the row by.
    rounds : int
        Largest number of further solves. With 0, violations are only reported.

    Raises
    ------
    InputError
        ``tolerance`` is not above 0, or ``rounds`` is no whole number of 0 or more.
    """

    tolerance: float = 5e-4
    rounds: int = 12

    def __post_init__(self) -> None:
        tolerance: object = self.tolerance
        rounds: object = self.rounds
        if not (isinstance(tolerance, float | int | np.floating | np.integer) and tolerance > 0):
            raise InputError(f"{type(self).__name__}(tolerance) must be above 0, got {self.tolerance!r}.")
        if not (isinstance(rounds, int | np.integer) and rounds >= 0):
            raise InputError(f"{type(self).__name__}(rounds) must be a whole number of 0 or more, got {self.rounds!r}.")

    def covers(self, phase: Phase) -> frozenset[str]:
        """Return the variables whose bounds are imposed on whole intervals: none."""
        return frozenset()


@dataclass(frozen=True)
class BernsteinBounds(ConstraintGeneration):
    """Impose bounds of velocities, and of all other states whose rates are unknowns, on Bernstein coefficients.

    Rows of positions and expressions of the state are enforced by ``ConstraintGeneration``.

    Parameters
    ----------
    tolerance, rounds
        See ``ConstraintGeneration``.
    controls : bool
        Impose bounds of controls, accelerations and other algebraic variables except the forces of contacts on
        coefficients as well. If False, they hold at the sites of the scheme, as in published optima.
    states : bool
        Impose bounds of states on coefficients. If False, ``ConstraintGeneration`` enforces them, which is not
        conservative.
    positions : bool
        Impose bounds of all states on coefficients, positions included, in phases without invariants.

    Notes
    -----
    The parabola of a torque through tau_0, tau_m, tau_1 of a Hermite-Simpson interval has the coefficients tau_0,
    2 tau_m - (tau_0 + tau_1) / 2, tau_1. Where a torque switches from one limit to the other, it exceeds them by up to
    a quarter between the points. With ``controls=True`` it stays within them and takes an interval to switch. Linear
    and constant controls lie between their values without further rows.

    The rows hold for the polynomials of the solution. The torques of the motion (q, v, a)(t) by inverse dynamics equal
    the planned ones at collocation points alone. Where torques switch, the difference is largest: it is the
    collocation error, which ``tolerance=`` limits and ``rt.validate`` measures.
    """

    controls: bool = False
    states: bool = True
    positions: bool = False

    def covers(self, phase: Phase) -> frozenset[str]:
        """Return controls and z if ``controls``, and states with rates of z or u in phases without invariants."""
        driven: frozenset[str] = frozenset()
        if self.states:
            known = _DRIVEN.get(phase)
            driven = _DRIVEN[phase] = _driven(phase) if known is None else known
        chosen = (*phase.dae.controls, *limited_algebraic(phase)) if self.controls else ()
        if self.positions and not phase.dae.invariants:
            chosen = (*chosen, *phase.body.states)
        return driven | {variable.name for variable in chosen}


def limited_algebraic(phase: Phase) -> tuple[Variable, ...]:
    """Return the algebraic variables whose bounds limit the motion, such as accelerations; the first ones of the phase.

    Forces of contacts, whose cones are path rows, and variables of an objective are not among them.
    """
    forces = {force.name for contact in phase.bound_contacts for force in contact.forces}
    return tuple(variable for variable in phase.body.algebraic if variable.name not in forces)


_DRIVEN: WeakKeyDictionary[Phase, frozenset[str]] = WeakKeyDictionary()


def _driven(phase: Phase) -> frozenset[str]:
    dae = phase.dae
    if dae.invariants:
        return frozenset()
    if type(dae) is InverseRigidBody:
        # The rates are velocities, which are states, and accelerations, which are unknowns.
        return frozenset(state.name for state in dae.states[dae.robot.nq :])
    point = symbols_of(dae, phase.parameter_names)
    reads = ca.which_depends(dae.rates(point), inputs_of(dae, point), 1, True)
    return frozenset(state.name for state, read in zip(dae.states, reads, strict=True) if read)
