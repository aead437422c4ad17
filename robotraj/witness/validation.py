"""The proof of a plan: simulate it with code that did not make it, and look between its knots."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj.errors import InputError
from robotraj.witness import drift as drifts
from robotraj.witness import energy as energies
from robotraj.witness.drift import Drift, DriftRow, drift_of
from robotraj.witness.integration import integrate
from robotraj.witness.peak import largest
from robotraj.witness.plant import plant_of
from robotraj.witness.protocols import Array, SolutionLike
from robotraj.witness.report import Report, Tolerances
from robotraj.witness.residual import Residual, residual_of
from robotraj.witness.violations import violations_of


def validate(
    solution: SolutionLike,
    *,
    rtol: float = 1e-10,
    atol: float = 1e-12,
    samples_per_interval: int = 25,
    drift: float = 1e-3,
    limits: float = 1e-3,
    energy: float | None = None,
    residual: float | None = None,
) -> Report:
    """Simulate a plan open loop and check it between its knots.

    A robot moves by plain double-precision Pinocchio, M(q) a + h(q, v) = B tau(t) - d(v), a System by its own
    equations on numbers (algebraic variables solved for at every evaluation), from the plan's first state
    through all phases, under the planned controls alone. DOP853 integrates, restarted at every knot.

    Parameters
    ----------
    solution : Solution
        A failed one can be validated too.
    rtol, atol : float
        Tolerances of the simulation's steps.
    samples_per_interval : int
        Points of every interval at which drift, limits, constraints and residuals are looked at.
    drift, limits, energy, residual : float or None
        Thresholds of ``Report.passed``, see ``Tolerances``; None reports without judging.

    Returns
    -------
    Report
        A simulation that blows up is reported in it, not raised.

    Raises
    ------
    InputError
        The solution has no phases, ``samples_per_interval`` is below 2, a constraint does not give numbers.
    """
    if not solution.phases:
        raise InputError("There is nothing to validate: the solution has no phases.")
    if samples_per_interval < 2:
        raise InputError(f"samples_per_interval is {samples_per_interval}; look at 2 points of an interval or more.")
    drifted, failure = _simulate(solution, rtol, atol, samples_per_interval)
    residuals = [residual_of(planned, samples_per_interval) for planned in solution.phases]
    balances = [energies.energy_of(planned) for planned in solution.phases if planned.phase.robot is not None]
    broken = [v for planned in solution.phases for v in violations_of(planned, samples_per_interval)]
    knots = [np.asarray(planned.knots, dtype=float) for planned in solution.phases]
    return Report(
        drift=drifted,
        violations=tuple(sorted(broken, key=lambda v: -v.amount)),
        energy=energies.add(balances),
        residual=Residual(*(largest(getattr(r, of) for r in residuals) for of in ("dynamics", "rate", "jumps"))),
        failure=failure,
        tolerances=Tolerances(drift, limits, energy, residual),
        duration=float(sum(k[-1] - k[0] for k in knots)),
        intervals=sum(len(k) - 1 for k in knots),
        phases=tuple(planned.phase.name for planned in solution.phases),
        rtol=rtol,
        atol=atol,
        unchecked=tuple(
            name for name in solution.problem.missing if name.startswith(("constraint ", "link ", "the equations "))
        ),
    )


def _simulate(solution: SolutionLike, rtol: float, atol: float, samples: int) -> tuple[Drift, str | None]:
    """Drift through all phases, and why the simulation stopped early if it did.

    The simulated state is handed on where the next phase has the same states, so that a jump of the plan
    between phases shows as drift; where a link lets states jump, the planned jump is added. A phase with other
    states starts from its own plan.
    """
    rows: list[tuple[DriftRow, ...]] = []
    x: Array | None = None
    names: tuple[str, ...] = ()
    last = np.zeros(0)
    for i, planned in enumerate(solution.phases):
        plant = plant_of(planned)
        knots = np.asarray(planned.knots, dtype=float)
        if x is None or plant.names != names:
            x = plant.states(knots[:1], 0)[0]
        elif free := _free_to_jump(solution, i, names):
            jump = plant.states(knots[:1], 0)[0] - last
            x = x + np.where([name in free for name in names], jump, 0.0)
        motion = integrate(plant.rates, x, knots, rtol=rtol, atol=atol, samples_per_interval=samples)
        rows.append(drift_of(plant, motion, planned.phase.name))
        if motion.failure is not None:
            where = f"phase {planned.phase.name!r}, t = {motion.stopped:.4g} s"
            return drifts.merge(rows), f"{where}: {motion.failure}"
        x, names = motion.states[-1], plant.names
        last = plant.states(knots[-1:], len(knots) - 2)[0]
    return drifts.merge(rows), None


def _free_to_jump(solution: SolutionLike, phase: int, names: Sequence[str]) -> set[str]:
    """States that the links between the phase before and this one do not hold continuous; none without a link."""
    between = [link for link in solution.problem.bound_links if tuple(link.phases) == (phase - 1, phase)]
    if not between:
        return set()
    return set(names) - {row.joint for link in between for row in link.rows if row.name == "continuity"}
