"""A solution on the coarse mesh along which no links overlap, from a free motion.

Rows are fixed along the last free motion, which meets them itself, so that every solve has a solution to start from.
Where a solve ends at a free motion, the rows are fixed anew along it: no row of an earlier one holds the plan back.
Where it overlaps, pairs without rows get some along the free motion, and the others where the two motions part. The
first state is a path around an overlap, or a motion that overlaps itself and is pushed out.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import field, replace

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.values import dataclass
from robotraj.guess.paths.around_itself import Motion
from robotraj.problem.clearance.own_shapes import MARGIN, least_at_ends
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.collision.along_motion import freed
from robotraj.robot.collision.own_body import OwnBody
from robotraj.solution.solution import Solution
from robotraj.transcription.clearance.surface_rows import NearPair, NearSurfaces

Bodies = Sequence[OwnBody | None]

SHALLOW = 0.01
"""Depth of an overlap up to which rows along the motion push it out [m]."""
REACH = 0.03
"""Distance of links up to which a motion that overlaps has rows; those of a free motion reach everywhere [m]."""
GAIN = 1e-2
"""Least relative gain of the objective, or of the depth of overlaps, for which rows are fixed anew."""


@dataclass(frozen=True, eq=False)
class FreeSearch:
    """State of the search for one plan without overlaps.

    Attributes
    ----------
    problem : Problem
    bodies : sequence of OwnBody or None
        Shapes of each phase.
    motions : tuple of callable
        From fractions of each phase to configurations: the motions along which rows are fixed.
    are_free : bool
        Whether they are free of overlaps.
    pairs : tuple of frozenset of int
        Pairs with rows along them.
    further : tuple of tuple of NearPair
        Rows where solutions overlapped since.
    start : InitialGuess or Solution
        Where the next solve starts.
    best : Solution or None
        Best solution without overlaps.
    behind : FreeSearch or None
        The state at whose rows it ends. A plan with rows along the best solution may leave it, one with these does not.
    is_over : bool
        Whether no further solve is expected to gain anything.
    along : dict of (int, int) to NearPair
        Rows along ``motions`` by phase and pair, which are fixed once for all solves along them.
    """

    problem: Problem
    bodies: Bodies
    motions: tuple[Motion, ...]
    are_free: bool
    pairs: tuple[frozenset[int], ...]
    further: tuple[tuple[NearPair, ...], ...]
    start: InitialGuess | Solution
    best: Solution | None = None
    behind: FreeSearch | None = None
    is_over: bool = False
    along: dict[tuple[int, int], NearPair] = field(default_factory=dict, repr=False)

    @classmethod
    def begin(
        cls,
        problem: Problem,
        bodies: Bodies,
        motions: Sequence[Motion],
        are_free: bool,
        pairs: Sequence[Collection[int]],
        start: InitialGuess | Solution,
    ) -> FreeSearch:
        """Return the first state, with rows of the pairs that overlapped."""
        held = tuple(map(frozenset, pairs))
        return cls(problem, bodies, tuple(motions), are_free, held, tuple(() for _ in held), start)

    @property
    def surfaces(self) -> list[NearSurfaces | None]:
        """Rows of the next solve."""
        from robotraj.transcription.clearance.surface_rows import FRACTIONS, NearPair, NearSurfaces

        found: list[NearSurfaces | None] = []
        for number, (phase, body, motion, held, more) in enumerate(
            zip(self.problem.phases, self.bodies, self.motions, self.pairs, self.further, strict=True)
        ):
            if phase.robot is None or body is None or phase.path is not None or not (held or more):
                found.append(None)
                continue
            reach = np.inf if self.are_free else REACH
            new = [pair for pair in sorted(held) if (number, pair) not in self.along]
            q = motion(FRACTIONS) if new else np.zeros((0, phase.robot.nq))
            for pair in new:
                self.along[number, pair] = NearPair(pair, q, MARGIN, least_at_ends(phase, body, pair), reach)
            own = [self.along[number, pair] for pair in sorted(held)]
            found.append(NearSurfaces(phase.robot, body, (*own, *more)))
        return found

    def respond(
        self, solution: Solution, motions: Sequence[Motion], hit: Sequence[Mapping[int, float]], cost: float = np.inf
    ) -> FreeSearch:
        """Return the next state after a solve, whose motions overlap in pairs ``hit`` of each phase, by depths [m].

        Its rows may ``cost`` that much of its objective (``held_back``).
        """
        best = self.best
        if best is not None and solution.objective >= best.objective - GAIN * abs(best.objective):
            # Even with overlaps it gains too little, and with rows against them less.
            return replace(self.overlapped(motions, hit) if any(hit) else self, is_over=True)
        if any(hit):
            shallow = all(depth <= SHALLOW for depths in hit for depth in depths.values())
            further = self.overlapped(motions, hit)
            return replace(further, start=solution) if shallow else further
        nothing = tuple(() for _ in motions)
        fixed = replace(self, motions=tuple(motions), are_free=True, further=nothing, start=solution, along={})
        return replace(fixed, best=solution, behind=self, is_over=cost <= GAIN * abs(solution.objective))

    def overlapped(self, motions: Sequence[Motion], hit: Sequence[Mapping[int, float]]) -> FreeSearch:
        """Return the state with further rows against motions that overlap in pairs ``hit``, by depths [m].

        A pair that overlaps although it has such rows comes that much nearer than they let it.
        """
        from robotraj.transcription.clearance.surface_rows import FRACTIONS, NearPair

        further = []
        for phase, body, motion, free, pairs, held, known in zip(
            self.problem.phases, self.bodies, motions, self.motions, hit, self.pairs, self.further, strict=True
        ):
            more = list(known)
            # Where the motion is free, pairs without rows get some along that first.
            parted = set(pairs) & held if self.are_free else pairs
            for pair in sorted(parted) if body is not None and phase.path is None else ():
                q = _freed_at(phase, body, pair, motion, free if self.are_free else None, FRACTIONS)
                last = max((row.margin + pairs[pair] for row in more if row.pair == pair), default=MARGIN)
                margin = last + MARGIN
                more.append(NearPair(pair, q, margin, least_at_ends(phase, body, pair), REACH))
            further.append(tuple(more))
        every = tuple(held | frozenset(pairs) for held, pairs in zip(self.pairs, hit, strict=True))
        return replace(self, pairs=every, further=tuple(further))


def _freed_at(phase: Phase, body: OwnBody, pair: int, known: Motion, free: Motion | None, fractions: Array) -> Array:
    """Return a motion's configurations, moved towards those of a free one until a pair is free."""
    q = known(fractions)
    if free is None or phase.robot is None:
        return q
    return freed(phase.robot, body, pair, q, free(fractions), 2.0 * MARGIN)
