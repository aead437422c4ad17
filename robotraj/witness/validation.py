"""Validation of a plan: independent simulation, and checks between its knots."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TypedDict, TypeVar

import numpy as np

from robotraj._util.checks import number, whole
from robotraj._util.curves.teeth import SMOOTH
from robotraj._util.errors import InputError, require_solution
from robotraj._util.system.interrupts import heeded
from robotraj.solution.reserves.shares import shares_of
from robotraj.solution.violation import Violation
from robotraj.witness.checks import energy as energies
from robotraj.witness.checks.clearance import clearance_of
from robotraj.witness.checks.links import link_violations
from robotraj.witness.checks.residual import Residual, residual_of
from robotraj.witness.checks.self_collision import own_body_of
from robotraj.witness.checks.smoothness import teeth_of
from robotraj.witness.checks.torques import rate_error, torque_error
from robotraj.witness.checks.violations import FEW_SAMPLES, violations_of
from robotraj.witness.clock import OutOfTime, ProcessorClock
from robotraj.witness.contacts.foot_order import foot_orders_of
from robotraj.witness.contacts.ground import swings_of
from robotraj.witness.contacts.impact import impacts_of
from robotraj.witness.contacts.links_over_ground import link_depths_of
from robotraj.witness.contacts.slip_and_friction import holding_of
from robotraj.witness.cost.objective import objective_check
from robotraj.witness.cost.second_solve import SecondSolve, second_solve
from robotraj.witness.figures import Tolerances
from robotraj.witness.peak import largest
from robotraj.witness.plants.sizes import named_sizes, sizes_of
from robotraj.witness.protocols import SolutionLike
from robotraj.witness.report import Report
from robotraj.witness.robustness.followed import Followed
from robotraj.witness.robustness.followed import followed as follow
from robotraj.witness.simulation.closed_loop import closed_loop_of
from robotraj.witness.simulation.coulomb import coulomb_drift, has_dry_friction, keeps_smooth_law
from robotraj.witness.simulation.local_error import local_errors
from robotraj.witness.simulation.open_loop import open_loop

Found = TypeVar("Found")

LOCAL_RTOL, LOCAL_ATOL = 1e-6, 1e-6
"""Tolerances of simulations whose errors do not grow: a thousandth of the thresholds."""

LEAST_RTOL = 1e-13
"""Smallest relative tolerance of a step: above the rounding of DOP853's sums."""
MOST_SAMPLES = 10_000
"""Largest number of points of an interval."""
TIME_LIMIT = 60.0
"""Processor time [s] that a validation may take by default."""


class ValidationOptions(TypedDict, total=False):
    """Options of ``rt.validate`` by name, for functions that pass them on."""

    rtol: float
    atol: float
    samples_per_interval: int
    local: float | None
    tracking: float | None
    limits: float
    contact: float | None
    forces: float | None
    force_error: float | None
    ground: float | None
    energy: float | None
    residual: float | None
    drift: float | None
    torques: float | None
    objective: float | None
    optimum: float | None
    friction: float | None
    smoothness: float | None
    followed: float | None
    time_limit: float | None


