"""Solves from a plan on meshes twice as fine.

Nothing is taken over from the plan but its motion: meshes, limits between the points, tolerance and barrier are this
module's own, and multipliers are estimated anew. No other module of the witness shares code with the planner, and this
one shares the transcription and the interior-point method. With a mistake there a better motion may not be found. None
is invented, since a validation judges each motion that counts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from robotraj._util.arrays import Array
from robotraj.guess.from_solution import FromSolution
from robotraj.native.engines.native import Native
from robotraj.solution.phase_solution import PhaseSolution, alike
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Outcome
from robotraj.solvers.interior_point import InteriorPoint
from robotraj.transcription.clearance.clearance_rows import Clearances
from robotraj.transcription.clearance.links_along import LinksAlong
from robotraj.transcription.clearance.supporting_planes import motion_of
from robotraj.transcription.clearance.surface_rows import with_surface_rows
from robotraj.transcription.extract import extract
from robotraj.transcription.interval_limits.added_rows import rows_against_swings, with_added_rows
from robotraj.transcription.interval_limits.interval_violations import EXACT, state_violations, variable_violations
from robotraj.transcription.interval_limits.margins import with_margins
from robotraj.transcription.interval_limits.methods import BernsteinBounds
from robotraj.transcription.interval_limits.row_places import LimitedInterval
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.refinement.equidistribution import evenly_finer
from robotraj.transcription.reuse import continued_at
from robotraj.transcription.schemes.lobatto import HermiteSimpson
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.schemes.onestep import OneStep
from robotraj.transcription.smoothness.smoothing import SMOOTHING
from robotraj.transcription.transcribe import transcribe

FINER = 2.0
"""Growth of the number of intervals."""
FLAT = 0.1
"""Share of the allowed gain below which eight iterations end a solve."""
PATIENCE = 150
"""Most iterations of a solve: three times those of most plans."""
ROUNDS = 5
"""Most solves. Those after the first one only correct a motion that costs less."""
MORE = 1.2
"""Ratio of a margin to the excess; above 1, since the motion changes with the margin."""


def finer_motions(plan: Solution, allowed: float, clock: Callable[[], None]) -> Iterator[Solution]:
    """Yield motions from a plan, each with less excess over its limits between the points than the one before.

    The first one that does not exceed its limits is the last one. Statuses are those of the solver.

    Parameters
    ----------
    plan : Solution
    allowed : float
        Gain of the objective that is of interest, as a share of it.
    clock : callable
        Called once an iteration; may raise.

    Raises
    ------
    InputError
        The problem cannot be transcribed.
    """
    rows = _FinerProgram(plan)
    solver = InteriorPoint(objective_change=FLAT * allowed).from_nearby().at_most(PATIENCE)
    solver = solver.accurate_to(FLAT * FLAT * allowed)
    w = rows.base.guess
    for _ in range(ROUNDS):
        nlp = rows.program(w)
        outcome = solver.solve(nlp, lambda _: clock())
        found = _motion(plan, nlp, outcome)
        yield found
        clock()
        apart, tightened = rows.set_apart(found), rows.tightened(found)
        if not apart and not tightened:
            return
        # The plan meets all rows on its links, a motion through one of them none.
        w = rows.base.guess if apart else outcome.w[: len(w)]


class _FinerProgram:
    """The rows of a problem on the finer meshes, from solve to solve: limits that are exceeded are tightened.

    Parameters
    ----------
    plan : Solution
    """

    def __init__(self, plan: Solution) -> None:
        guess, limits = FromSolution(plan), BernsteinBounds(controls=True, positions=True)
        meshes = [_finer(part) for part in plan.phases]
        nlp = transcribe(plan.problem, meshes, guess, Native(), limits, SMOOTHING)
        between = rows_against_swings(nlp)
        self.base = with_added_rows(nlp, between, nlp.guess) if between else nlp
        self._margins: dict[LimitedInterval, float] = {}
        self._links = [LinksAlong(part.phase, part.joint_states) for part in plan.phases]
        self._obstacles = _obstacles(nlp)
        self._kept: list[dict[tuple[int, int], float]] = [{} for _ in self._obstacles]
        self._motions = [motion_of(plan.phases[o.phase].joint_states, o.pairs.robot.nq) for o in self._obstacles]

    def program(self, w: Array) -> Nlp:
        """Return the program that starts at w (n_w,)."""
        nlp = with_margins(continued_at(self.base, w), self._margins)
        nlp = with_surface_rows(nlp, [links.surfaces for links in self._links])
        if not self._obstacles:
            return nlp
        from robotraj.transcription.clearance.clearance_rows import with_rows_along
        from robotraj.transcription.clearance.near_pairs import NEAR_SOLUTION

        return with_rows_along(nlp, self._obstacles, self._motions, self._kept, NEAR_SOLUTION)

    def set_apart(self, found: Solution) -> bool:
        """Add rows on links that overlap along a motion, and return whether there are new ones."""
        return any([links.add(part.joint_states) for links, part in zip(self._links, found.phases, strict=True)])

    def tightened(self, found: Solution) -> bool:
        """Tighten what a motion exceeds between the points, and return whether it exceeds anything."""
        parts, exceeds = found.phases, False
        for i, part in enumerate(parts):
            others = alike(part, parts)
            excess = variable_violations(part.phase, i, part.trajectory, part.inputs, others)
            for each in (*excess, *state_violations(part.phase, i, part.trajectory, EXACT, others)):
                place = LimitedInterval(i, each.interval, each.row.number)
                self._margins[place] = self._margins.get(place, 0.0) + MORE * each.amount
                exceeds = True
        for own, kept in zip(self._obstacles, self._kept, strict=True):
            from robotraj.transcription.clearance.proof import shortfalls

            short = shortfalls(own.pairs, parts[own.phase].joint_states)
            for interval, pair, distance in zip(short.intervals, short.pairs, short.distances, strict=True):
                where = int(interval), int(pair)
                kept[where] = kept.get(where, 0.0) + MORE * (own.pairs.margin - float(distance))
                exceeds = True
        return exceeds


def _obstacles(nlp: Nlp) -> Sequence[Clearances]:
    """Return the pairs of links and obstacles that rows keep apart; on a path no row can."""
    if not any(each.avoids_collisions for phase in nlp.problem.phases for each in phase.constraints):
        return []
    from robotraj.transcription.clearance.clearance_rows import clearances

    return [own for own in clearances(nlp) if nlp.problem.phases[own.phase].path is None]


def _finer(part: PhaseSolution) -> Mesh:
    """Return a mesh with each interval of a phase halved; states at all points are unknowns."""
    schemes = [HermiteSimpson() if isinstance(scheme, OneStep) else scheme for scheme in part.mesh.schemes]
    are_equal = all(scheme == schemes[0] for scheme in schemes)
    fractions = (part.knots - part.t0) / part.duration
    fractions[[0, -1]] = 0.0, 1.0
    return evenly_finer(Mesh(tuple(fractions.tolist()), schemes[0] if are_equal else tuple(schemes)), FINER)


def _motion(plan: Solution, nlp: Nlp, outcome: Outcome) -> Solution:
    parts = zip(nlp.problem.phases, nlp.layouts, extract(nlp, outcome.w), strict=True)
    phases = tuple(PhaseSolution(phase, layout.mesh, trajectory) for phase, layout, trajectory in parts)
    impulses = tuple(
        {unknown.name: float(value) for unknown, value in zip(link.unknowns, outcome.w[columns], strict=True)}
        for link, columns in zip(nlp.problem.bound_links, nlp.link_columns, strict=True)
    )
    return replace(
        plan, phases=phases, impulses=impulses, status=outcome.status, message=outcome.message, proof=None, duals=()
    )
