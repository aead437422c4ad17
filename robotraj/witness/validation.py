"""The proof of a plan: simulate it with code that did not make it, and look between its knots."""

from __future__ import annotations

import numpy as np

from robotraj._util.errors import InputError, require_solution
from robotraj.witness import energy as energies
from robotraj.witness.holding import holding_of
from robotraj.witness.impact import impacts_of
from robotraj.witness.open_loop import open_loop
from robotraj.witness.peak import largest
from robotraj.witness.protocols import SolutionLike
from robotraj.witness.report import Report, Tolerances
from robotraj.witness.residual import Residual, residual_of
from robotraj.witness.violations import violations_of


def validate(
    solution: SolutionLike,
    *,
    rtol: float = 1e-10,
    atol: float = 1e-12,
    samples_per_interval: int = 25,
    drift: float | None = 1e-3,
    limits: float = 1e-3,
    energy: float | None = None,
    residual: float | None = None,
    phase_drift: float | None = 1e-3,
    contact: float | None = 1e-4,
    forces: float | None = 1e-3,
) -> Report:
    """Simulate a plan open loop and check it between its knots.

    A robot moves by plain double-precision Pinocchio, M(q) a + h(q, v) = B tau(t) - d(v), a System by its own
    equations on numbers (algebraic variables solved for at every evaluation), from the plan's first state
    through all phases, under the planned controls alone. DOP853 integrates, restarted at every knot; LSODA
    from the first interval on that is too stiff for it, as the friction of light wrists makes it.

    Where contacts hold, M a + h = B tau - d + J' f and J a + (dJ/dt) v = 0 move the robot, the state is put back on the
    held rows at every knot, and where the plan switches to contacts that touch down, M (v+ - v-) = J' L, J v+ = 0 bring
    them to rest where the simulation has them. Slip, sink, cones and centre of pressure are looked at between the
    knots, along the planned polynomials, with the planned forces and with those that the equations give under the
    planned q, v and tau.

    Parameters
    ----------
    solution : Solution
        A failed one can be validated too.
    rtol, atol : float
        Tolerances of the simulation's steps.
    samples_per_interval : int
        Points of every interval at which drift, limits, constraints and residuals are looked at.
    drift, limits, energy, residual, phase_drift, contact, forces : float or None
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
    require_solution(solution, "rt.validate")
    if not solution.phases:
        raise InputError("There is nothing to validate: the solution has no phases.")
    if samples_per_interval < 2:
        raise InputError(f"samples_per_interval is {samples_per_interval}; look at 2 points of an interval or more.")
    simulated = open_loop(solution, rtol, atol, samples_per_interval)
    residuals = [residual_of(planned, samples_per_interval) for planned in solution.phases]
    robots = [planned for planned in solution.phases if planned.phase.robot is not None]
    balances = [energies.energy_of(planned) for planned in robots]
    broken = [v for planned in solution.phases for v in violations_of(planned, samples_per_interval)]
    knots = [np.asarray(planned.knots, dtype=float) for planned in solution.phases]
    return Report(
        drift=simulated.drift,
        violations=tuple(sorted(broken, key=lambda v: -v.amount)),
        energy=energies.add(balances),
        residual=Residual(*(largest(getattr(r, of) for r in residuals) for of in ("dynamics", "rate", "jumps"))),
        failure=simulated.failure,
        tolerances=Tolerances(drift, limits, energy, residual, phase_drift, contact, forces),
        duration=float(sum(k[-1] - k[0] for k in knots)),
        intervals=sum(len(k) - 1 for k in knots),
        phases=tuple(planned.phase.name for planned in solution.phases),
        rtol=rtol,
        atol=atol,
        unchecked=tuple(
            name for name in solution.problem.missing if name.startswith(("constraint ", "link ", "the equations "))
        ),
        restarted=simulated.restarted,
        landings=simulated.landings,
        holdings=tuple(h for p in robots for h in holding_of(p, samples_per_interval)),
        impacts=impacts_of(solution),
        stiff=simulated.stiff,
    )
