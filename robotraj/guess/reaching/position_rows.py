"""Rows that depend on the positions of a robot alone, and their values at rest."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from robotraj.guess.ends import default_parameters
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import PhaseRow


def of_positions(phase: Phase, rows: Sequence[PhaseRow], nq: int) -> tuple[PhaseRow, ...]:
    """Return those rows of a phase that depend on the positions (nq,) and on no velocity, force or torque."""
    _, x, z, u, _ = phase.rows.symbols
    others = ca.vertcat(x[nq:], z, u)
    return tuple(
        row
        for row, value in zip(rows, phase.rows.expressions(rows), strict=True)
        if ca.depends_on(value, x[:nq]) and not ca.depends_on(value, others)
    )


def values_at_rest(phase: Phase, rows: Sequence[PhaseRow], q: ca.SX, time: float) -> ca.SX:
    """Return the values (rows,) in a configuration q (nq,) at rest at a time [s], with parameters at their defaults."""
    t, x, _, _, p = phase.rows.symbols
    known = default_parameters(phase)
    numbers = ca.DM([time, *(known[name] for name in phase.parameter_names)])
    rest = ca.vertcat(q, ca.DM.zeros(x.numel() - q.numel()))
    return ca.substitute(ca.vertcat(*phase.rows.expressions(rows)), ca.vertcat(x, t, p), ca.vertcat(rest, numbers))