@heeded
def validate(
    solution: SolutionLike,
    *,
    rtol: float = 1e-8,
    atol: float = 1e-10,
    samples_per_interval: int = 25,
    local: float | None = 1e-3,
    tracking: float | None = 1e-2,
    limits: float = 1e-3,
    contact: float | None = 1e-4,
    forces: float | None = 1e-3,
    force_error: float | None = 2e-2,
    ground: float | None = 1e-3,
    energy: float | None = None,
    residual: float | None = None,
    drift: float | None = None,
    torques: float | None = 5e-3,
    objective: float | None = 2e-3,
    optimum: float | None = 3e-3,
    friction: float | None = 2e-2,
    smoothness: float | None = SMOOTH,
    followed: float | None = None,
    time_limit: float | None = TIME_LIMIT,
) -> Report:
    """Validate a plan by independent code and report what is wrong with it.

    Plain double-precision Pinocchio simulates robots, M(q) a + h(q, v) = B tau(t) - d(v), Systems move by
    their own equations on numbers (algebraic variables are solved for at every evaluation). Where contacts hold,
    M a + h = B tau - d + J' f and J a + (dJ/dt) v = 0. DOP853 integrates; where the motion is
    stiff, an L-stable SDIRK method of order 4 does.

    The claims of ``Report.claims`` decide (``witness.claims``):

    - the local error: short parts of the plan are simulated one by one, each from the plan's own state;
    - torques and contact forces are those of the planned motion, by inverse dynamics;
    - no torque or other control alternates with the mesh by more than 2 percent of its limit;
    - the stated objective is the cost of the motion;
    - no motion nearby costs less: a second solve starts from a proved plan, on meshes twice as fine;
    - limits, constraints, links, boundary conditions and contacts, between the knots too; and impacts,
      M (v+ - v-) = J' L, J v+ = 0;
    - distances of the exact shapes from obstacles and each other, by coal, for every ``CollisionFree``;
    - overlaps of the robot's own links as solids, unless the phase has ``self_collision=False``;
    - contact forces: those of the plan against those of the equations;
    - the ground: feet that swing stay above it, and land from above, and so do all other links; left feet stay on the
      left of right ones;
    - tracking: the robot follows the whole plan with ``solution.gains``, time-varying linear feedback;
    - a machine with Coulomb's friction, which may stick, follows each phase within the limits of effort;
    - following, if ``followed=`` gives a deviation: MuJoCo's robot under ``LinearQuadratic()``;
    - the mirrored half of a gait, simulated as a motion of its own: the inertia of a robot is seldom symmetric.

    The open-loop drift is reported but not judged; the growth of a small error along the plan explains it.

    Parameters
    ----------
    solution : Solution
        Failed solutions are accepted.
    rtol, atol : float
        Tolerances of the steps of the open-loop simulation; those of the other simulations are 1e-6.
    samples_per_interval : int
        Points of every interval at which limits, constraints and residuals are evaluated.
    local, tracking, limits, ... : float or None
        Thresholds of ``Report.passed``, see ``Tolerances``; None does not judge the figure.
    time_limit : float or None
        Processor time [s] after which no further check begins; the report lists the missing checks.

    Returns
    -------
    Report
        A diverging simulation is reported in it, not raised.

    Raises
    ------
    InputError
        The solution has no phases, a number is out of its range, or a constraint does not return numbers.
    """
    require_solution(solution, "rt.validate")
    if not solution.phases:
        raise InputError("The solution has no phases: there is nothing to validate; plan a problem with a phase.")
    samples = whole("samples_per_interval", samples_per_interval, 2, MOST_SAMPLES)
    number("rtol", rtol, LEAST_RTOL, 1.0), number("atol", atol, sys.float_info.min, 1.0)
    clock = ProcessorClock(None if time_limit is None else number("time_limit", time_limit, 0.0, unit="s"))
    tolerances = Tolerances(
        local=local,
        tracking=tracking,
        limits=limits,
        contact=contact,
        forces=forces,
        force_error=force_error,
        ground=ground,
        energy=energy,
        residual=residual,
        drift=drift,
        torques=torques,
        objective=objective,
        optimum=optimum,
        friction=friction,
        smoothness=smoothness,
        followed=followed,
    )
    few = min(FEW_SAMPLES, samples)
    skipped: list[str] = []
    unseen: list[str] = []

    def within(what: str, check: Callable[[], Found], judged: bool) -> Found | None:
        try:
            clock()
            return check()
        except OutOfTime:
            (skipped if judged else unseen).append(what)
            return None

    phases = solution.phases
    robots = [planned for planned in phases if planned.phase.robot is not None]

    def violations() -> Iterator[Violation]:
        for planned, sizes in zip(phases, named_sizes(solution), strict=True):
            yield from violations_of(planned, samples, sizes, clock, phases)

    broken = within(
        "limits and constraints",
        lambda: [*link_violations(solution), *violations()],
        True,
    )
    distances = within("distances", lambda: [clearance_of(p, clock) for p in robots], True) or []
    bodies = within("self-collision", lambda: [own_body_of(p, clock) for p in robots], True) or []
    broken = [*(broken or ()), *(violation for _, short, _ in distances for violation in short)]
    locally = within("local error", lambda: local_errors(solution, LOCAL_RTOL, LOCAL_ATOL, clock), local is not None)
    holdings = within("contacts", lambda: [h for p in robots for h in holding_of(p, samples, clock)], True)
    impacts = within("impacts", lambda: impacts_of(solution), True)
    orders = within("lateral order of the feet", lambda: foot_orders_of(solution, few, clock), True)
    shares = within("shares of cone, sole, torque and speed", lambda: shares_of(phases), False)
    swings = within("swinging feet", lambda: swings_of(solution, samples, clock), True)
    over = within("links over the ground", lambda: link_depths_of(solution, swings or (), few, clock), True)
    depths, oversized = over or ((), ())
    tracked = within("tracking", lambda: closed_loop_of(solution, LOCAL_RTOL, LOCAL_ATOL, clock), tracking is not None)
    loads = within("torques", lambda: torque_error(phases, clock, solution.proof is not None), torques is not None)
    rates = within("rates", lambda: rate_error(phases, sizes_of(solution)), torques is not None)
    rough = within("model", lambda: coulomb_drift(solution, clock), friction is not None)
    toothed = within("smoothness", lambda: teeth_of(phases, clock), smoothness is not None)
    cost = within("objective", lambda: objective_check(solution, clock), objective is not None)
    again = within("a second solve", lambda: _solved_again(solution, tolerances, clock), optimum is not None)
    residuals = within(
        "residuals between collocation points",
        lambda: [residual_of(p, samples, clock) for p in phases],
        residual is not None,
    )
    balances = within("energy", lambda: [energies.energy_of(p, clock=clock) for p in robots], energy is not None)
    drifted = within("open-loop drift", lambda: open_loop(solution, rtol, atol, clock), drift is not None)
    followed_by = within("followed", lambda: _followed(solution, followed), followed is not None)
    knots = [np.asarray(planned.knots, dtype=float) for planned in phases]
    lost = [n for n in solution.problem.missing if n.startswith(("constraint ", "link ", "the equations "))]
    unkept = (
        [f"{', '.join(lost)}, because the file does not contain it: give problem= to rt.load_solution"] if lost else []
    )
    late = [f"{', '.join(skipped)}, because the time limit of {time_limit} s was reached"] if skipped else []
    return Report(
        local=locally,
        closed_loop=tracked,
        drift=None if drifted is None else drifted.drift,
        breaches=tuple(sorted(broken, key=lambda v: -v.relative)),
        energy=energies.add(balances or ()),
        residual=Residual(*(largest(getattr(r, of) for r in residuals or ()) for of in ("dynamics", "rate", "jumps"))),
        failure=None if drifted is None else drifted.failure,
        tolerances=tolerances,
        duration=float(sum(k[-1] - k[0] for k in knots)),
        intervals=sum(len(k) - 1 for k in knots),
        phases=tuple(planned.phase.name for planned in phases),
        rtol=rtol,
        atol=atol,
        seconds=clock.seconds,
        unchecked=(*unkept, *late),
        unseen=tuple(unseen),
        landings=() if drifted is None else drifted.landings,
        holdings=tuple(holdings or ()),
        impacts=tuple(impacts or ()),
        foot_orders=tuple(orders or ()),
        shares=tuple(shares or ()),
        swings=tuple(swings or ()),
        link_depths=depths,
        stiff=None if drifted is None else drifted.stiff,
        torques=loads,
        rates=rates,
        teeth=toothed,
        friction=rough,
        followed=followed_by,
        objective=cost,
        second=again,
        proof=solution.proof,
        moves_robot=bool(robots),
        has_friction=any(map(has_dry_friction, phases)),
        keeps_smooth_law=any(map(keeps_smooth_law, phases)),
        avoids_collisions=any(each.avoids_collisions for p in robots for each in p.phase.constraints),
        clearances=tuple(each for nearest, _, _ in distances for each in nearest),
        self_collisions=tuple(each for body in bodies for each in body.overlaps),
        own_distances=tuple(body.nearest for body in bodies if body.nearest is not None),
        unguarded=tuple(dict.fromkeys(each for body in bodies for each in body.unjudged)),
        left_out=tuple(
            dict.fromkeys(
                [
                    *(each for body in bodies for each in body.left_out),
                    *(each for *_, exempt in distances for each in exempt),
                    *oversized,
                ]
            )
        ),
    )


def _followed(solution: SolutionLike, near: float | None) -> Followed | None:
    """Let MuJoCo's robot follow the plan, if a deviation is allowed."""
    return None if near is None else follow(solution, near=near)


def _solved_again(solution: SolutionLike, tolerances: Tolerances, clock: ProcessorClock) -> SecondSolve | None:
    """Solve once more from a plan that claims an optimum; a motion that costs less is validated in turn."""
    proof, allowed = solution.proof, tolerances.optimum
    if proof is None or allowed is None or not proof.unsettled <= proof.goals.objective:
        return None
    found = second_solve(solution, max(allowed, proof.goals.objective), clock)
    if found.better is None:
        return found
    thresholds = {**vars(tolerances), "optimum": None, "followed": None}
    report = validate(found.better, **thresholds, time_limit=clock.left)
    return replace(found, faults=report.failures(report.tolerances))
