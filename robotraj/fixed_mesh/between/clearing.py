"""Rounds of rows on distances: added where pairs come near, raised where the proof between the points falls short."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj.guess.from_solution import FromSolution
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.phase import Phase
from robotraj.solution.solution import Solution
from robotraj.solution.violation import Violation
from robotraj.transcription.clearance.clearance_rows import Clearances
from robotraj.transcription.clearance.proof import Shortfalls
from robotraj.transcription.clearance.supporting_planes import Motion
from robotraj.transcription.nlp import Nlp

ROUNDS = 10
"""Solves with further or raised rows on one mesh."""
ROUGH_SHORTFALL = 2e-2
"""Shortfall of a distance that is allowed on a first mesh, which only approximates the motion [m].

No distance is raised by more in one round."""
MORE = 1.2
"""Ratio of the raise of a distance to its shortfall; above 1, since the motion changes with the raise."""
GAIN = 3e-3
"""Relative change of the objective by the planes of the last motion, below which a mesh needs no others."""
ACTIVE = 1e-4
"""Distance above its bound up to which a row is active [m]."""
LEAST = 2e-5
"""Least amount by which a distance is raised [m]."""
DEEP = 0.015
"""Largest penetration of a shape by a motion that fixes the planes of the next round [m]."""


class Clearing:
    """The rows on distances of one NLP, from solve to solve.

    A row keeps two shapes on both sides of a plane. A known motion fixes the planes: the guess, then each solution that
    penetrates no shape by more than ``DEEP``. The planes preserve the homotopy class of the guess. A finer mesh hardly
    moves a solution on another one, so that few pairs have rows there; rounds add others where a proof falls short. On
    a given path (``FollowPath``) distances are proved only, since no row can change it.

    Parameters
    ----------
    nlp : Nlp
        The NLP before its first solve.
    guess : InitialGuess
        Guess of the problem.
    """

    def __init__(self, nlp: Nlp, guess: InitialGuess) -> None:
        self._every: list[Clearances] = []
        self._stays_near = isinstance(guess, FromSolution)
        self._on_paths: list[Clearances] = []
        if any(each.avoids_collisions for phase in nlp.problem.phases for each in phase.constraints):
            from robotraj.transcription.clearance.clearance_rows import clearances

            every, phases = clearances(nlp), nlp.problem.phases
            self._on_paths = [own for own in every if phases[own.phase].path is not None]
            self._every = [own for own in every if own not in self._on_paths]
        self._motions: list[Motion] = []
        if self._every:
            start = guess.prepared(nlp.problem)
            self._motions = [_guessed(start, nlp.problem.phases, own) for own in self._every]
        self._kept: list[dict[tuple[int, int], float]] = [{} for _ in self._every]
        self._found: list[tuple[Clearances, Shortfalls]] = []
        self._found_on_paths: list[tuple[Clearances, Shortfalls]] = []
        self._objectives: list[float] = []
        self._count = 0

    @property
    def numbered(self) -> bool:
        """Whether rows keep their numbers from round to round."""
        return len(self._every) < 2

    def __bool__(self) -> bool:
        """Whether a phase has a ``CollisionFree`` and is on no given path."""
        return bool(self._every)

    def rows(self, nlp: Nlp) -> Nlp:
        """Add rows on the pairs that are near along the known motion, or were near along an earlier one."""
        if not self._every:
            return nlp
        from robotraj.transcription.clearance.clearance_rows import with_rows_along
        from robotraj.transcription.clearance.near_pairs import NEAR, NEAR_SOLUTION

        near = NEAR_SOLUTION if self._stays_near else NEAR
        longer = with_rows_along(nlp, self._every, self._motions, self._kept, near)
        self._count = len(longer.rows) - len(nlp.rows)
        return longer

    def binds(self, nlp: Nlp, w: Array) -> bool:
        """Whether a row on a distance is active at w (n_w,)."""
        if not self._every or not nlp.keeps_clear:
            return False
        left = (nlp.values(w) - nlp.rows.lower)[-self._count :]
        return bool(np.any(left < ACTIVE))

    def measure(self, solution: Solution, bound: bool) -> None:
        """Prove the distances along a solution. Where the proof falls short, rows are added or raised next.

        Parameters
        ----------
        solution : Solution
        bound : bool
            Whether rows on distances are active, so that other planes may reduce the objective.
        """
        if not self._every and not self._on_paths:
            return
        self._objectives.append(solution.objective if bound else -np.inf)
        from robotraj.transcription.clearance.near_pairs import nearest_of_links
        from robotraj.transcription.clearance.proof import shortfalls
        from robotraj.transcription.clearance.supporting_planes import motion_of

        self._found, self._found_on_paths = (
            [(own, shortfalls(own.pairs, solution.phases[own.phase].joint_states)) for own in group]
            for group in (self._every, self._on_paths)
        )
        for i, (own, found) in enumerate(self._found):
            near = nearest_of_links(own.pairs, found)
            for interval, pair, distance, is_near in zip(
                found.intervals, found.pairs, found.distances, near, strict=True
            ):
                place = int(interval), int(pair)
                amount = min(max(MORE * (own.pairs.margin - float(distance)), LEAST), ROUGH_SHORTFALL)
                if place in self._kept[i]:
                    self._kept[i][place] += amount
                elif is_near:
                    self._kept[i][place] = 0.0
            if solution.success and found.least > own.pairs.margin - DEEP:
                self._motions[i] = motion_of(solution.phases[own.phase].joint_states, own.pairs.robot.nq)

    def proved(self, allowed: float) -> bool:
        """Whether all distances of the measured solution are proved, up to an ``allowed`` shortfall [m]."""
        return all(bool(np.all(found.distances >= own.pairs.margin - allowed)) for own, found in self._found)

    @property
    def settled(self) -> bool:
        """Whether the last rows and planes changed the objective by less than ``GAIN``."""
        last = self._objectives[-2:]
        if not self._every or last[-1] == -np.inf:
            return True
        return len(last) == 2 and abs(last[1] - last[0]) <= GAIN * abs(last[1])

    @property
    def settled_after_rise(self) -> bool:
        """Whether the objective is settled, or no rows on this mesh have increased it.

        Planes of the motion that follows an increase may reduce the objective again, on this mesh more cheaply than on
        a finer one.
        """
        pairs = zip(self._objectives, self._objectives[1:], strict=False)
        return self.settled or not any(b - a > GAIN * abs(b) for a, b in pairs if a > -np.inf)

    def violations(self, solution: Solution) -> Iterator[Violation]:
        """Yield the pairs whose distance is not proved, each with its worst time."""
        for own, found in (*self._found, *self._found_on_paths):
            worst: dict[int, int] = {}
            for k, pair in enumerate(found.pairs.tolist()):
                if pair not in worst or found.distances[k] < found.distances[worst[pair]]:
                    worst[pair] = k
            for pair, k in worst.items():
                name, margin = solution.phases[own.phase].phase.name, own.pairs.margin
                short = margin - float(found.distances[k])
                label, time = own.pairs.label(pair), float(found.times[k])
                yield Violation(name, "clearance", label, time, short, "m", margin, "under", 1.0)


def _guessed(guess: InitialGuess, phases: Sequence[Phase], own: Clearances) -> Motion:
    known, nq = guess.of(phases[own.phase], own.phase), own.pairs.robot.nq
    moves = any(obstacle.moves for obstacle in own.pairs.obstacles)
    t0 = sum(guess.of(phases[i], i).duration for i in range(own.phase)) if moves else 0.0
    return lambda s: (known.states(s)[:, :nq], t0 + known.duration * s)
