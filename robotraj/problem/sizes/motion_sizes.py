"""The sizes of variables and rows in a motion, to which violations are relative.

A row has the unit of its user, so a fixed size such as 1 makes the same constraint written times 1e-6 invisible. At the
instant of a violation the motion changes a row by

    S_i = sum_j |dg_i/dw_j| s_j.

w are states, algebraic variables, controls and parameters, s_j their sizes in the motion. ``Row.size_in`` limits the
size of the row by it, so that a violation is never far larger than what the motion does. The slopes are the mean of
both one-sided differences over STEP s_j: where the gradient is zero, the bend of the row remains.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.system import SystemDynamics
from robotraj.dynamics.variable import Variable
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import PhaseRow
from robotraj.problem.rows import RowTable, phase_symbols
from robotraj.robot.size.state_sizes import state_sizes

STEP = 1e-4
"""Step of the differences relative to the size of a variable."""


Evaluate: TypeAlias = Callable[[Sequence[PhaseRow], Array, Array, Array, Array, Array], Array]
"""Values (m, rows) of rows at points t (m,), x, z, u (m, n) with parameters p (np,), such as ``RowTable.sample``."""


@dataclass(frozen=True, eq=False)
class MotionSizes:
    """Sizes of the variables of a phase in a motion, in the unit of each.

    Attributes
    ----------
    x, z, u, p : ndarray
        Of states (nx,), algebraic variables (nz,), controls (nu,) and parameters (np,).
    """

    x: Array
    z: Array
    u: Array
    p: Array

    @classmethod
    def of(cls, table: RowTable, t: Array, x: Array, z: Array, u: Array, p: Array) -> MotionSizes:
        """Return the sizes in a motion sampled at times t (m,): x (m, nx), z (m, nz), u (m, nu) and p (np,).

        States have the sizes of ``state_sizes``. The zero of algebraic variables and controls is part of their range. A
        control is at least as large as what moves a state of a System by its size in the duration.
        """
        dae = table.dae
        of_states = state_sizes(units_of_states(dae.states), x)
        of_others = [
            state_sizes([v.unit for v in kind], np.vstack([values, np.zeros((1, len(kind)))]))
            for kind, values in ((dae.algebraic, z), (dae.controls, u))
        ]
        if isinstance(table.body, SystemDynamics):
            unused = np.abs(u).max(axis=0, initial=0.0) == 0.0
            mattering = controls_that_matter(dae, table.parameters, of_states, (t, x, z, u, p))
            of_others[1] = np.where(unused & (mattering > 0.0), mattering, np.maximum(of_others[1], mattering))
        return cls(of_states, of_others[0], of_others[1], np.where(p != 0.0, np.abs(p), 1.0))

    def joined(self, other: MotionSizes) -> MotionSizes:
        """Return the larger sizes of two: phases of one motion share them, since a short one may hardly move."""
        pairs = ((self.x, other.x), (self.z, other.z), (self.u, other.u), (self.p, other.p))
        return MotionSizes(*(np.maximum(own, further) for own, further in pairs))

    def changes(
        self,
        rows: Sequence[PhaseRow],
        evaluate: Evaluate,
        t: Array,
        x: Array,
        z: Array,
        u: Array,
        p: Array,
    ) -> Array:
        """Return what the motion changes rows by (m, rows) at points of it; see ``Evaluate`` and ``Row.size_in``."""
        here = evaluate(rows, t, x, z, u, p)
        changes = np.zeros_like(here)
        with np.errstate(invalid="ignore"):
            for i, size in enumerate((self.x, self.z, self.u, self.p)):
                for j, step in enumerate(STEP * size):
                    for sign in (-1.0, 1.0):
                        moved = [x, z, u, p]
                        moved[i] = moved[i].copy()
                        moved[i][..., j] += sign * step
                        changes += np.abs(evaluate(rows, t, *moved) - here)
        return changes / (2.0 * STEP)


def units_of_states(states: Sequence[Variable]) -> list[str]:
    """Return the units by which states are alike.

    The entries of a quaternion change by half the angle of a rotation.
    """
    return [state.unit or ("rad" if state.quantity == "position" else "") for state in states]


def same_variables(phases: Sequence[Phase], phase: Phase) -> list[int]:
    """Return the numbers of the phases whose variables are those of ``phase``, itself included."""

    def variables(each: Phase) -> tuple[object, ...]:
        return each.dae.states, each.dae.algebraic, each.dae.controls, each.parameter_names

    own = variables(phase)
    return [i for i, each in enumerate(phases) if each is phase or variables(each) == own]


def controls_that_matter(
    dae: Dynamics, parameters: Sequence[str], sizes: Array, motion: tuple[Array, Array, Array, Array, Array]
) -> Array:
    """Return the controls that move a state by its size over a phase, min_i s_i / (T |df_i/du|), 0 where none does.

    Parameters
    ----------
    dae : Dynamics
    parameters : sequence of str
    sizes : ndarray (nx,)
        Sizes s of the states.
    motion : tuple of ndarray
        Times (m,), x (m, nx), z (m, nz), u (m, nu) and p (np,).
    """
    t, x, z, u, p = motion
    symbols = phase_symbols(dae, parameters)
    rates = ca.SX(ca.vertcat(dae.rates(dae.point(*symbols, parameters))))
    slopes = ca.Function("slopes", list(symbols), [ca.densify(ca.jacobian(rates, symbols[3]))])
    columns = [np.reshape(t, (1, -1)), x.T, z.T, u.T, np.tile(np.reshape(p, (-1, 1)), (1, len(t)))]
    shape = (len(dae.states), len(t), len(dae.controls))
    steepest = np.abs(np.array(slopes.map(len(t))(*columns)).reshape(shape)).max(axis=1)
    duration = float(t[-1] - t[0])
    with np.errstate(divide="ignore", invalid="ignore"):
        amounts = np.where(steepest > 0.0, sizes[:, None] / (duration * steepest), np.inf)
    least = amounts.min(axis=0, initial=np.inf)
    return np.asarray(np.where(np.isfinite(least), least, 0.0))
