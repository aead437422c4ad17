"""Configurations that satisfy rows on positions, such as poses of a tool: several branches from many seeds at once.

Each row bounds a function of the positions, lower <= c(q) <= upper. Damped least squares (``descent``) reduce the
violations, from the given configuration and from seeded random ones.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.lazy_values import cached_property
from robotraj._util.precision import MET
from robotraj._util.values import dataclass
from robotraj.guess.reaching.descent import SEEDS, STEPS, descended
from robotraj.guess.reaching.position_rows import values_at_rest
from robotraj.problem.clearance.end_checks import clearances_of, distances_at_rest
from robotraj.problem.clearance.own_shapes import own_shapes
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import PhaseRow
from robotraj.robot.collision.along_motion import pairs_within

PULL = 0.1
"""Weight of the distance from the given configuration beside that of rows, which are then met exactly.

Times to 40 drawn places differ by 1 % from a third to three times as much.
"""


@dataclass(frozen=True, eq=False)
class OpenEnd:
    """An end of a phase whose positions are not all given, and the rows on positions that apply there.

    Attributes
    ----------
    parts : tuple of (Phase, tuple of PhaseRow)
        Rows that apply there: of the phase that ends, and of the one that starts.
    lower, upper : ndarray (nq,)
        Bounds of the positions [rad, m].
    speeds : ndarray (nq,)
        Speeds of the joints that measure distances [rad/s, m/s].
    time : float
        Time at the end [s], for rows that depend on it.
    """

    parts: tuple[tuple[Phase, tuple[PhaseRow, ...]], ...]
    lower: Array
    upper: Array
    speeds: Array
    time: float

    def reached(self, near: Array) -> Array:
        """Return configurations (k, nq) inside the bounds at which the rows hold; none if the search found none.

        Along motions that change no row, the fastest solutions are moved towards ``near``. Where some configurations
        are clear of obstacles at rest, and of overlaps of the robot's own links, only these are returned.

        Parameters
        ----------
        near : ndarray (nq,)
            The first configuration from which the search starts.
        """
        rng = np.random.default_rng(0)
        low, high = np.maximum(self.lower, near - np.pi), np.minimum(self.upper, near + np.pi)
        low, high = np.minimum(low, self.upper), np.maximum(high, self.lower)
        seeds = np.vstack([near, rng.uniform(low, np.maximum(low, high), (SEEDS - 1, len(near)))])
        q, missed = self._met(seeds)
        found = q[missed < MET]
        if not len(found):
            return found
        found = self._turned(found, near)
        found = found[np.argsort(self.seconds(near, found))]
        pulled = self._pulled(found, near)
        clear, still = self._is_clear(found), self._is_clear(pulled)
        found, some = np.where((still | ~clear)[:, None], pulled, found), still | clear
        return np.asarray(found[some]) if some.any() else found

    def _is_clear(self, q: Array) -> NDArray[np.bool_]:
        """Whether configurations (m, nq) are clear of obstacles, and no links of the robot overlap, (m,)."""
        clear = self.clearance(q) >= 0.0
        for phase, _ in self.parts:
            body = own_shapes(phase)
            if body is not None and phase.robot is not None:
                clear[clear] = ~pairs_within(phase.robot, body, q[clear]).any(axis=1)
        return clear

    def clearance(self, q: Array) -> Array:
        """Return the least distance beyond its margin [m] of configurations (m, nq), (m,); infinite without pairs."""
        least = np.full(len(q), np.inf)
        for phase, _ in self.parts:
            for pairs in clearances_of(phase.constraints, phase.robot):
                left = distances_at_rest(pairs, q) - pairs.margin
                least = np.minimum(least, left.min(axis=1, initial=np.inf))
        return least

    def seconds(self, near: Array, q: Array) -> Array:
        """Return the time of the slowest joint from ``near`` (nq,) to configurations (m, nq), (m,) [s]."""
        return np.asarray(np.max(np.abs(q - near) / self.speeds, axis=1))

    def _pulled(self, q: Array, near: Array) -> Array:
        """Move configurations towards ``near`` along motions that change no row: a weak pull, then the rows alone."""

        def errors(at: Array) -> tuple[Array, Array]:
            missed, slopes = self._errors(at)
            # The sum of fourth powers weighs the slowest joint most.
            time = (near - at) / self.speeds
            pulls = 2.0 * PULL * np.abs(time) / self.speeds
            away = pulls[:, None] * np.eye(len(near))
            return np.hstack([missed, PULL * time * np.abs(time)]), np.concatenate([slopes, away], axis=1)

        moved, left = self._met(descended(errors, q, (self.lower, self.upper))[0])
        better = (left < MET) & (self.seconds(near, moved) < self.seconds(near, q))
        return np.where(better[:, None], moved, q)

    def _errors(self, q: Array) -> tuple[Array, Array]:
        """Return the violations (m, rows) at configurations (m, nq), and the slopes (m, rows, nq) of violated rows.

        Slopes of equations are returned as well where these are satisfied.
        """
        every = [row for _, rows in self.parts for row in rows]
        lower, upper = (np.array([getattr(row, side) for row in every]) for side in ("lower", "upper"))
        values, slopes = self._function.map(len(q))(q.T)
        values = np.array(values).T
        missed = np.clip(values, lower, upper) - values
        active = (missed != 0.0) | (lower == upper)
        return missed, np.array(slopes).reshape(len(every), len(q), -1).swapaxes(0, 1) * active[..., None]

    def _met(self, q: Array) -> tuple[Array, Array]:
        """Return configurations (m, nq) where equations hold, and then all rows, and their largest violations (m,).

        Bounds that hold where the equations do would hold back the steps to them, such as those of narrow angles.
        """
        equations = [row.lower == row.upper or row.selects_root for _, rows in self.parts for row in rows]

        def errors(at: Array) -> tuple[Array, Array]:
            missed, slopes = self._errors(at)
            return missed[:, equations], slopes[:, equations]

        return self._descended(descended(errors, q, (self.lower, self.upper))[0])

    def _descended(self, q: Array, steps: int = STEPS) -> tuple[Array, Array]:
        """Return configurations (m, nq) where the rows hold as far as possible, and their largest violations (m,)."""
        found, missed = descended(self._errors, q, (self.lower, self.upper), steps)
        return found, np.abs(missed).max(axis=1, initial=0.0)

    def _turned(self, q: Array, near: Array) -> Array:
        """Turn joints by whole turns to the positions nearest to ``near``, if the rows are satisfied there."""
        states = self.parts[0][0].body.states[: len(near)]
        turns = 2.0 * np.pi * np.array([state.unit == "rad" for state in states])
        with np.errstate(invalid="ignore", divide="ignore"):
            least, most = np.ceil((self.lower - q) / turns), np.floor((self.upper - q) / turns)
            count = np.where(turns > 0, np.clip(np.round((near - q) / turns), least, most), 0.0)
        nearer = np.where(np.isfinite(count), q + count * turns, q)
        return np.where((self._descended(nearer, 0)[1] < MET)[:, None], nearer, q)

    @cached_property
    def _function(self) -> ca.Function:
        """The function q -> values (rows,) and slopes (rows, nq) of the rows, at rest."""
        q = ca.SX.sym("q", len(self.lower))
        values = [values_at_rest(phase, rows, q, self.time) for phase, rows in self.parts]
        column = ca.vertcat(*values)
        return ca.Function("open_end", [q], [ca.densify(column), ca.densify(ca.jacobian(column, q))])
