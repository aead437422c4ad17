"""The size of an objective, to which its errors are relative.

It is the objective itself, unless that is small beside its terms: an optimum may be 0, and terms may cancel. Nothing is
relative to a fixed number, so that a plan of milligrams and micrometres is judged as one of tonnes and metres:

    size = max(|J|, SHARE J+),    J+ = sum of |terms| along the motion moved by the size of each variable.

J+ is what a motion costs that is one size away, with sizes from the motion itself (``robot.size.state_sizes``). A
control that is zero in the motion has the size that matters to a state: over the duration T it moves a state by its
size. For states with the rates f this is

    s_u = min_i s_i / (T |df_i/du|),

and for the torque of a joint its momentum (M v)_i by T.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import casadi as ca
import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.dynamics.point import AnyPoint
from robotraj.problem.objectives.base import Integral
from robotraj.problem.phase import Phase
from robotraj.problem.rows import phase_symbols
from robotraj.problem.sizes.motion_sizes import controls_that_matter
from robotraj.robot.size.state_sizes import state_sizes

SHARE = 1e-4
"""Least size of an objective relative to what a motion costs that is one size away."""


class SampledPhase(Protocol):
    """The planned trajectory of a phase."""

    @property
    def phase(self) -> Phase:
        """The phase."""

    @property
    def knots(self) -> Array:
        """Ends of the intervals (K + 1,) [s]."""

    @property
    def parameters(self) -> Mapping[str, float]:
        """Values of the phase's parameters."""

    def at(self, t: Array) -> Any:
        """Return the sample at times (m,)."""


def objective_size(phases: Sequence[SampledPhase], objective: float) -> float:
    """Return the size of an objective, above 0.

    Parameters
    ----------
    phases : sequence of PhaseSolution
    objective : float
        Its value.
    """
    with np.errstate(all="ignore"):
        away = sum(_cost_away(planned) for planned in phases)
    size = max(abs(objective), SHARE * away if np.isfinite(away) else 0.0)
    return size if size > 0.0 else 1.0


def size_for(error: float, share: float, phases: Sequence[SampledPhase], objective: float) -> float:
    """Return the size of an objective: its value, where an error is at most a share of that, without the terms."""
    return abs(objective) if error < share * abs(objective) else objective_size(phases, objective)


def _cost_away(planned: SampledPhase) -> float:
    """Return the sum of the absolute values of all terms one size away from the motion."""
    objective, dae = planned.phase.objective, planned.phase.dae
    if objective is None:
        return 0.0
    knots = np.asarray(planned.knots, dtype=float)
    times = np.unique(np.concatenate([knots, 0.5 * (knots[1:] + knots[:-1])]))
    sample = planned.at(times)
    kinds = ((sample.x, dae.states), (sample.z, dae.algebraic), (sample.u, dae.controls))
    values = [np.array([named[v.name] for v in kind]).reshape(len(kind), len(times)) for named, kind in kinds]
    sizes = [state_sizes([v.unit for v in kind], own.T) for (_, kind), own in zip(kinds, values, strict=True)]
    parameters = np.array([planned.parameters[name] for name in planned.phase.parameter_names], dtype=float)
    rows = [times[None], *values, np.tile(parameters[:, None], len(times))]
    # A size is 1 where the motion has none.
    unused = np.abs(values[2]).max(axis=1, initial=0.0) == 0.0
    mattering = _controls_that_matter(planned.phase, sample, sizes[0], rows)
    sizes[2] = np.where(unused, mattering, np.maximum(sizes[2], mattering))
    for row, size in zip(rows[1:4], sizes, strict=True):
        row += size[:, None]
    (first, start), (second, last) = _symbols(planned.phase), _symbols(planned.phase)
    rates, ends = [], []
    for weight, term in objective.terms:
        if isinstance(term, Integral):
            rates.append(ca.SX(weight * term.rate_of_motion(start)))
        else:
            ends.append(ca.SX(weight * term.value(start, last)))
    along = ca.Function("along", first, [ca.densify(ca.vertcat(ca.SX(0, 1), *rates))])
    between = ca.Function("between", [*first, *second], [ca.densify(ca.vertcat(ca.SX(0, 1), *ends))])
    integrals = np.trapezoid(np.abs(np.array(along.map(len(times))(*rows))), times, axis=1) if rates else np.zeros(0)
    at_ends = np.array(between(*(row[:, :1] for row in rows), *(row[:, -1:] for row in rows))) if ends else np.zeros(0)
    return float(integrals.sum() + np.abs(at_ends).sum())


def _controls_that_matter(phase: Phase, sample: Any, sizes: Array, rows: Sequence[Array]) -> Array:
    """Return the controls that move a state by its size over the phase, 0 where none does, (nu,).

    Parameters
    ----------
    sample : Sample
        The motion at the times.
    sizes : ndarray (nx,)
        Sizes of the states.
    rows : sequence of ndarray
        Times, x, z, u and p, a column for each time.
    """
    dae, robot = phase.dae, phase.robot
    duration = float(rows[0][0, -1] - rows[0][0, 0])
    if robot is not None and phase.path is None:
        model, data = robot.model, robot.model.createData()
        still = np.zeros(model.nv)
        momentum = np.zeros(model.nv)
        for q, v in zip(sample.q, sample.v, strict=True):
            moved = pin.rnea(model, data, q, still, v) - pin.rnea(model, data, q, still, still)
            momentum = np.maximum(momentum, np.abs(moved))
        of_joints = dict(zip(robot.velocity_names, momentum / duration, strict=True))
        return np.array([of_joints.get(v.joint or "", 0.0) for v in dae.controls])
    t, x, z, u, p = rows
    return controls_that_matter(dae, phase.parameter_names, sizes, (t[0], x.T, z.T, u.T, p[:, 0]))


def _symbols(phase: Phase) -> tuple[list[ca.SX], AnyPoint]:
    """Return symbols t, x, z, u, p of a phase, and its point of these symbols."""
    symbols = phase_symbols(phase.dae, phase.parameter_names)
    return list(symbols), phase.dae.point(*symbols, phase.parameter_names)
