"""Values of rows along a trajectory: entries of a curve, their rates, and expressions.

``interval_violations`` evaluates all of them on a grid of places of every interval, and at single times.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial, reduce
from typing import Protocol
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array, Indices
from robotraj._util.lazy_values import cached_property
from robotraj._util.values import dataclass
from robotraj.problem.phase_row import PhaseRow
from robotraj.problem.rows import RowTable
from robotraj.problem.sizes.motion_sizes import MotionSizes
from robotraj.transcription.driven_motion import DefinedInputs, DrivenInputs, Inputs, PlannedInputs
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.interval_limits.full_friction import FullFriction
from robotraj.transcription.point_values import sampled

STEP = 1e-3
"""Step of the differences of torques, relative to the length of the interval."""


class Curve(Protocol):
    """A vector-valued function of time on intervals, such as a ``PiecewisePolynomial``."""

    @property
    def breaks(self) -> Array:
        """Ends of the intervals [s], (K + 1,)."""
        ...

    def __call__(self, t: Array, interval: Indices | None = None) -> Array:
        """Evaluate at times (m,), each on its own interval where these are given, (m, n)."""
        ...

    def inside(self, tau: Array) -> Array:
        """Evaluate every interval at the same places tau in [0, 1], (m,) -> (K, m, n)."""
        ...


@dataclass(frozen=True)
class DrivenCurve:
    """Algebraic variables (``kind`` 0) or controls (1) along a motion as a curve."""

    inputs: DrivenInputs | DefinedInputs | FullFriction
    kind: int

    @property
    def breaks(self) -> Array:
        """Ends of the intervals [s], (K + 1,)."""
        return self.inputs.trajectory.x.breaks

    def __call__(self, t: Array, interval: Indices | None = None) -> Array:
        """Evaluate at times (m,), each on its own interval where these are given, (m, n)."""
        return self.inputs.at(t, interval)[self.kind]

    def inside(self, tau: Array) -> Array:
        """Evaluate every interval at the same places tau in [0, 1], (m,) -> (K, m, n)."""
        return self.inputs.inside(tau)[self.kind]


class RowValues(Protocol):
    """Values of rows along a trajectory."""

    @property
    def breaks(self) -> Array:
        """Ends of the intervals [s], (K + 1,)."""
        ...

    def grid(self, tau: Array) -> Array:
        """Evaluate at places of every interval, (m,) -> (K, m, rows)."""
        ...

    def at(self, times: Array, intervals: Indices) -> Array:
        """Evaluate at times (m,), each on its own interval, (m, rows)."""
        ...


@dataclass(frozen=True)
class Columns:
    """Rows that are entries of one curve."""

    curve: Curve
    columns: Sequence[int]

    @property
    def breaks(self) -> Array:
        """Ends of the intervals [s], (K + 1,)."""
        return self.curve.breaks

    def grid(self, tau: Array) -> Array:
        """Evaluate at places of every interval, (m,) -> (K, m, rows)."""
        return self.curve.inside(tau)[..., self.columns]

    def at(self, times: Array, intervals: Indices) -> Array:
        """Evaluate at times (m,), each on its own interval, (m, rows)."""
        return self.curve(times, intervals)[:, self.columns]


@dataclass(frozen=True)
class Rates:
    """Rows that are time derivatives of entries of one curve, by central differences inside the intervals."""

    curve: Curve
    columns: Sequence[int]

    @property
    def breaks(self) -> Array:
        """Ends of the intervals [s], (K + 1,)."""
        return self.curve.breaks

    def grid(self, tau: Array) -> Array:
        """Evaluate at places of every interval, (m,) -> (K, m, rows)."""
        count = len(self.breaks) - 1
        times = self.breaks[:-1, None] + np.diff(self.breaks)[:, None] * tau
        return self.at(times.ravel(), np.repeat(np.arange(count), len(tau))).reshape(count, len(tau), -1)

    def at(self, times: Array, intervals: Indices) -> Array:
        """Evaluate at times (m,), each on its own interval, (m, rows)."""
        step = STEP * np.diff(self.breaks)[intervals]
        middle = np.clip(times, self.breaks[intervals] + step, self.breaks[intervals + 1] - step)
        change = self.curve(middle + step, intervals) - self.curve(middle - step, intervals)
        return change[:, self.columns] / (2.0 * step[:, None])


@dataclass(frozen=True)
class Expressions:
    """Rows that are expressions of a trajectory; without ``inputs`` of its states alone.

    Sizes of rows are those in the motion of all phases with the same variables, whose trajectories are ``alike``.
    """

    table: RowTable
    rows: Sequence[PhaseRow]
    trajectory: PhaseTrajectory
    inputs: Inputs | None
    alike: Sequence[PhaseTrajectory] = ()

    @property
    def breaks(self) -> Array:
        """Ends of the intervals [s], (K + 1,)."""
        return self.trajectory.x.breaks

    def grid(self, tau: Array) -> Array:
        """Evaluate at places of every interval, (m,) -> (K, m, rows)."""
        times = self.breaks[:-1, None] + np.diff(self.breaks)[:, None] * tau
        x = self.trajectory.x.inside(tau).reshape(times.size, -1)
        if self.inputs is None:
            return self._sample(times.ravel(), x).reshape(*times.shape, -1)
        z, u = (values.reshape(times.size, -1) for values in self.inputs.inside(tau))
        return self._sample(times.ravel(), x, z, u).reshape(*times.shape, -1)

    def at(self, times: Array, intervals: Indices) -> Array:
        """Evaluate at times (m,), each on its own interval, (m, rows)."""
        x = self.trajectory.x(times, intervals)
        if self.inputs is None:
            return self._sample(times, x)
        return self._sample(times, x, *self.inputs.at(times, intervals))

    @cached_property
    def given(self) -> NDArray[np.bool_]:
        """Rows of constraints that the phase was given; those of contacts are measured by the weight, (rows,)."""
        return np.array([self.table.constraints[row.constraint].source is not None for row in self.rows], dtype=bool)

    def sizes(self, rows: Sequence[PhaseRow], times: Array, intervals: Indices) -> Array:
        """Return the sizes (m, rows) of rows at times (m,), each on its own interval (``MotionSizes``)."""
        inputs = PlannedInputs(self.trajectory) if self.inputs is None else self.inputs
        parameters = np.array(list(self.trajectory.parameters.values()))
        point = times, self.trajectory.x(times, intervals), *inputs.at(times, intervals), parameters
        motion = reduce(
            MotionSizes.joined, (_motion_sizes(self.table, each) for each in (self.trajectory, *self.alike))
        )
        changes = motion.changes(rows, partial(sampled, self.table), *point)
        return np.array([[row.size_in(float(by)) for row, by in zip(rows, each, strict=True)] for each in changes])

    def _sample(self, times: Array, x: Array, z: Array | None = None, u: Array | None = None) -> Array:
        dae, parameters = self.table.dae, np.array(list(self.trajectory.parameters.values()))
        # Rows of the state read no other variables: these are one zero, repeated without memory.
        z = np.broadcast_to(0.0, (len(times), len(dae.algebraic))) if z is None else z
        u = np.broadcast_to(0.0, (len(times), len(dae.controls))) if u is None else u
        return sampled(self.table, self.rows, times, x, z, u, parameters)


_SIZES: WeakKeyDictionary[PhaseTrajectory, MotionSizes] = WeakKeyDictionary()


def _motion_sizes(table: RowTable, trajectory: PhaseTrajectory) -> MotionSizes:
    """Return the sizes of the variables of a phase along its planned polynomials; they are computed once."""
    if trajectory not in _SIZES:
        breaks = trajectory.x.breaks
        times = np.unique(np.concatenate([breaks, 0.5 * (breaks[1:] + breaks[:-1])]))
        parameters = np.array(list(trajectory.parameters.values()))
        x, z, u = trajectory.x(times), trajectory.z(times), trajectory.u(times)
        _SIZES[trajectory] = MotionSizes.of(table, times, x, z, u, parameters)
    return _SIZES[trajectory]
