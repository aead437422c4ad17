"""What holds rows on states and controls between the collocation points.

A row holds where it is imposed; between, the polynomial may bulge over. Two ways to deal with it:

- ``ConstraintGeneration`` looks where a solution bulges, imposes the row there too and solves again (``guards``);
- ``BernsteinBounds`` imposes it, from the start, on the Bernstein coefficients of the polynomial on every interval. A
  polynomial lies in the convex hull of these, so the row holds everywhere. It asks a little more than needed, an excess
  that falls with the square of the interval's length.

Source: Farouki, The Bernstein polynomial basis: a centennial retrospective, Computer Aided Geometric Design 29 (2012).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import casadi as ca
import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.rigid_body import InverseRigidBody
from robotraj.problem.constraints.base import symbols_of

if TYPE_CHECKING:
    from robotraj.dynamics.variable import Variable
    from robotraj.problem.phase import Phase


@dataclass(frozen=True)
class ConstraintGeneration(OneLine):
    """Impose rows where a solution breaks them and solve again, until none is broken by more than the tolerance.

    Parameters
    ----------
    tolerance : float
        How far a row on states may be broken between collocation points before it is imposed there [its SI unit].
    rounds : int
        Times that the problem is solved again at most; 0 looks, and says what it found, but imposes nothing.
    """

    tolerance: float = 5e-4
    rounds: int = 12

    def __post_init__(self) -> None:
        tolerance: Any = self.tolerance
        rounds: Any = self.rounds
        if not (isinstance(tolerance, float | int | np.floating | np.integer) and tolerance > 0):
            raise InputError(f"{type(self).__name__}(tolerance) must be above 0, got {self.tolerance!r}.")
        if not (isinstance(rounds, int | np.integer) and rounds >= 0):
            raise InputError(f"{type(self).__name__}(rounds) must be a whole number of 0 or more, got {self.rounds!r}.")

    def covers(self, phase: Phase) -> frozenset[str]:
        """Give the variables whose bounds are imposed on whole intervals: none."""
        return frozenset()


@dataclass(frozen=True)
class BernsteinBounds(ConstraintGeneration):
    """Impose bounds of velocities, and of all other states whose rates are unknowns, on Bernstein coefficients.

    What is left, rows on positions and expressions of the state, is dealt with as in ``ConstraintGeneration``.

    Parameters
    ----------
    tolerance, rounds
        See ``ConstraintGeneration``.
    controls : bool
        Impose bounds of controls so too, and of accelerations and other algebraic variables but the forces of contacts,
        as ``rt.plan`` does where it refines with ``rt.InteriorPoint()``. Off, they hold at the sites of the scheme, as
        its published optima have them.
    states : bool
        Impose bounds of states so. Off, they are dealt with as in ``ConstraintGeneration``, which takes
        nothing from the optimum.
    positions : bool
        Impose bounds of all states so, those of positions among them, in phases without invariants.

    Notes
    -----
    The parabola of a torque through tau_0, tau_m, tau_1 of a Hermite-Simpson interval has the coefficients tau_0,
    2 tau_m - (tau_0 + tau_1) / 2, tau_1: where a torque switches from one limit to the other, it bulges up to a quarter
    of the limit beyond it. With ``controls=True`` it does not, and needs the time of an interval to switch. Linear and
    constant controls lie between their values without further rows.

    What is held is the plan: the polynomials of the solution, which are what is replayed and what a robot is sent. The
    torque that the motion (q, v, a)(t) would need by inverse dynamics is the planned one at collocation points alone.
    Where torques switch, the two differ by 2 % of the limit in single intervals (panda in minimum time, 50 to 200
    intervals; 0.1 % with 400), which is the collocation error that ``tolerance=`` and ``rt.validate`` speak of.
    """

    controls: bool = False
    states: bool = True
    positions: bool = False

    def covers(self, phase: Phase) -> frozenset[str]:
        """Give controls and z where asked for and, in phases without invariants, states whose rates read z or u."""
        driven: frozenset[str] = frozenset()
        if self.states:
            known = _DRIVEN.get(phase)
            driven = _DRIVEN[phase] = _driven(phase) if known is None else known
        chosen = (*phase.dae.controls, *limited_algebraic(phase)) if self.controls else ()
        if self.positions and not phase.dae.invariants:
            chosen = (*chosen, *phase.body.states)
        return driven | {variable.name for variable in chosen}


def limited_algebraic(phase: Phase) -> tuple[Variable, ...]:
    """Give the algebraic variables whose bounds limit the motion, such as accelerations; the first ones of the phase.

    Not the forces of contacts, whose cones are rows of points, nor what an objective brings along.
    """
    forces = {force.name for contact in phase.bound_contacts for force in contact.forces}
    return tuple(variable for variable in phase.body.algebraic if variable.name not in forces)


_DRIVEN: WeakKeyDictionary[Phase, frozenset[str]] = WeakKeyDictionary()


def _driven(phase: Phase) -> frozenset[str]:
    dae = phase.dae
    if dae.invariants:
        return frozenset()
    if type(dae) is InverseRigidBody:
        # Its rates are velocities, which are states, and accelerations, which are unknowns.
        return frozenset(state.name for state in dae.states[dae.robot.nq :])
    point = symbols_of(dae, phase.parameter_names)
    inner = ca.vertcat(*(point.z[v.name] for v in phase.body.algebraic), *point.u.values())
    reads = ca.which_depends(dae.rates(point), inner, 1, True)
    return frozenset(state.name for state, read in zip(dae.states, reads, strict=True) if read)
