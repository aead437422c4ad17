"""Distance of a simulated motion from the plan."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.witness.plants.plant import Plant
from robotraj.witness.simulation.spans import Motion


@dataclass(frozen=True)
class DriftRow(OneLine):
    """The drift of one state.

    Attributes
    ----------
    name : str
        ``q.<joint>``, ``v.<joint>``, or the state's name. A floating root drifts by q.root_x, q.root_y, q.root_z in
        the world and by the rotation vector q.root_rx, q.root_ry, q.root_rz in its own axes.
    unit : str
    final : float
        |simulated - planned| at the end; infinite if the simulation did not reach it.
    largest : float
        Largest |simulated - planned|; infinite if the simulation did not reach the end.
    time : float
        Time of the largest drift, or at which the simulation stopped [s].
    phase : str
        Phase of the largest drift.
    scale : float
        Size of the state in the motion (``robot.size.state_sizes``), by which a tolerance is multiplied.
    """

    name: str
    unit: str
    final: float
    largest: float
    time: float
    phase: str
    scale: float

    @property
    def relative(self) -> float:
        """``largest`` / ``scale``, which is compared with a tolerance."""
        return self.largest / self.scale


@dataclass(frozen=True)
class Drift(OneLine, Mapping[str, DriftRow]):
    """Drift by state name: ``drift["q.elbow"].largest``."""

    rows: tuple[DriftRow, ...]

    def __getitem__(self, name: str) -> DriftRow:
        for row in self.rows:
            if row.name == name:
                return row
        raise KeyError(name)

    def __iter__(self) -> Iterator[str]:
        return (row.name for row in self.rows)

    def __len__(self) -> int:
        return len(self.rows)

    @property
    def worst(self) -> DriftRow:
        """The row of largest drift relative to its scale."""
        return max(self.rows, key=lambda row: row.relative)

    def largest(self, prefix: str = "") -> float:
        """Return the largest drift of the states whose names start with ``prefix``, such as ``"q."`` [rad, m]."""
        return max((row.largest for row in self.rows if row.name.startswith(prefix)), default=0.0)


VELOCITY_SCALE = 10.0
"""Ratio of the tolerances of velocities and positions that drift, for motions that change within a tenth of a second.
"""


def drift_of(plant: Plant, motion: Motion, phase: str, sizes: Array) -> tuple[DriftRow, ...]:
    """Compare a simulated phase with its plan, state by state, relative to the sizes (k,) of the states."""
    planned = plant.states(motion.times, motion.intervals)
    gaps = np.nan_to_num(np.abs(plant.gaps(motion.states, planned)), nan=np.inf)
    rates = np.array([name.startswith("v.") for name in plant.gap_names], dtype=bool)
    rows = zip(plant.gap_names, plant.gap_units, np.where(rates, VELOCITY_SCALE, 1.0) * sizes, strict=True)
    return tuple(
        _row(name, unit, gaps[:, i], motion, phase, float(scale)) for i, (name, unit, scale) in enumerate(rows)
    )


def _row(name: str, unit: str, gaps: Array, motion: Motion, phase: str, scale: float) -> DriftRow:
    if motion.failure is not None:
        return DriftRow(name, unit, np.inf, np.inf, motion.stopped, phase, scale)
    worst = int(np.argmax(gaps))
    return DriftRow(name, unit, float(gaps[-1]), float(gaps[worst]), float(motion.times[worst]), phase, scale)


def merge(phases: list[tuple[DriftRow, ...]]) -> Drift:
    """Join the drift of consecutive phases: the largest of all, and the final drift of the last one with the state."""
    merged: dict[str, DriftRow] = {}
    for rows in phases:
        for row in rows:
            earlier = merged.get(row.name)
            worst = row if earlier is None or row.relative >= earlier.relative else earlier
            merged[row.name] = DriftRow(
                row.name, row.unit, row.final, worst.largest, worst.time, worst.phase, worst.scale
            )
    return Drift(tuple(merged.values()))
