"""Checks besides Pontryagin's equations: unsupported active constraints, and signs at an optimum."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.indirect.arcs import Side
from robotraj.indirect.costate_trajectory import PhaseCostates
from robotraj.indirect.polished import Polished
from robotraj.indirect.pontryagin import Pontryagin
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import PhaseRow

MULTIPLIER_TOLERANCE = 1e-3
"""Multipliers of a state or path constraint below this fraction of the largest costate count as zero."""
SIGN_TOLERANCE = 1e-6
"""Largest value of the wrong sign, as a fraction of the largest switching function."""
VIOLATION_TOLERANCE = 1e-7
"""Largest violation of a bound [its SI unit], relative to 1 + the bound."""
ACTIVE_DISTANCE = 1e-6
"""Distance from a bound, relative to 1 + the value, below which a row is active."""
SAMPLES = 12
"""Number of samples in an interval."""


def refuse_active_constraints(costates: PhaseCostates) -> None:
    """Raise InputError where a constraint on states, algebraic variables or a mixed path row is active.

    A constraint is active where it is at its bound and its multiplier is not negligible beside the costates.
    """
    duals, solution = costates.duals, costates.solution
    size = max(float(np.max(np.abs(v))) for v in duals.costate.values) + 1e-12
    breaks = duals.costate.breaks
    jumps = [a[0] - b[-1] for a, b in zip(duals.costate.values[1:], duals.costate.values[:-1], strict=True)]
    active = [
        float(t)
        for t, jump in zip(breaks[1:-1], jumps, strict=True)
        if np.max(np.abs(jump)) > MULTIPLIER_TOLERANCE * size
    ]
    for curve in (duals.states, duals.algebraic, duals.path):
        for k, (h, values) in enumerate(zip(np.diff(curve.breaks), curve.values, strict=True)):
            large = np.max(np.abs(values), axis=1, initial=0.0) * h > MULTIPLIER_TOLERANCE * size
            active += [float(t) for t in curve.breaks[k] + h * curve.sites[k][large]]
    if not active:
        return
    times = np.unique(active)
    held = ThroughoutRows(solution.phase, np.array(list(solution.parameters.values()), dtype=float))
    at = solution.trajectory
    of_controls = {row.number for row, _ in solution.phase.rows.bounds_of(solution.phase.dae.controls)}
    for row, value in held(times, at.x(times), at.z(times), at.u(times)):
        near = np.abs(value - row.lower) < ACTIVE_DISTANCE * (1.0 + np.abs(value))
        near |= np.abs(value - row.upper) < ACTIVE_DISTANCE * (1.0 + np.abs(value))
        if np.any(near) and row.number not in of_controls:
            raise InputError(
                f"polish supports active bounds on controls only, but {row.label} is active at t = "
                f"{times[np.argmax(near)]:.4g} s. Keep the direct solution, with a finer mesh, or relax "
                "that constraint."
            )


def violated_conditions(result: Polished, affine: NDArray[np.bool_]) -> list[str]:
    """Describe the optimality conditions that the extremal violates, a clause each; empty if there are none."""
    found: list[str] = []
    names = [control.name for control in result.equations.phase.dae.controls]
    lower, upper = result.equations.bounds
    samples = [_samples(result, k) for k in range(len(result.arcs))]
    largest = np.max([np.max(np.abs(s["by_u"]), axis=0) for s in samples], axis=0)
    for k, (arc, s) in enumerate(zip(result.arcs, samples, strict=True)):
        for i, side in enumerate(arc.sides):
            slope, u = s["by_u"][:, i], s["u"][:, i]
            if side is Side.INTERIOR:
                out = np.maximum(lower[i] - u, u - upper[i])
                if np.max(out) > VIOLATION_TOLERANCE * (1.0 + np.max(np.abs(u))):
                    t = s["t"][int(np.argmax(out))]
                    found.append(
                        f"{names[i]!r} violates its bounds by {np.max(out):.2g} at t = {t:.5g} s on arc {k + 1}"
                    )
                if not affine[i] and np.min(s["curvature"][:, i]) < 0:
                    t = s["t"][int(np.argmin(s["curvature"][:, i]))]
                    found.append(f"the Hamiltonian has no minimum in {names[i]!r} at t = {t:.5g} s")
                continue
            wrong = -slope if side is Side.LOWER else slope
            if np.max(wrong) > SIGN_TOLERANCE * (largest[i] + 1e-12):
                t = s["t"][int(np.argmax(wrong))]
                found.append(
                    f"{names[i]!r} is at its {side.value} at t = {t:.5g} s where dH/du has the wrong sign for this "
                    f"bound, |dH/du| = {np.max(wrong):.2g}; its arcs are not those of an optimum"
                )
        found += _violated_rows(result.equations, s)
    return found


def _samples(result: Polished, k: int) -> dict[str, Array]:
    """Return values along arc k: times, states, controls and derivatives of the Hamiltonian."""
    part, equations = result.trajectories[k], result.equations
    tau = (np.arange(SAMPLES) + 0.5) / SAMPLES
    times = (part.x.breaks[:-1, None] + np.diff(part.x.breaks)[:, None] * tau).ravel()
    y, u = result.on_arc(k, times)
    nx, free = equations.nx, len(equations.interior(result.arcs[k].sides))
    nz = len(equations.phase.dae.algebraic)
    a = part.z(times)[:, free:]
    m = len(times)
    values = equations.hamiltonian(
        t=times,
        x=y[:, :nx],
        z=a[:, :nz],
        u=u,
        p=np.tile(equations.parameters, (m, 1)),
        costate=y[:, nx : 2 * nx],
        nu=a[:, nz:],
        eta=np.zeros((m, equations.hamiltonian.symbols["eta"].numel())),
    )
    return values | {"t": times, "x": y[:, :nx], "z": a[:, :nz], "u": u}


def _violated_rows(equations: Pontryagin, s: dict[str, Array]) -> list[str]:
    """Describe the constraints over the whole phase that the extremal violates."""
    found = []
    for row, value in ThroughoutRows(equations.phase, equations.parameters)(s["t"], s["x"], s["z"], s["u"]):
        out = np.maximum(row.lower - value, value - row.upper)
        bound = min((abs(b) for b in (row.lower, row.upper) if np.isfinite(b)), default=0.0)
        if np.max(out) > VIOLATION_TOLERANCE * (1.0 + bound):
            unit = f" {row.unit}" if row.unit else ""
            found.append(
                f"{row.label} is violated by {np.max(out):.2g}{unit} at t = {s['t'][int(np.argmax(out))]:.5g} s"
            )
    return found


@dataclass(frozen=True, eq=False)
class ThroughoutRows(OneLine):
    """The rows of a phase that hold at all its times, with their values along a trajectory."""

    phase: Phase
    parameters: Array

    def __call__(self, t: Array, x: Array, z: Array, u: Array) -> list[tuple[PhaseRow, Array]]:
        """Return pairs of a row and its values (m,) at times (m,), states (m, nx), z and u."""
        table = self.phase.rows
        values = table.sample(table.throughout, t, x, z, u, self.parameters)
        return list(zip(table.throughout, values.T, strict=True))
