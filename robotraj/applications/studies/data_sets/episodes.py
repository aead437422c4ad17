"""Episodes of a study: its planned motions, sampled at a fixed rate."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.applications.studies.rows import CASE, CURVES, KNOTS
from robotraj.applications.studies.store import Store
from robotraj.solvers.checks import above_zero

QUATERNION = slice(3, 7)
"""Place of the root's quaternion in q of a floating robot."""
UNIT = 1e-3
"""Largest distance of the norm of a quaternion from 1, by the 32 bits of rows and their interpolation."""


@dataclass(frozen=True, eq=False)
class Episode:
    """One planned motion at equal steps of time.

    Attributes
    ----------
    key : str
        Key of its case.
    case : mapping
        Numbers and words of the case.
    state : ndarray (n, nq + nv)
        q and v; of a System its states [SI units].
    action : ndarray (n, nu)
        Torques and forces of the motors [N m, N], or the positions of the next sample.
    """

    key: str
    case: Mapping[str, Any]
    state: NDArray[np.float32]
    action: NDArray[np.float32]


def episodes(store: Store, rate: float, action: str) -> Iterator[Episode]:
    """Yield the motions of all cases that were solved, and proved where a proof was asked for.

    Rows keep 64 times. Between them q is the cubic through positions and velocities where both have one entry a joint;
    otherwise, as v, it is the monotone cubic of Fritsch and Carlson. Torques, which may jump, are linear.

    Parameters
    ----------
    store : Store
    rate : float
        Samples a second [Hz].
    action : str
        ``"tau"``, or ``"q"`` for the positions of the next sample.

    Raises
    ------
    InputError
        The rate is no number above 0, there is no such action, or no case has a motion.
    """
    above_zero("rate", rate, "Hz")
    if action not in ("tau", "q"):
        raise InputError(f"action= is {action!r}; give 'tau' for torques, or 'q' for the positions of the next sample.")
    names = [name for name in store.columns() if name.startswith(CASE)]
    table = store.table(["key", "success", "proved", "duration", "t", *CURVES, *names])
    found = False
    for number in range(table.num_rows):
        (row,) = table.slice(number, 1).to_pylist()
        if row["success"] and row["proved"] is not False and row["t"] is not None:
            found = True
            if row["duration"] * rate < 1.0:
                raise InputError(
                    f"rate= is {rate:g} Hz, but case {row['key']!r} takes {row['duration']:.3g} s: give more."
                )
            case = {name.removeprefix(CASE): row[name] for name in names}
            yield Episode(row["key"], case, *_sampled(row, 1.0 / rate, action))
    if not found:
        raise InputError(f"No case of {str(store.folder)!r} has a motion; print(study) counts them by status.")


def _sampled(row: Mapping[str, Any], step: float, action: str) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return states and actions of a row at equal steps from its start, the last one not after its end."""
    knots = np.array(row["t"], float)
    q, v, tau = (None if row[name] is None else np.array(row[name], float).reshape(KNOTS, -1) for name in CURVES)
    assert q is not None and tau is not None
    last = knots[-1] - knots[0]
    times = np.minimum(knots[0] + step * np.arange(int(np.floor(last / step + 1e-6)) + 1), knots[-1])
    curve = CubicHermiteSpline(knots, q, v) if v is not None and v.shape == q.shape else PchipInterpolator(knots, q)
    positions = _normalised(q, curve(times))
    state = positions if v is None else np.hstack([positions, PchipInterpolator(knots, v)(times)])
    if action == "q":
        acted = positions[np.minimum(np.arange(1, len(times) + 1), len(times) - 1)]
    else:
        acted = np.column_stack([np.interp(times, knots, column) for column in tau.T]).reshape(len(times), -1)
    return state.astype(np.float32), acted.astype(np.float32)


def _normalised(known: Array, q: Array) -> Array:
    """Scale the quaternions of a floating root to length 1."""
    if known.shape[1] < QUATERNION.stop or np.any(np.abs(np.linalg.norm(known[:, QUATERNION], axis=1) - 1.0) > UNIT):
        return q
    q[:, QUATERNION] /= np.linalg.norm(q[:, QUATERNION], axis=1, keepdims=True)
    return q
