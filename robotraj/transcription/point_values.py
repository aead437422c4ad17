"""Values of expressions along a trajectory, at many points at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from weakref import WeakKeyDictionary

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj.dynamics.path_body import PathPoint
from robotraj.dynamics.point import AnyPoint
from robotraj.dynamics.torque_symbols import separate_torques
from robotraj.problem.phase_row import PhaseRow
from robotraj.problem.rows import RowTable
from robotraj.transcription.assembly.point_functions import PointFunctions

FEWEST_PLACES = 8
"""Least number of evaluated points. The number is a power of two, so that few evaluators are made."""


class PointValues:
    """The function (t, x, z, u, p) -> values of a phase, with the robot's inverse dynamics in the compiled module.

    Parameters
    ----------
    table : RowTable
        The dynamics and the names of the parameters.
    expression : callable
        From a point of symbols to a column (n,).
    """

    def __init__(self, table: RowTable, expression: Callable[[AnyPoint], ca.SX]) -> None:
        t, x, z, u, p = table.symbols
        point = table.dae.point(t, x, z, u, p, table.parameters)
        torques = separate_torques(point)
        given = ca.vertcat(x, z, u), ca.vertcat(t, p)
        self._functions = PointFunctions(*given, expression(point), None, torques, as_tapes=True)

    def at(self, t: Array, x: Array, z: Array, u: Array, p: Array) -> Array:
        """Evaluate at points, one a row: (m,), (m, nx), (m, nz), (m, nu) and p (np,) -> (m, n)."""
        m = len(t)
        places = max(FEWEST_PLACES, 1 << (m - 1).bit_length())
        given = np.hstack([x, z, u]), np.hstack([np.reshape(t, (m, 1)), np.tile(p, (m, 1))])
        v, c = (np.vstack([part, np.tile(part[-1:], (places - m, 1))]) for part in given)
        return self._functions.evaluate("function", v.T, c.T).T[:m]


_ROWS: WeakKeyDictionary[RowTable, dict[tuple[int, ...], PointValues]] = WeakKeyDictionary()
_JOINTS: WeakKeyDictionary[RowTable, PointValues] = WeakKeyDictionary()


def sampled(table: RowTable, rows: Sequence[PhaseRow], t: Array, x: Array, z: Array, u: Array, p: Array) -> Array:
    """Evaluate rows at times as ``RowTable.sample`` does, by functions that are built once, (m, rows)."""
    out, others = table.bounded_columns(rows, x, z, u)
    if others:
        chosen = tuple(rows[i] for i in others)
        known, key = _ROWS.setdefault(table, {}), tuple(row.number for row in chosen)
        if key not in known:
            known[key] = PointValues(table, lambda point: table.column(chosen, point))
        out[:, others] = known[key].at(t, x, z, u, p)
    return out


def joints_on_path(table: RowTable) -> PointValues:
    """Return the function of q, v, a (nv,) each and tau (nu,) of a phase on a path, which is built once."""
    if table not in _JOINTS:

        def motion(point: PathPoint) -> ca.SX:
            return ca.vertcat(point.q, point.v, point.a, point.tau)

        _JOINTS[table] = PointValues(table, motion)
    return _JOINTS[table]
