"""An earlier solution as an expression of symbolic time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import casadi as ca
import numpy as np

from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj._util.errors import unknown_name
from robotraj.problem.phase import Phase


class ReferencePhase(Protocol):
    """The attributes of a planned phase that ``symbolic_states`` uses."""

    @property
    def phase(self) -> Phase:
        """The phase that was planned."""

    @property
    def joint_states(self) -> PiecewisePolynomial:
        """The polynomials of its states; on a path, those of positions and velocities."""


class ReferenceSolution(Protocol):
    """The attributes of a solution that ``symbolic_states`` uses."""

    @property
    def phases(self) -> Sequence[ReferencePhase]:
        """The motion of each phase."""


def symbolic_states(solution: ReferenceSolution, names: Sequence[str], t: ca.SX) -> Mapping[str, ca.SX]:
    """States of a solution at a symbolic time, constant outside its duration.

    In interval k, x(t) = sum_d c_kd s^d with s = (t - b_k) / h_k; the coefficients of the interval that t
    lies in are c_0 + sum_k [t >= b_k] (c_k - c_{k-1}).

    Parameters
    ----------
    solution : Solution
    names : sequence of str
        Names of the states.
    t : SX
        Global time [s].

    Raises
    ------
    UnknownName
        The solution has no such state.
    """
    tables, breaks = [], []
    for part in solution.phases:
        path, states = part.phase.path, part.phase.dae.states
        known = [v.name for v in (states if path is None else path.free.states)]
        for name in names:
            if name not in known:
                raise unknown_name("state", name, known, "The reference solution has these.")
        columns = [known.index(name) for name in names]
        curve = part.joint_states
        for start, end, sites, values in zip(curve.breaks, curve.breaks[1:], curve.sites, curve.values, strict=False):
            powers = np.linalg.solve(np.vander(sites, increasing=True), values[:, columns])
            tables.append((start, end - start, powers))
            breaks.append(start)
    degree = max(len(powers) for *_, powers in tables)
    rows = np.array(
        [
            np.concatenate([[start, length], np.pad(powers, ((0, degree - len(powers)), (0, 0))).ravel()])
            for start, length, powers in tables
        ]
    )
    last = tables[-1][0] + tables[-1][1]
    time = ca.fmin(ca.fmax(t, breaks[0]), last)
    chosen = ca.SX(ca.DM(rows[0]))
    for k in range(1, len(rows)):
        chosen += (time >= breaks[k]) * ca.SX(ca.DM(rows[k] - rows[k - 1]))
    s = (time - chosen[0]) / chosen[1]
    n = len(names)
    found = {}
    for i, name in enumerate(names):
        value = chosen[2 + (degree - 1) * n + i]
        for d in range(degree - 2, -1, -1):
            value = value * s + chosen[2 + d * n + i]
        found[name] = value
    return found
