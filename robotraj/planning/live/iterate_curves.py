"""The curves of an iterate of an ``rt.System``, for the page of a plan that is being made."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj.problem.problem import Problem
from robotraj.transcription.extract import PhaseTrajectory


def iterate_charts(problem: Problem, parts: Sequence[PhaseTrajectory], samples: int) -> list[dict[str, object]]:
    """Sample states, controls and algebraic variables.

    Parameters
    ----------
    problem : Problem
    parts : sequence of PhaseTrajectory
        The polynomials of every phase.
    samples : int
        Samples of each phase.

    Returns
    -------
    list of dict
        One for each chart that has curves: ``title`` and ``curves``, one for each phase and variable: ``label``,
        ``unit``, ``t`` [s] and ``y``. Values that are not finite are None.
    """
    charts: list[dict[str, object]] = []
    for title, group, name in (
        ("States", "states", "x"),
        ("Controls", "controls", "u"),
        ("Algebraic variables", "algebraic", "z"),
    ):
        curves: list[dict[str, object]] = []
        for phase, part in zip(problem.phases, parts, strict=True):
            variables = getattr(phase.dae, group)
            if not variables:
                continue
            times = np.linspace(part.t0, part.t0 + part.duration, samples)
            values = np.asarray(getattr(part, name)(times), dtype=float).reshape(samples, -1)
            curves += [
                {"label": variable.name, "unit": variable.unit, "t": _numbers(times), "y": _numbers(column)}
                for variable, column in zip(variables, values.T, strict=False)
            ]
        if curves:
            charts.append({"title": title, "curves": curves})
    return charts


def _numbers(values: Array) -> list[float | None]:
    return [float(f"{value:.5g}") if np.isfinite(value) else None for value in values]
