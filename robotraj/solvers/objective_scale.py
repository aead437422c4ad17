"""The factor by which an interior-point method multiplies the objective."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.arrays import Array

if TYPE_CHECKING:
    from robotraj.native import Program as NativeProgram
    from robotraj.solvers.stagewise.program import StageProgram
    from robotraj.transcription.nlp import Nlp


SHARE = 0.05
"""Duality gap of the first barrier, relative to the objective at the guess."""
LEAST = 1e-4
"""Smallest scale, for huge objectives at the guess, such as at a singular posture."""
FINE = 100
"""Number of stages above which an objective may be enlarged, in proportion."""


def objective_scale(objective: float, bounds: int, stages: int, barrier: float) -> float:
    """Return a scale at which the first barrier has the same weight in any unit and on any mesh.

    At the minimum of a barrier problem of parameter mu the gap between objective and optimum is about m mu, for m
    bounds. The scale s makes it ``SHARE`` of the objective f_0 at the guess:

        s = m mu / (SHARE |f_0|),    1e-4 <= s <= max(1, stages / 100).

    The number of bounds grows with the mesh, but the integral does not. Without s the same barrier would have a larger
    weight on finer meshes. An objective is enlarged only on fine meshes, since minimum times converge slowly on coarse
    ones. A solve with the last barrier mu_n ends at a gap of SHARE |f_0| mu_n / mu, about 1e-8 |f_0|. The scale is 1
    where f_0 is zero or not finite, or where there are no bounds.

    Parameters
    ----------
    objective : float
        f_0.
    bounds : int
        Number of finite bounds of the inequalities, m.
    stages : int
        Number of stages.
    barrier : float
        The first barrier parameter, mu.

    Notes
    -----
    Source: Nocedal and Wright, Numerical Optimization (2006), section 19.1, for the gap. Waechter and Biegler,
    Mathematical Programming 106 (2006), section 3.8, scale the unit of the objective.
    """
    if objective == 0.0 or not np.isfinite(objective) or bounds == 0:
        return 1.0
    return float(np.clip(bounds * barrier / (SHARE * abs(objective)), LEAST, max(1.0, stages / FINE)))


def of_program(native: NativeProgram, start: Array, program: StageProgram, barrier: float, nlp: Nlp) -> float:
    """Return the scale of the compiled program of an NLP; ``Nlp.objective_scale`` chooses a unit first."""
    first = native.objective(start)
    unit = nlp.objective_scale(first)
    bounds = int(np.isfinite(program.lower).sum() + np.isfinite(program.upper).sum())
    return unit * objective_scale(unit * first, bounds, len(program.nu), barrier)
