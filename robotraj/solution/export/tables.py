"""Trajectories as tables: CSV for spreadsheets, JSON for other programs. Every heading has its unit."""

from __future__ import annotations

import csv
import json
import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.paths import output_path
from robotraj._util.printing import OneLine
from robotraj._util.system.whole_files import WholeFile
from robotraj._util.values import dataclass
from robotraj.solution.columns import values_of, variables_of
from robotraj.solution.export.times import cell, sample_times
from robotraj.solution.planned import Planned

TEXTS = (".csv", ".tsv", ".txt", ".dat")
"""Suffixes of tables of CSV: a file of another kind would not open."""


@dataclass(frozen=True)
class Column(OneLine):
    """One variable over time: its name (``"q.elbow"``), SI unit and values (m,), NaN where there is none."""

    name: str
    unit: str
    values: Array

    @property
    def heading(self) -> str:
        """Name and unit, ``"q.elbow [rad]"``."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


def table(
    solution: Planned, samples: int | Sequence[float], gains: bool = False, rate: float | None = None
) -> list[Column]:
    """Sample every variable of all phases: states, accelerations of robots, algebraic variables, controls.

    Parameters
    ----------
    solution : Solution
    samples : int or sequence of float
        Number of equally spaced times from start to end, or the times [s].
    rate : float, optional
        Samples per second in place of ``samples``; the first and the last are exactly the start and the end.
    gains : bool
        Add the entries of ``solution.gains``, ``gain.<motor>.q.<joint>`` and ``gain.<motor>.v.<joint>``.

    Returns
    -------
    list of Column
        Time first. Where two phases meet, values are those of the later one.

    Raises
    ------
    InputError
        Fewer than 2 samples, or times outside the solution.
    """
    start = solution.phases[0].t0
    times = sample_times(start, start + solution.duration, samples, rate)
    starts = np.array([phase.t0 for phase in solution.phases])
    owner = np.clip(np.searchsorted(starts, times, side="right") - 1, 0, len(starts) - 1)
    units: dict[str, str] = {}
    for part in solution.phases:
        units |= {variable.name: variable.unit for variable in variables_of(part.phase)}
    values = {name: np.full(len(times), np.nan) for name in units}
    for i, part in enumerate(solution.phases):
        own = owner == i
        if own.any():
            for name, column in values_of(part, times[own]).items():
                values[name][own] = column
    columns = [Column("t", "s", times), *(Column(name, unit, values[name]) for name, unit in units.items())]
    return [*columns, *_gain_columns(solution, times)] if gains else columns


def to_csv(
    solution: Planned,
    path: str | os.PathLike[str],
    samples: int | Sequence[float] = 201,
    gains: bool = False,
    rate: float | None = None,
) -> Path:
    """Write a table over time with one header row, ``t [s], q.elbow [rad], ...``.

    Parameters
    ----------
    solution : Solution
    path : path
        Its directory must exist; an older file is replaced.
    samples : int or sequence of float
        Number of equally spaced times, or the times [s].
    rate : float, optional
        Samples per second in place of ``samples``: start, start + 1 / rate, ..., end.
    gains : bool
        Add a column for every entry of ``solution.gains``: tau = tau_plan - K (x - x_plan).

    Returns
    -------
    pathlib.Path
        The file, absolute. Numbers have all their digits; a variable that a phase lacks is an empty cell.
    """
    target = output_path(path, TEXTS if Path(path).suffix else (), "the table of CSV")
    columns = table(solution, samples, gains, rate)
    with WholeFile(target) as partial, partial.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow([cell(column.heading) for column in columns])
        for row in zip(*(column.values for column in columns), strict=True):
            writer.writerow([repr(float(value)) if np.isfinite(value) else "" for value in row])
    return target


def to_json(
    solution: Planned,
    path: str | os.PathLike[str],
    samples: int | Sequence[float] = 201,
    gains: bool = False,
    rate: float | None = None,
) -> Path:
    """Write status, figures, phases and the sampled trajectory as plain JSON.

    Keys: ``status``, ``success``, ``message``, ``objective``, ``duration`` [s], ``iterations``, ``times``
    [s], ``parameters``, ``violations`` (text), ``phases`` (``name``, ``subject``, ``start`` [s],
    ``duration`` [s], ``knots`` [s], ``parameters``), ``units`` by column and ``columns``: lists of equal
    length, ``"t"`` first; null where a phase lacks the variable.

    Parameters and errors are those of ``to_csv``.
    """
    target = output_path(path, (".json", ".txt") if Path(path).suffix else (), "the table of JSON")
    columns = table(solution, samples, gains, rate)
    content = {
        "status": solution.status.value,
        "success": solution.success,
        "message": solution.message,
        "objective": _number(solution.objective),
        "duration": _number(solution.duration),
        "iterations": int(solution.iterations),
        "times": _numbers(solution.times),
        "parameters": _numbers(solution.parameters),
        "violations": [str(violation) for violation in solution.violation_list],
        "phases": [
            {
                "name": part.phase.name,
                "subject": part.phase.subject.name,
                "start": _number(part.t0),
                "duration": _number(part.duration),
                "knots": [_number(t) for t in part.knots],
                "parameters": _numbers(part.parameters),
            }
            for part in solution.phases
        ],
        "units": {column.name: column.unit for column in columns},
        "columns": {column.name: [_number(value) for value in column.values] for column in columns},
    }
    with WholeFile(target) as partial:
        partial.write_text(json.dumps(content, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    return target


def _gain_columns(solution: Planned, times: Array) -> list[Column]:
    """Sample every entry of the feedback gains, row by row."""
    feedback = solution.gains
    matrices = np.array([feedback.at(float(t)) for t in times])
    robot = solution.phases[0].phase.robot
    assert robot is not None
    units = dict(zip(robot.velocity_names, robot.units, strict=True))
    found = []
    for i, motor in enumerate(feedback.joints):
        torque = "N m" if units[motor] == "rad" else "N"
        for j, (kind, joint) in enumerate((kind, joint) for kind in "qv" for joint in feedback.coordinates):
            per = units[joint] if kind == "q" else f"({units[joint]}/s)"
            found.append(Column(f"gain.{motor}.{kind}.{joint}", f"{torque}/{per}", matrices[:, i, j]))
    return found


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _numbers(values: dict[str, float]) -> dict[str, float | None]:
    return {name: _number(value) for name, value in values.items()}
